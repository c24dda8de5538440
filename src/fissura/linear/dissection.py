"""Order of bodies in which large structures fall into domains that do not touch each other.

The domains are consecutive layers; bodies between them come last, in the tail. Products, factors and triangular
solutions of the domains are then independent of each other, and the tail follows. How many domains there are depends on
the number of bodies alone, never on that of threads, so results are the same whatever the machine.
"""

import numpy as np

from fissura.arrays import BoolArray, IntArray
from fissura.kernels import njit
from fissura.linear import limits
from fissura.linear.assembly import Pattern
from fissura.linear.blocks import bandwidth_order


@njit()
def _between(start, neighbours, domain, out):  # type: ignore[no-untyped-def]
    """Mark bodies that touch a body of an earlier domain; negative domains do not count."""
    n = len(start)
    for b in range(n):
        end = start[b + 1] // 36 if b + 1 < n else len(neighbours)
        for p in range(start[b] // 36, end):
            if 0 <= domain[neighbours[p]] < domain[b]:
                out[b] = True


def domain_count(bodies: int) -> int:
    """Number of domains for a number of bodies."""
    return 4 if bodies >= limits.FOUR_DOMAINS else 2 if bodies >= limits.TWO_DOMAINS else 1


def dissected_order(form: Pattern, last: BoolArray, domains: int | None = None) -> tuple[IntArray, IntArray]:
    """Bodies by reverse Cuthill-McKee within each domain, what lies between domains after all of them.

    Parameters
    ----------
    form : Pattern
        Pattern.
    last : (n,) array
        Bodies to put at the very end.
    domains : int, optional
        How many; by default what suits the number of bodies.

    Returns
    -------
    order : (n,) array
        Body at each place.
    bounds : (domains + 1,) array
        Places at which domains begin, and at which the last one ends; the tail follows.
    """
    order = bandwidth_order(form, last)
    n, free = len(order), int((~last).sum())
    domains = domain_count(n) if domains is None else domains
    if domains == 1:
        return order, np.array([0, n])
    domain = np.full(n, -1)
    domain[order[:free]] = np.arange(free) * domains // max(free, 1)
    between = np.zeros(n, dtype=bool)
    _between(form.start, form.neighbours, domain, between)
    rank = np.where(last, domains + 1, np.where(between, domains, domain))
    order = order[np.argsort(rank[order], kind="stable")]
    return order, np.searchsorted(rank[order], np.arange(domains + 1))
