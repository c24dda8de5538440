"""The equations of one discretization: internal forces and stiffness for given displacements and history."""

from __future__ import annotations

from copy import copy
from functools import cached_property

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.contact import (
    AppliedLaw,
    ContactLaw,
    Kinematics,
    LawOfMaterials,
    body_stress,
    contact_strains,
    kinematics,
    nodal_forces,
)
from fissura.equilibrium import limits
from fissura.equilibrium.acting import Acting
from fissura.equilibrium.coarse_part import smoothed
from fissura.equilibrium.platens import with_platens
from fissura.equilibrium.reactions import carrying
from fissura.equilibrium.response import Response
from fissura.equilibrium.secant import PreparedSecant, secant_moduli
from fissura.equilibrium.supports import Supports, spin_stiffness
from fissura.equilibrium.with_damage import put_rows
from fissura.errors import InputError
from fissura.linear.assembly import Pattern, add_spin, pattern
from fissura.linear.krylov import dot
from fissura.linear.symmetric import SymmetricSolver
from fissura.machine.kernel_threads import SINGLE_THREAD, KernelThreads
from fissura.material import Material, Materials, Regions
from fissura.material.field import RandomField
from fissura.specimen import Conditions, Drive
from fissura.tessellation import Tessellation

_NOWHERE = Regions()


