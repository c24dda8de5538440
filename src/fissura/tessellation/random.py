"""Random numbers that are functions of other numbers, so that they need no order (Steele, Lea, Flood 2014)."""

import numpy as np

from fissura.kernels import njit

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)


@njit(inline="always")
def mixed(z):  # type: ignore[no-untyped-def]
    """Mix the bits of a number (Steele, Lea, Flood 2014: the output of SplitMix64)."""
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


@njit()
def random_of(key, numbers):  # type: ignore[no-untyped-def]
    """Random numbers of 63 bits, each a function of a key and its own number; (n,) -> (n,)."""
    out = np.empty(len(numbers), np.int64)
    for k in range(len(numbers)):
        out[k] = np.int64(mixed(key ^ mixed(np.uint64(numbers[k]) + _GOLDEN)) >> np.uint64(1))
    return out


@njit(inline="always")
def drawn(state):  # type: ignore[no-untyped-def]
    """The next random number from 0 to 1."""
    state[0] += _GOLDEN
    return float(mixed(state[0]) >> np.uint64(11)) * 2.0**-53
