"""Generalized minimal residuals (Saad & Schultz 1986), preconditioned from the right, with kernels of their own.

Threaded vector operations of general libraries wait for each other longer than they work on vectors of this size.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray
from fissura.kernels import njit
from fissura.linear import limits
from fissura.linear.limits import ANY_ORDER
from fissura.machine.kernel_threads import SINGLE_THREAD, KernelThreads


@njit(nogil=True, fastmath=ANY_ORDER)
def _dot(begin, end, a, b):  # type: ignore[no-untyped-def]
    s = 0.0
    for k in range(begin, end):
        s += a[k] * b[k]
    return s


@njit(nogil=True, fastmath=ANY_ORDER)
def _take_out(begin, end, share, own, following, image):  # type: ignore[no-untyped-def]
    """Take a share of the vector `own` out of `image`, and return the product of what is left with another vector."""
    s = 0.0
    for k in range(begin, end):
        image[k] -= share * own[k]
        s += following[k] * image[k]
    return s


def _pieces(size: int) -> tuple[int, ...]:
    """Bounds of the pieces into which threads cut a vector; they depend on its size alone."""
    return (0, size) if size < limits.LONG else tuple(size * k // limits.CUT for k in range(limits.CUT + 1))


def _orthogonalized(basis: list[FloatArray], image: FloatArray, threads: KernelThreads) -> list[float]:
    """Make `image` orthogonal to unit vectors one after the other (modified Gram-Schmidt).

    Returns
    -------
    list
        Its components along them, and the norm of what is left.
    """
    pieces = _pieces(len(image))
    out = [float(sum(threads.run(_dot, pieces, basis[0], image)))]
    for own, following in zip(basis, [*basis[1:], image], strict=True):
        out.append(float(sum(threads.run(_take_out, pieces, out[-1], own, following, image))))
    out[-1] = float(np.sqrt(out[-1]))
    return out


def dot(a: FloatArray, b: FloatArray) -> float:
    """Scalar product of two vectors."""
    return float(_dot(0, len(a), a, b))


def norm(a: FloatArray) -> float:
    """Euclidean norm of a vector."""
    return float(np.sqrt(_dot(0, len(a), a, a)))


@dataclass(frozen=True)
class Minimized:
    """What :func:`gmres` found.

    Attributes
    ----------
    solution : (n,) array
        Solution.
    iterations : int
        Applications of the operator.
    reduction : float
        Norm of the residual that is left, over that of the right-hand side.
    """

    solution: FloatArray
    iterations: int
    reduction: float


def gmres(
    operator: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    right: FloatArray,
    tolerance: float,
    most: int,
    threads: KernelThreads = SINGLE_THREAD,
) -> Minimized:
    """Minimize the residual of ``A M z = b`` over growing Krylov spaces, without restart, starting from zero.

    Parameters
    ----------
    operator : callable
        Takes v to ``(M v, A M v)``, where M is the preconditioner.
    right : (n,) array
        Right-hand side b.
    tolerance : float
        Reduction of the residual at which to stop.
    most : int
        Largest number of iterations.
    threads : KernelThreads
        Threads that share the work on long vectors.

    Returns
    -------
    Minimized
        With the solution ``M z``.
    """
    size = norm(right)
    if size == 0.0:
        return Minimized(np.zeros_like(right), 0, 0.0)
    basis: list[FloatArray] = [right / size]
    moves: list[FloatArray] = []
    upper = np.zeros((most, most))
    rotations: list[tuple[float, float]] = []
    rest = [1.0]
    while len(moves) < most and abs(rest[-1]) > tolerance:
        k = len(moves)
        move, image = operator(basis[-1])
        before = norm(image)
        *column, left = _orthogonalized(basis, image, threads)
        left = left if left > limits.NOTHING_NEW * before else 0.0  # nothing new
        for j, (c, s) in enumerate(rotations):
            column[j], column[j + 1] = c * column[j] + s * column[j + 1], c * column[j + 1] - s * column[j]
        length = float(np.hypot(column[-1], left))
        if not length > limits.NOTHING_NEW * before or not np.isfinite(length):
            break
        c, s = column[-1] / length, left / length
        rotations.append((c, s))
        upper[: k + 1, k] = [*column[:-1], length]
        rest[-1:] = [c * rest[-1], -s * rest[-1]]
        moves.append(move)
        if left == 0.0:
            break
        basis.append(image / left)
    k = len(moves)
    solution = np.zeros_like(moves[0]) if moves else np.zeros_like(right)
    for weight, move in zip(np.linalg.solve(upper[:k, :k], size * np.array(rest[:k])) if k else [], moves, strict=True):
        solution += weight * move
    return Minimized(solution, k, abs(rest[-1]))
