"""Streams of random numbers of an ensemble, all from its one seed."""

import numpy as np

NUCLEI, FIELD, STRATA, RESAMPLING = 0, 1, 2, 3
"""Purposes of random numbers, the second part of their spawn key."""

SEED_BITS = 49
"""Seeds are below 2**49, so that spreadsheets and JSON readers keep every digit of them."""


def spawned(master: int, number: int, purpose: int) -> np.random.SeedSequence:
    """Independent stream of random numbers of an ensemble.

    Parameters
    ----------
    master : int
        The one seed of the ensemble.
    number : int
        Number of the realisation, from 1; 0 for what belongs to all.
    purpose : int
        `NUCLEI`, `FIELD`, `STRATA` or `RESAMPLING`.

    Returns
    -------
    SeedSequence
        With the spawn key ``(number, purpose)``: it depends on nothing else, so that realisation 7 is the same in an
        ensemble of 10 and of 1000.
    """
    return np.random.SeedSequence(master, spawn_key=(number, purpose))


def seed_of(sequence: np.random.SeedSequence) -> int:
    """A seed of a stream of its own, below 2**49."""
    return int(sequence.generate_state(1, np.uint64)[0] >> np.uint64(64 - SEED_BITS))
