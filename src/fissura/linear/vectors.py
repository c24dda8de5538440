"""What conjugate gradients do with vectors of six numbers for each body, for some bodies at a time."""

from fissura.kernels import njit
from fissura.linear.limits import ANY_ORDER


@njit(nogil=True, fastmath=ANY_ORDER)
def dot(begin, end, a, b):  # type: ignore[no-untyped-def]
    """Scalar product."""
    s = 0.0
    for k in range(begin, end):
        for d in range(6):
            s += a[k, d] * b[k, d]
    return s


@njit(nogil=True)
def advance(begin, end, step, p, product, u, r):  # type: ignore[no-untyped-def]
    """``u += step p`` and ``r -= step product``."""
    for k in range(begin, end):
        for d in range(6):
            u[k, d] += step * p[k, d]
            r[k, d] -= step * product[k, d]


@njit(nogil=True)
def turn(begin, end, ratio, z, p):  # type: ignore[no-untyped-def]
    """``p = z + ratio p``."""
    for k in range(begin, end):
        for d in range(6):
            p[k, d] = z[k, d] + ratio * p[k, d]
