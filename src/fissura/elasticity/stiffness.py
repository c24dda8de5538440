"""Stiffness tensors as 6x6 matrices: isotropic part, anisotropy, engineering constants."""

from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray

#: Axes of the six components in the order of Voigt: xx, yy, zz, yz, xz, xy.
PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))

# A shear strain in Voigt's notation is twice the tensor's component; with root two in both places a matrix has the norm
# of its tensor (Mandel's notation).
_TO_MANDEL = np.repeat([1.0, np.sqrt(2.0)], 3)


@dataclass(frozen=True)
class Isotropic:
    """Constants of an isotropic elastic material.

    Attributes
    ----------
    bulk, shear : float
        Bulk and shear modulus [Pa].
    """

    bulk: float
    shear: float

    @property
    def E(self) -> float:
        """Modulus of elasticity [Pa]."""
        return 9.0 * self.bulk * self.shear / (3.0 * self.bulk + self.shear)

    @property
    def nu(self) -> float:
        """Poisson's ratio."""
        return (3.0 * self.bulk - 2.0 * self.shear) / (2.0 * (3.0 * self.bulk + self.shear))

    def matrix(self) -> FloatArray:
        """Stiffness in Voigt's notation, strains with shear angles; (6, 6) [Pa]."""
        out = np.diag(np.repeat([2.0 * self.shear, self.shear], 3))
        out[:3, :3] += self.bulk - 2.0 / 3.0 * self.shear
        return out


def unit_strains() -> FloatArray:
    """Strain tensors with one component 1 in Voigt's notation, that is a shear angle of 1; shape (6, 3, 3)."""
    out = np.zeros((6, 3, 3))
    for k, (a, b) in enumerate(PAIRS):
        out[k, a, b] += 0.5
        out[k, b, a] += 0.5
    return out


def isotropic_part(stiffness: FloatArray) -> Isotropic:
    """The isotropic tensor nearest to a stiffness, in the norm of tensors (Moakher & Norris 2006).

    Parameters
    ----------
    stiffness : (6, 6) array
        In Voigt's notation [Pa].
    """
    bulk = float(stiffness[:3, :3].sum()) / 9.0
    trace = float(np.trace(stiffness[:3, :3])) + 2.0 * float(np.trace(stiffness[3:, 3:]))  # of the tensor, C_ijij
    return Isotropic(bulk, (trace - 3.0 * bulk) / 10.0)


def anisotropy(stiffness: FloatArray) -> float:
    """Distance of a stiffness (6, 6) from its isotropic part, over the size of that part; the same after turning."""
    scale = np.outer(_TO_MANDEL, _TO_MANDEL)
    isotropic = isotropic_part(stiffness).matrix()
    return float(np.linalg.norm(scale * (stiffness - isotropic)) / np.linalg.norm(scale * isotropic))