class System:
    """Equations of equilibrium of one discretization.

    Parameters
    ----------
    tessellation : Tessellation
        Bodies and contacts.
    material : Material or Materials
        Material of the contacts, or several by place: that of a body is found at its nucleus.
    law : type
        Contact law of fine contacts.
    conditions : Conditions
        Supports, loads, gauges, and what is driven: at first as in the last stage, without other loads.
    linear : str
        Linear solver, see :class:`SymmetricSolver`.
    elastic : Regions
        Contacts whose centroid lies there never get damage.
    field : RandomField, optional
        Relative strength and fracture energy, taken at the centroids of facets; 1 everywhere by default.
    threads : KernelThreads
        Threads for linear solvers.
    smooth : bool, optional
        Coarse contacts scatter less than those of the material, and resist bending (`coarse_part.py`).

    Raises
    ------
    InputError
        There are no contacts, or ones that the law does not allow.

    Attributes
    ----------
    damageable : (k,) array
        Contacts with the damage law, which are fine and outside elastic regions.
    coarse : (c,) array
        Contacts that are not fine.
    moduli : (m, 3) array
        Elastic stiffness of the three strain components of every contact [Pa].
    stiffest : float
        Largest of them without `elastic_scale` [Pa].
    elastic_scale : float
        Factor on the stiffness of coarse contacts; 1 unless made by :meth:`scaled`.
    platens : WithPlatens
        The n bodies with p platens after them, and their m + k contacts: these are what displacements and strains are
        of.
    acting, supports : Acting, Supports
        Loads, supports and gauges on the bodies, and what supports resist with.
    drive, kept : Drive, (L,) array
        What is driven, and forces of loads that act besides [N]; see :meth:`driven`.
    by_force : bool
        Whether the load factor is controlled, and no displacement.
    """

    def __init__(
        self,
        tessellation: Tessellation,
        material: Material | Materials,
        law: type[ContactLaw],
        conditions: Conditions,
        linear: str = "auto",
        elastic: Regions = _NOWHERE,
        field: RandomField | None = None,
        threads: KernelThreads = SINGLE_THREAD,
        *,
        smooth: bool = False,
    ) -> None:
        contacts = tessellation.contacts
        if not len(contacts):
            raise InputError(
                "discretization.l_f",
                "the specimen has no contact between bodies: a single body is rigid",
                "so small that there are several bodies",
            )
        self.tessellation, self.conditions, self.field, self.threads = tessellation, conditions, field, threads
        self.platens = with_platens(tessellation, conditions.platens)
        whole = self.platens.tessellation
        self.geometry: Kinematics = kinematics(whole)
        materials = material if isinstance(material, Materials) else Materials(material)
        self._give_laws(LawOfMaterials(law, materials), elastic)
        self.acting = Acting.on(conditions, tessellation, whole)
        self.supports = Supports.of(self.acting.support_rows, tessellation, self.platens, self._elastic)
        spin = spin_stiffness(tessellation, self.platens, self._elastic)
        if smooth:
            moduli, spin = smoothed(contacts, self.coarse, self._elastic, spin)
            self._elastic[:] = moduli
        self.pattern: Pattern = pattern(self.geometry, self.supports.constant, spin, self.supports.low_rank)
        self.symmetric = SymmetricSolver(self.pattern, whole.x, linear, threads)
        # Moments count as forces at the arm of half a contact.
        arm = 0.5 * float(np.median(contacts.length))
        self.weights: FloatArray = np.tile(np.repeat([1.0, 1.0 / arm], 3), len(whole))
        self._set_scale(1.0)
        self._set_drive(conditions.main, np.zeros(len(conditions.load_names)))

    def _give_laws(self, several: LawOfMaterials, elastic: Regions) -> None:
        """Which contacts have which law, and the elastic moduli of all."""
        contacts, inner = self.platens.tessellation.contacts, len(self.tessellation.contacts)
        kinds = several.materials.kinds(self.tessellation.x)
        # Contacts with platens are of the material of their bodies, and never break.
        ends = np.concatenate([kinds[contacts.bodies[:inner]], kinds[contacts.bodies[inner:, [0, 0]]]])
        may_crack = ~elastic.contains(contacts.centroid)
        may_crack[inner:] = False
        self.damageable: IntArray = np.flatnonzero(contacts.fine & may_crack)
        self.coarse: IntArray = np.flatnonzero(~contacts.fine)
        self._watched: IntArray = np.flatnonzero(~contacts.fine & may_crack)
        field = self.field
        scale, ductility = (None, None) if field is None else field.factors(contacts.centroid[self.damageable])
        self.law: AppliedLaw = several.create(ends[self.damageable], contacts.length[self.damageable], scale, ductility)
        # Coarse contacts have no softening and hence no limit on their length: only their strength is asked for, which
        # is the same at a length that every law allows.
        short = limits.SHORT_CONTACT * float(contacts.length[:inner].min())
        scale = None if field is None else field.strength(contacts.centroid[self._watched])
        self._elastic_law: AppliedLaw = several.create(ends[self._watched], np.full(len(self._watched), short), scale)
        self._elastic: FloatArray = several.elastic(ends)
        if self.platens.share is not None:
            self._elastic *= self.platens.share
        self.stiffest = float(self._elastic[:, 0].max())
        self._strength: FloatArray = several.strength(kinds)

    @cached_property
    def strength(self) -> FloatArray:
        """Tensile strength at the nuclei [Pa], shape (n,)."""
        return self._strength if self.body_factor is None else self._strength * self.body_factor

    @cached_property
    def body_factor(self) -> FloatArray | None:
        """Relative strength at the nuclei, shape (n,); None without a field."""
        return None if self.field is None else self.field.strength(self.tessellation.x)

    @cached_property
    def contact_factor(self) -> FloatArray | None:
        """Relative strength of contacts, shape (m,), 1 in elastic regions; None without a field."""
        if self.field is None:
            return None
        out = np.ones(len(self.tessellation.contacts))
        out[self.damageable], out[self._watched] = self.law.scale, self._elastic_law.scale
        return out

    def scaled(self, elastic_scale: float) -> System:
        """The same equations with another factor on the stiffness of coarse contacts; everything else is shared."""
        other = copy(self)
        other._set_scale(elastic_scale)
        other._forget()
        return other

    def driven(self, drive: Drive, kept: FloatArray) -> System:
        """The same equations with other loads driven; everything else is shared.

        Parameters
        ----------
        drive : Drive
            What is driven and controlled.
        kept : (L,) array
            Forces of all loads that act besides [N].
        """
        other = copy(self)
        other._set_drive(drive, kept)
        return other

    def _set_scale(self, elastic_scale: float) -> None:
        self.elastic_scale = elastic_scale
        self.moduli: FloatArray = self._elastic.copy()
        self.moduli[self.coarse] *= elastic_scale

    def _set_drive(self, drive: Drive, kept: FloatArray) -> None:
        acting = self.acting
        self.drive, self.kept = drive, kept
        #: Forces per unit of the load factor, (6 n,).
        self.load: FloatArray = np.asarray(drive.ratios @ acting.load_rows)
        #: Forces that are kept, (6 n,); None where there are none.
        self.dead: FloatArray | None = np.asarray(kept @ acting.load_rows) if kept.any() else None
        #: Coefficients of the displacement that is controlled, or where the load factor is, watched.
        self.control: FloatArray = self.load
        if drive.gauge is not None and drive.quantity != "displacement":
            self.control = acting.gauge_rows[[drive.gauge]].toarray().ravel()
        self.by_force = drive.quantity == "force"
        self._forget()

    def _forget(self) -> None:
        """Nothing is prepared for these equations."""
        of_contacts = (self.geometry, self.moduli, self.damageable, self.law)
        self.prepared = PreparedSecant(*of_contacts, self.load, self.dead, self.symmetric)

    def value(self, u: FloatArray, load: float) -> float:
        """Value of the controlled quantity [m or N] for displacements, (6 n,), and a load factor."""
        return load if self.by_force else dot(self.control, u)

    def forces(self, load: float) -> FloatArray:
        """Sizes of all loads under a load factor [N], shape (L,)."""
        return np.asarray(self.kept + load * self.drive.ratios)

    def external(self, load: float) -> FloatArray:
        """Forces of all loads under a load factor, (6 n,)."""
        return load * self.load if self.dead is None else load * self.load + self.dead

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.pattern.size

    def virgin(self) -> FloatArray:
        """History of undamaged contacts, shape (k, h)."""
        return self.law.initial_history()

    def pairs(self) -> IntArray:
        """Nuclei of the contacts with damage, by which their history is kept; shape (k, 2)."""
        bodies: IntArray = self.tessellation.contacts.bodies[self.damageable]
        return self.tessellation.nucleus[bodies]

    def strain(self, u: FloatArray) -> FloatArray:
        """Strains of all contacts, (m, 3), for displacements u, (6 n,)."""
        return contact_strains(self.geometry, u.reshape(-1, 6))

    def response(self, u: FloatArray, history: FloatArray) -> Response:
        """Internal forces for displacements u, shape (6 n,), and accepted history."""
        strain = self.strain(u)
        # numpy takes rows many times faster than it indexes them, but has no such way back
        return self.answer(u, strain, *self.law.response(strain.take(self.damageable, axis=0), history))

    def answer(self, u: FloatArray, strain: FloatArray, damaged: FloatArray, history: FloatArray) -> Response:
        """Response with tractions (k, 3) [Pa] and history (k, h) of the contacts with damage as given."""
        traction = strain * self.moduli
        put_rows(damaged, self.damageable, traction)
        return Response(u, strain, traction, history, self.internal(traction, u))

    def internal(self, traction: FloatArray, u: FloatArray) -> FloatArray:
        """Internal forces of given tractions [Pa], with the reactions of supports; shape (6 n,)."""
        forces: FloatArray = nodal_forces(self.geometry, traction)
        add_spin(self.geometry, self.pattern.spin, u.reshape(-1, 6), forces)
        self.pattern.low_rank.add_product(u.reshape(-1, 6), forces)
        flat: FloatArray = forces.ravel() + self.supports.constant @ u
        return flat

    def secant_moduli(self, history: FloatArray) -> FloatArray:
        """Secant stiffness of the three strain components of every contact [Pa], shape (m, 3)."""
        return secant_moduli(self.moduli, self.damageable, self.law.intact(history))

    def elastic_utilisation(self, response: Response) -> FloatArray:
        """Effective traction over strength of coarse contacts, 0 for fine ones and in elastic regions; shape (m,)."""
        out = np.zeros(len(self.tessellation.contacts))
        out[self._watched] = self._elastic_law.utilisation(self.elastic_scale * response.strain[self._watched])
        return out

    @cached_property
    def carrying(self) -> tuple[IntArray, ...]:
        """See :func:`~fissura.equilibrium.reactions.carrying`."""
        return carrying(self)

    def largest_utilisation(self, response: Response) -> float:
        """Largest effective traction over strength of all contacts, as if none were damaged."""
        used = self.law.utilisation(response.strain[self.damageable])
        return max(float(used.max(initial=0.0)), float(self.elastic_utilisation(response).max(initial=0.0)))

    def stress(self, response: Response, load: float) -> FloatArray:
        """Stress in bodies [Pa], with the forces of loads and supports at their points; shape (n, 3, 3)."""
        external = self.acting.points_and_forces(self.forces(load), self.supports.forces(response.u))
        whole = body_stress(self.platens.tessellation, self.geometry.frame, response.traction, *external)
        return whole[: len(self.tessellation)]
