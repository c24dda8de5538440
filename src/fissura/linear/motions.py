"""Transfer between bodies and the rigid motions of their clusters, for some bodies at a time."""

from numpy import zeros

from fissura.kernels import njit
from fissura.linear.limits import AHEAD, ANY_ORDER
from fissura.linear.products import prefetch, transposed_times


@njit(nogil=True)
def restrict(begin, end, clusters, label, arm, unit, r):  # type: ignore[no-untyped-def]
    """What bodies from `begin` to `end` contribute to ``P^T r``; (n, 6) -> (clusters, 6)."""
    out = zeros((clusters, 6))
    for i in range(begin, end):
        c, a, f = label[i], arm[i], r[i]
        out[c, 0] += f[0]
        out[c, 1] += f[1]
        out[c, 2] += f[2]
        out[c, 3] += (f[3] + a[1] * f[2] - a[2] * f[1]) * unit
        out[c, 4] += (f[4] + a[2] * f[0] - a[0] * f[2]) * unit
        out[c, 5] += (f[5] + a[0] * f[1] - a[1] * f[0]) * unit
    return out


@njit(nogil=True)
def prolong(begin, end, label, arm, unit, coarse, out):  # type: ignore[no-untyped-def]
    """Add ``P coarse`` to bodies from `begin` to `end`; (clusters, 6) -> (n, 6)."""
    for i in range(begin, end):
        u, r = coarse[label[i]], arm[i]
        t0, t1, t2 = u[3] * unit, u[4] * unit, u[5] * unit
        out[i, 0] += u[0] + t1 * r[2] - t2 * r[1]
        out[i, 1] += u[1] + t2 * r[0] - t0 * r[2]
        out[i, 2] += u[2] + t0 * r[1] - t1 * r[0]
        out[i, 3] += t0
        out[i, 4] += t1
        out[i, 5] += t2


@njit(nogil=True, fastmath=ANY_ORDER)
def restrict_product(begin, end, clusters, first, cluster, product, z):  # type: ignore[no-untyped-def]
    """What bodies from `begin` to `end` contribute to ``(K P)^T z``; (n, 6) -> (clusters, 6)."""
    out = zeros((clusters, 6))
    for i in range(begin, end):
        own = (z[i, 0], z[i, 1], z[i, 2], z[i, 3], z[i, 4], z[i, 5])
        for k in range(first[i], first[i + 1]):
            prefetch(product, k + AHEAD)
            t = transposed_times(product, k, own)
            for d in range(6):
                out[cluster[k], d] += t[d]
    return out
