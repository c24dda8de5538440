"""The coarse part as a homogeneous material: what full resolution is on average, without its scatter.

Contacts with `alpha = 1` pass the patch test in every structure, graded or not (theory section 2). Their Poisson's
ratio is zero; that of the material comes from a second energy, ``1/2 sum lambda_i V_i theta_i^2`` with the volumetric
strain ``theta_i`` of each coarse body, by Gauss's theorem ``(1/V_i) sum_j A_ij (c_ij - x_i) . Delta_ij / L_ij``. At
free faces the strain across the face follows from Poisson's ratio, which is what reduces ``lambda_i`` there. Every
uniform strain inside, and uniaxial stress along free faces, is then exact, whatever the size and shape of the bodies.
One thing is left of full resolution, the layer of bodies along its surface, which is stiffer or softer than the bulk.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from fissura.adaptivity import limits
from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.case.macroscopic import macroscopic_elasticity
from fissura.equilibrium import System
from fissura.equilibrium.coarse_part import poisson
from fissura.linear import SingularMatrixError
from fissura.linear.krylov import gmres, norm


@dataclass(frozen=True)
class Homogeneous:
    """Equations of a discretization whose coarse part is homogeneous.

    Attributes
    ----------
    system : System
        Equations of the discretization.
    moduli : (m, 3) array
        Stiffness of the strain components of every contact [Pa].
    rows : (c, 6 n) sparse array
        Volumetric strain of coarse bodies over displacements, times their volume [m^3 for a strain].
    stiffness : (c,) array
        Stiffness against it over their volume [Pa/m^3].
    """

    system: System
    moduli: FloatArray
    rows: csr_array
    stiffness: FloatArray

    def volumetric(self, u: FloatArray) -> FloatArray:
        """Forces of the second energy under displacements; (6 n,) -> (6 n,)."""
        return np.asarray(self.rows.T @ (self.stiffness * (self.rows @ u)))


def _ratio(moduli: FloatArray) -> FloatArray:
    """Tangential over normal stiffness of contacts, (m,)."""
    return np.asarray(0.5 * (moduli[:, 1] + moduli[:, 2]) / moduli[:, 0])


def is_tabulated(system: System) -> bool:
    """Whether the constants of the bulk are known for all contacts of a system."""
    ratio, known = _ratio(system.moduli[: len(system.tessellation.contacts)]), macroscopic_elasticity().alpha
    return bool(ratio.min() >= known[0] * (1.0 - limits.ROUND_OFF) and ratio.max() <= known[-1] + limits.ROUND_OFF)


def _constants(moduli: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Twice the shear modulus and Lamé's other constant of the bulk [Pa], and the surface's stiffness; (m,) each."""
    alpha = np.round(_ratio(moduli), limits.DIGITS)
    nu = poisson(alpha)
    modulus = moduli[:, 0] * (1.0 - 2.0 * nu)  # exact for bulk averages
    shear = modulus / (1.0 + nu)
    layer = np.interp(np.sqrt(alpha), np.sqrt(limits.LAYER_AT), limits.LAYER)
    return shear, shear * nu / (1.0 - 2.0 * nu), layer


def _sums(body: IntArray, values: FloatArray, n: int) -> FloatArray:
    return np.bincount(body, values, n).astype(np.float64)


def _sides(system: System) -> tuple[IntArray, IntArray, FloatArray]:
    """Contacts of coarse bodies, which of their two sides, and the volumetric strain that each gives, (s, 12)."""
    tessellation, geometry = system.tessellation, system.geometry
    contacts = tessellation.contacts
    contact, side = np.nonzero(~tessellation.fine[contacts.bodies])
    away = contacts.centroid[contact] - tessellation.x[contacts.bodies[contact, side]]
    outward = np.where(side == 0, 1.0, -1.0) * contacts.area[contact]
    along = np.einsum("cad,cd->ca", geometry.frame[contact], away) * outward[:, None]
    return contact, side, np.einsum("ca,cad->cd", along, geometry.rows[contact])


def homogeneous(system: System, l_f: float) -> Homogeneous:
    """Make the coarse part of a discretization homogeneous.

    Parameters
    ----------
    system : System
        Its equations, not scaled.
    l_f : float
        Spacing at full resolution [m], which is the thickness of the layer along the surface.
    """
    tessellation = system.tessellation
    contacts, surface, n = tessellation.contacts, tessellation.surface, len(tessellation)
    coarse: BoolArray = ~tessellation.fine
    own = system.moduli[: len(contacts)]
    shear, lame, layer = _constants(own)
    skin = l_f * _sums(surface.body, surface.area, n) / tessellation.volume
    ends = contacts.bodies
    # A contact between a fine and a coarse body is half of each kind.
    sides = np.where(
        coarse[ends][:, :, None], (shear[:, None] * (1.0 + layer[:, None] * skin[ends]))[:, :, None], own[:, None, :]
    )
    moduli = system.moduli.copy()
    moduli[: len(contacts)] = np.where(contacts.fine[:, None], own, sides.mean(axis=1))
    # Constants of bodies are means over their contacts.
    both = ends.ravel()
    weight = _sums(both, np.repeat(contacts.area * contacts.length, 2), n)
    shear_of, lame_of, layer_of = (
        _sums(both, np.repeat(contacts.area * contacts.length * values, 2), n) / np.where(weight > 0.0, weight, 1.0)
        for values in (shear, lame, layer)
    )
    height = np.einsum("ka,ka->k", surface.normal, surface.centroid - tessellation.x[surface.body])
    free = _sums(surface.body, surface.area * height, n) / tessellation.volume
    kept = coarse & (weight > 0.0)
    reduced = lame_of[kept] / (1.0 + free[kept] * lame_of[kept] / shear_of[kept])
    reduced *= 1.0 + layer_of[kept] * skin[kept]
    contact, side, values = _sides(system)
    number = np.cumsum(kept) - 1
    column = 6 * ends[contact][:, :, None] + np.arange(6)
    row = np.repeat(number[ends[contact, side]], 12)
    rows = csr_array((values.ravel(), (row, column.ravel())), shape=(int(kept.sum()), system.size))
    return Homogeneous(system, moduli, rows, reduced / tessellation.volume[kept])


def homogeneous_compliance(equations: Homogeneous) -> float:
    """Controlled quantity per unit load [m/N].

    Generalized minimal residuals, preconditioned by the contacts alone: 15 to 20 iterations, whatever the size.

    Raises
    ------
    SingularMatrixError
        The structure is a mechanism.
    """
    system = equations.system
    symmetric = system.symmetric
    symmetric.factor_contacts(system.geometry, equations.moduli)

    def operator(residual: FloatArray) -> tuple[FloatArray, FloatArray]:
        u, forces = symmetric.apply_with_product(residual)
        return u, forces + equations.volumetric(u)

    load = norm(system.load)
    u, rest = np.zeros(system.size), system.load
    for _ in range(limits.STARTS):
        u = u + gmres(operator, rest, limits.RESIDUAL * load / norm(rest), limits.MOST_VECTORS, system.threads).solution
        stiff = system.internal(system.strain(u) * equations.moduli, u) + equations.volumetric(u)
        rest = system.load - stiff
        if norm(rest) <= 2.0 * limits.RESIDUAL * load:
            return float(system.control @ u)
    raise SingularMatrixError("no convergence with a homogeneous coarse part")
