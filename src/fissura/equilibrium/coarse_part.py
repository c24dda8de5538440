"""Contacts of coarse bodies that stand for the material between many fine ones: less scatter, and bending.

Contacts with the constants of the material make coarse bodies as heterogeneous as fine ones, over lengths at which the
material is not: their stress scatters, and far from any crack some come near their strength. They also act at one point
of their facets, so that coarse bodies resist a gradient of stress too little. Contacts whose shear is stiffer scatter
less, with the modulus of elasticity kept; Poisson's ratio falls with that. And a facet resists rotation as far as a
continuum with the macroscopic modulus does over its area.
"""

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.case.macroscopic import macroscopic_elasticity
from fissura.equilibrium import limits
from fissura.tessellation import Contacts


def smoothed(
    contacts: Contacts, coarse: IntArray, elastic: FloatArray, spin: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Stiffness of all contacts where coarse ones are smooth.

    Parameters
    ----------
    contacts : Contacts
        The k contacts between bodies of the specimen; those with platens, which follow, stay as they are.
    coarse : (c,) array
        Coarse contacts.
    elastic : (m, 3) array
        Moduli ``E, alpha E, alpha E`` by the material, m >= k [Pa].
    spin : (m,) array
        Stiffness against relative rotation [N m].

    Returns
    -------
    elastic, spin : (m, 3), (m,) arrays
        As they are then.
    """
    chosen = coarse[coarse < len(contacts)]
    elastic, spin, own = elastic.copy(), spin.copy(), elastic[chosen]
    elastic[chosen] = smooth_moduli(own)
    spin[chosen] += bending_stiffness(own, contacts, chosen)
    return elastic, spin


def smooth_moduli(elastic: FloatArray) -> FloatArray:
    """Elastic moduli of coarse contacts with less scatter, of the same macroscopic modulus of elasticity.

    Parameters
    ----------
    elastic : (c, 3) array
        Moduli ``E, alpha E, alpha E`` of contacts of the material [Pa].

    Returns
    -------
    (c, 3) array
        Moduli with an `alpha` of at least ``limits.SMOOTH_ALPHA`` [Pa]; as given where it is larger already.

    Examples
    --------
    >>> smooth_moduli(np.array([[60e9, 17.4e9, 17.4e9]])).round(-8)
    array([[5.0e+10, 2.5e+10, 2.5e+10]])
    """
    out, alpha = elastic.copy(), elastic[:, 1] / elastic[:, 0]
    smooth = limits.SMOOTH_ALPHA
    for given in np.unique(alpha[alpha < smooth]):
        which = alpha == given
        factor = _macroscopic(given) / _macroscopic(smooth)
        out[which] = factor * elastic[which, :1] * np.array([1.0, smooth, smooth])
    return out


def bending_stiffness(elastic: FloatArray, contacts: Contacts, chosen: IntArray) -> FloatArray:
    """Stiffness of coarse contacts against relative rotation of their bodies, ``E_macro A^2 / (12 L)`` [N m].

    It is that of a bar of the macroscopic modulus between the nuclei, with the second moment of a square facet, and
    for all axes the same. It does no work in uniform strain, where rotations are equal.

    Parameters
    ----------
    elastic : (c, 3) array
        Moduli ``E, alpha E, alpha E`` of contacts of the material [Pa].
    contacts : Contacts
        All contacts.
    chosen : (c,) array
        Which of them are meant.
    """
    alpha = elastic[:, 1] / elastic[:, 0]
    kinds, which = np.unique(alpha, return_inverse=True)
    modulus = elastic[:, 0] * np.array([_macroscopic(kind) for kind in kinds])[which]
    out: FloatArray = limits.BENDING * modulus * contacts.area[chosen] ** 2 / (12.0 * contacts.length[chosen])
    return out


def _macroscopic(alpha: float) -> float:
    """Macroscopic modulus over that of the contacts, at the nearest end of the table outside it (theory section 2)."""
    table = macroscopic_elasticity()
    return table.macroscopic(1.0, min(max(alpha, table.alpha[0]), table.alpha[-1]))[0]
