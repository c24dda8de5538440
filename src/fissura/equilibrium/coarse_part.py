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
    alpha, smooth = elastic[:, 1] / elastic[:, 0], limits.SMOOTH_ALPHA
    factor = (1.0 - 2.0 * poisson(alpha)) / (1.0 - 2.0 * poisson(np.array([smooth])))
    changed = factor[:, None] * elastic[:, :1] * np.array([1.0, smooth, smooth])
    return np.where((alpha < smooth)[:, None], changed, elastic)


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
    modulus = elastic[:, 0] * (1.0 - 2.0 * poisson(elastic[:, 1] / elastic[:, 0]))
    out: FloatArray = limits.BENDING * modulus * contacts.area[chosen] ** 2 / (12.0 * contacts.length[chosen])
    return out


def poisson(alpha: FloatArray) -> FloatArray:
    """Poisson's ratio of the bulk for ratios of tangential to normal stiffness (theory section 2); (m,) -> (m,).

    Outside its table it is that at the nearest end. The modulus of the bulk is ``E (1 - 2 nu)``.
    """
    table = macroscopic_elasticity()
    kinds, which = np.unique(alpha, return_inverse=True)
    each = [table.macroscopic(1.0, min(max(kind, table.alpha[0]), table.alpha[-1]))[1] for kind in kinds]
    return np.array(each)[which]
