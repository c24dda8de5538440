"""History of contacts from one discretization to the next, by pairs of nuclei."""

import numpy as np

from fissura.arrays import FloatArray, IntArray


def transfer_history(
    old_pairs: IntArray,
    old: FloatArray,
    new_pairs: IntArray,
    virgin: FloatArray,
) -> FloatArray:
    """History on a new discretization: kept where both nuclei stay, that of virgin contacts for new ones.

    Parameters
    ----------
    old_pairs, new_pairs : (k, 2), (q, 2) arrays
        Identities of the nuclei of contacts with damage.
    old : (k, h) array
        History.
    virgin : (q, h) array
        History of the new contacts if all of them were virgin.

    Returns
    -------
    (q, h) array
    """
    new = virgin.copy()
    if not len(old_pairs) or not len(new_pairs):
        return new
    nuclei, number = np.unique(np.concatenate([old_pairs, new_pairs]), return_inverse=True)  # of few digits
    keys = np.sort(number.reshape(-1, 2), axis=1) @ np.array([len(nuclei), 1])
    old_keys, new_keys = keys[: len(old_pairs)], keys[len(old_pairs) :]
    order = np.argsort(old_keys)
    place = np.minimum(np.searchsorted(old_keys[order], new_keys), len(order) - 1)
    same = old_keys[order[place]] == new_keys
    new[same] = old[order[place[same]]]
    return new
