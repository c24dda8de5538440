"""The equations of one discretization: internal forces and stiffness for given displacements and history."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array

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
from fissura.equilibrium.acting import Acting
from fissura.equilibrium.platens import with_platens
from fissura.equilibrium.reactions import Carried, Reactions, carried, reactions
from fissura.equilibrium.secant import PreparedSecant
from fissura.equilibrium.with_damage import changes, put_rows
from fissura.errors import InputError
from fissura.linear.assembly import Pattern, add_spin, assemble, assemble_secant, pattern
from fissura.linear.krylov import dot
from fissura.linear.low_rank import LowRank
from fissura.linear.symmetric import SymmetricSolver
from fissura.machine.kernel_threads import SINGLE_THREAD, KernelThreads
from fissura.material import Material, Materials, Regions
from fissura.specimen import Conditions, Drive
from fissura.tessellation import Tessellation

if TYPE_CHECKING:
    from fissura.material.field import RandomField

__all__ = ["Response", "System"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Supports are this many times stiffer than a typical contact, times the bodies that they hold. The structure resists a
#: support's motion with at most a few contacts of each of these, whatever its size: so supports take at most 4e-5 of
#: its deformation (slabs one body thick between two faces), 1e-5 of cubes, which falls as they grow, and 1e-6 of beams.
#: Round-off stays far below the tolerance of equilibrium, also where contacts have lost their stiffness.
_SUPPORT_STIFFNESS = 1e5

#: Bodies up to which a support enters the matrix, as a dense block: as many entries as 240 bodies of the inside have.
_NARROW = 60

#: Share of a glued facet's rotational stiffness that contacts keep, also where one of their bodies has few of them.
_SPIN_STIFFNESS, _SPIN_STIFFNESS_OF_FEW = 1e-6, 1e-4

#: Contacts up to which they are few: bodies at corners and edges have 5 or 6, others 15.
_FEW = 6


#: Stiffness that holds platens, over that of their contacts: far below the error of equilibrium.
_ANCHOR = 1e-13

#: Length at which coarse contacts are asked for their strength, over that of the shortest contact.
_SHORT = 1e-3

#: Stiffness relative to the elastic one that is the same but for round-off.
_SAME = 1e-13

_NOWHERE = Regions()


@dataclass(frozen=True)
class Response:
    """What the structure answers to displacements.

    Attributes
    ----------
    u : (6 n,) array
        Displacements and rotations.
    strain, traction : (m, 3) array
        Of all contacts; tractions in Pa.
    history : (k, h) array
        History of the contacts with damage, if these displacements were accepted.
    forces : (6 n,) array
        Internal forces and moments, supports included.
    """

    u: FloatArray
    strain: FloatArray
    traction: FloatArray
    history: FloatArray
    forces: FloatArray


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

    Raises
    ------
    InputError
        There are no contacts, or ones that the law does not allow.

    Attributes
    ----------
    active, passive : (k,), (m - k,) arrays
        Contacts with the damage law, which are fine and outside elastic regions, and all others.
    coarse : (c,) array
        Contacts that are not fine.
    elastic_scale : float
        Factor on the stiffness of coarse contacts; 1 unless made by :meth:`scaled`.
    platens : WithPlatens
        The n bodies with p platens after them, and their m + k contacts: these are what displacements and strains are
        of.
    acting : Acting
        Loads, supports and gauges on the bodies.
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
    ) -> None:
        contacts = tessellation.contacts
        if not len(contacts):
            raise InputError(
                "discretization.l_f",
                "the specimen has no contact between bodies: a single body is rigid",
                "so small that there are several bodies",
            )
        self.tessellation = tessellation
        self.platens = with_platens(tessellation, conditions.platens)
        whole = self.platens.tessellation
        inner, contacts = len(contacts), whole.contacts
        several = LawOfMaterials(law, material if isinstance(material, Materials) else Materials(material))
        kinds = several.materials.kinds(tessellation.x)
        # Contacts with platens are of the material of their bodies, and never break.
        ends = np.concatenate([kinds[contacts.bodies[:inner]], kinds[contacts.bodies[inner:, [0, 0]]]])
        self.geometry: Kinematics = kinematics(whole)
        may_crack = ~elastic.contains(contacts.centroid)
        may_crack[inner:] = False
        self.active: IntArray = np.flatnonzero(contacts.fine & may_crack)
        self.passive: IntArray = np.flatnonzero(~(contacts.fine & may_crack))
        self.coarse: IntArray = np.flatnonzero(~contacts.fine)
        self._guarded: IntArray = np.flatnonzero(~contacts.fine & may_crack)
        self.field = field
        scale, ductility = (None, None) if field is None else field.factors(contacts.centroid[self.active])
        self.law: AppliedLaw = several.create(ends[self.active], contacts.length[self.active], scale, ductility)
        # Coarse contacts have no softening and hence no limit on their length: only their strength is asked for, which
        # is the same at a length that every law allows.
        short = _SHORT * float(contacts.length[:inner].min())
        scale = None if field is None else field.strength(contacts.centroid[self._guarded])
        self.elastic_law: AppliedLaw = several.create(ends[self._guarded], np.full(len(self._guarded), short), scale)
        self.elastic_scale = 1.0
        self._elastic: FloatArray = several.elastic(ends)
        if self.platens.share is not None:
            self._elastic *= self.platens.share
        self._strength: FloatArray = several.strength(kinds)
        self._stiffest = float(self._elastic[:, 0].max())
        self.moduli = self._moduli(1.0)
        self.conditions = conditions
        self.acting = Acting.on(conditions, tessellation, whole)
        rows = self.acting.support_rows
        self.support_dofs: IntArray = np.unique(rows.indices).astype(np.int64)
        self.support_rows: FloatArray = rows[:, self.support_dofs].toarray()
        self.support_stiffness: FloatArray = self._support_stiffness(rows)
        self.constant, wide = self._supports(rows)
        self.pattern: Pattern = pattern(self.geometry, self.constant, self._spin(), wide)
        self.symmetric = SymmetricSolver(self.pattern, whole.x, linear, threads)
        self.threads = threads
        self.prepared = PreparedSecant(self, self.symmetric)
        self._set_drive(conditions.main, np.zeros(len(conditions.load_names)))
        # Moments count as forces at the arm of half a contact.
        arm = 0.5 * float(np.median(contacts.length[:inner]))
        self.weights: FloatArray = np.tile(np.repeat([1.0, 1.0 / arm], 3), len(whole))

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
        out[self.active], out[self._guarded] = self.law.scale, self.elastic_law.scale
        return out

    def _moduli(self, elastic_scale: float) -> FloatArray:
        """Stiffness of the three strain components of every contact [Pa], shape (m, 3)."""
        moduli = self._elastic.copy()
        moduli[self.coarse] *= elastic_scale
        return moduli

    def scaled(self, elastic_scale: float) -> System:
        """The same equations with another factor on the stiffness of coarse contacts; everything else is shared."""
        other = copy(self)
        other.elastic_scale = elastic_scale
        other.moduli = other._moduli(elastic_scale)
        other.prepared = PreparedSecant(other, self.symmetric)
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
        other.prepared = PreparedSecant(other, self.symmetric)
        return other

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

    def value(self, u: FloatArray, load: float) -> float:
        """Value of the controlled quantity [m or N] for displacements, (6 n,), and a load factor."""
        return load if self.by_force else dot(self.control, u)

    def forces(self, load: float) -> FloatArray:
        """Sizes of all loads under a load factor [N], shape (L,)."""
        return np.asarray(self.kept + load * self.drive.ratios)

    def external(self, load: float) -> FloatArray:
        """Forces of all loads under a load factor, (6 n,)."""
        return load * self.load if self.dead is None else load * self.load + self.dead

    def _support_stiffness(self, rows: csr_array) -> FloatArray:
        """Stiffness of the functionals of supports [N/m], shape (r,): it goes with the bodies that one holds.

        A functional whose coefficients are shared by N bodies moves by the mean of their displacements, and the
        structure resists that with some contacts of each of them.
        """
        inner, n = self.tessellation.contacts, len(self.tessellation)
        contacts = self.platens.tessellation.contacts
        ends, length = contacts.bodies.ravel(), np.repeat(contacts.length, 2)
        count = np.bincount(ends, minlength=len(self.platens.tessellation))
        arm = 0.5 * np.bincount(ends, length, len(count)) / np.maximum(count, 1)
        entries = rows.tocoo()
        share = entries.data / np.where(entries.col % 6 < 3, 1.0, arm[entries.col // 6])
        shares = np.bincount(entries.row, share**2, rows.shape[0])
        typical = self._stiffest * float(np.median(inner.area / inner.length))
        stiffness = _SUPPORT_STIFFNESS * typical / shares
        platen = np.full(rows.shape[0], -1)
        platen[entries.row] = entries.col // 6 - n
        for k, own in enumerate(self.platens.contacts):
            stiffness[platen == k] = _SUPPORT_STIFFNESS * self._behind(own)
        return np.asarray(stiffness, dtype=np.float64)

    def _supports(self, rows: csr_array) -> tuple[csr_array, LowRank]:
        """Stiffness of the supports: that of narrow ones as a matrix, that of wide ones as its few rows."""
        held = np.array([len(np.unique(rows.indices[a:b] // 6)) for a, b in pairwise(rows.indptr)])
        scaled = csr_array(rows.multiply(np.sqrt(self.support_stiffness)[:, None]))
        narrow = csr_array(scaled[held <= _NARROW])
        return csr_array(narrow.T @ narrow + self._anchors()), LowRank.of(csr_array(scaled[held > _NARROW]), 1.0)

    def _behind(self, own: IntArray) -> float:
        """Stiffness of the structure behind the contacts of a platen, roughly [N/m], however short these are.

        That of short ones has no bounds: with it, reactions would be round-off of displacements.
        """
        return float((self._elastic[own, 0] * np.sqrt(self.platens.tessellation.contacts.area[own])).sum())

    def _anchors(self) -> csr_array:
        """A trace of stiffness that holds platens: solvers then treat them as they treat supports, which is last."""
        contacts = self.platens.tessellation.contacts
        stiffness = np.zeros((len(self.platens.tessellation), 6))
        for k, own in enumerate(self.platens.contacts, len(self.tessellation)):
            stiffness[k] = _ANCHOR * self._behind(own) * np.repeat([1.0, contacts.area[own].sum()], 3)
        return csr_array(diags_array(stiffness.ravel()))

    def _spin(self) -> FloatArray:
        """A trace of rotational stiffness in every contact [N m], shape (m,).

        Contacts act at one point of their facets, so a body at a corner that touches only two others may spin freely
        about the line between these points, and so may one with five of which three are broken: the load could not be
        found where that begins. The stiffness against relative rotation of a facet glued over its whole area, ``E A^2 /
        (12 L)``, times a tiny factor stops that; it does no work in uniform strain, where rotations are equal.
        """
        contacts = self.platens.tessellation.contacts
        count = np.bincount(contacts.bodies.ravel(), minlength=len(self.platens.tessellation))
        few = (count[contacts.bodies] <= _FEW).any(axis=1)
        share = np.where(few, _SPIN_STIFFNESS_OF_FEW, _SPIN_STIFFNESS)
        stiffness: FloatArray = share * self._elastic[:, 0] * contacts.area**2 / (12.0 * contacts.length)
        stiffness[len(self.tessellation.contacts) :] = 0.0  # platens that can turn transmit no moment at all
        return stiffness

    @property
    def factorizations(self) -> int:
        """Matrices factorized, or prepared for iterative solution, so far."""
        return self.symmetric.factorizations

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.pattern.size

    def virgin(self) -> FloatArray:
        """History of undamaged contacts, shape (k, h)."""
        return self.law.initial_history()

    def pairs(self) -> IntArray:
        """Nuclei of the contacts with damage, by which their history is kept; shape (k, 2)."""
        bodies: IntArray = self.tessellation.contacts.bodies[self.active]
        return self.tessellation.nucleus[bodies]

    def response(self, u: FloatArray, history: FloatArray) -> Response:
        """Internal forces for displacements u, shape (6 n,), and accepted history."""
        strain = contact_strains(self.geometry, u.reshape(-1, 6))
        traction = strain * self.moduli
        # numpy takes rows many times faster than it indexes them, but has no such way back
        damaged, new = self.law.response(strain.take(self.active, axis=0), history)
        put_rows(damaged, self.active, traction)
        return Response(u, strain, traction, new, self.internal(traction, u))

    def strain(self, u: FloatArray) -> FloatArray:
        """Strains of all contacts, (m, 3), for displacements u, (6 n,)."""
        return contact_strains(self.geometry, u.reshape(-1, 6))

    def reached(self, u: FloatArray, damaged: FloatArray, history: FloatArray) -> Response:
        """An accepted response of before, from what does not follow from anything else.

        Parameters
        ----------
        u : (6 n,) array
            Displacements and rotations.
        damaged : (k, 3) array
            Tractions of the contacts with damage [Pa].
        history : (k, h) array
            Their history.
        """
        strain = self.strain(u)
        traction = strain * self.moduli
        put_rows(damaged, self.active, traction)
        return Response(u, strain, traction, history, self.internal(traction, u))

    def internal(self, traction: FloatArray, u: FloatArray) -> FloatArray:
        """Internal forces of given tractions [Pa], with the reactions of supports; shape (6 n,)."""
        forces: FloatArray = nodal_forces(self.geometry, traction)
        add_spin(self.geometry, self.pattern.spin, u.reshape(-1, 6), forces)
        self.pattern.wide.add_product(u.reshape(-1, 6), forces)
        flat: FloatArray = forces.ravel() + self.constant @ u
        return flat

    def elastic_forces(self, u: FloatArray) -> FloatArray:
        """Internal forces without any damage, for displacements u; (6 n,) -> (6 n,)."""
        return self.internal(contact_strains(self.geometry, u.reshape(-1, 6)) * self.moduli, u)

    def secant_moduli(self, history: FloatArray) -> FloatArray:
        """Secant stiffness of the three strain components of every contact [Pa], shape (m, 3)."""
        return self._left(self.law.intact(history))

    def _left(self, intact: FloatArray) -> FloatArray:
        moduli = self.moduli.copy()
        moduli[self.active] *= intact
        return moduli

    def secant_stiffness(self, history: FloatArray) -> FloatArray:
        """The same as a matrix ``ds/de`` of every contact [Pa], shape (m, 3, 3)."""
        stiffness = np.zeros((len(self.geometry), 3, 3))
        stiffness[:, range(3), range(3)] = self.secant_moduli(history)
        return stiffness

    def tangent(self, response: Response, history: FloatArray) -> FloatArray:
        """Entries of the consistent tangent stiffness at a response."""
        stiffness = self.secant_stiffness(history)
        stiffness[self.active] = self.law.tangent(response.strain[self.active], history)
        return assemble(self.geometry, self.pattern, stiffness)

    def secant(self, history: FloatArray) -> FloatArray:
        """Entries of the secant stiffness for given damage; symmetric and positive definite."""
        return assemble_secant(self.geometry, self.pattern, self.secant_moduli(history))

    def factor_secant(self, history: FloatArray) -> None:
        """Prepare `symmetric` for the secant stiffness with given damage.

        Raises
        ------
        SingularMatrixError
            The structure is a mechanism.
        """
        self.factor_intact(self.law.intact(history))

    def factor_intact(self, intact: FloatArray) -> None:
        """The same for shares of their elastic moduli that contacts with damage have left, (k, 3)."""
        self.symmetric.factor_contacts(self.geometry, self._left(intact))

    def changed(self, tangent: FloatArray, intact: FloatArray) -> tuple[IntArray, FloatArray]:
        """Contacts whose tangent stiffness differs from a secant stiffness.

        Parameters
        ----------
        tangent : (k, 3, 3) array
            Tangent ``ds/de`` of the contacts with damage [Pa].
        intact : (k, 3) array
            Shares of the elastic moduli that the secant stiffness has.

        Returns
        -------
        contacts : (c,) array
            Where they differ.
        change : (c, 3, 3) array
            By how much.
        """
        return changes(tangent, intact, self.moduli, self.active, _SAME * self._stiffest)

    def stored(self, response: Response) -> float:
        """Elastic energy of contacts, ``sum A L s . e / 2``, of the stiffness against spinning and of supports [J]."""
        return 0.5 * dot(response.forces, response.u)

    def dissipated(self, old: Response, new: Response) -> FloatArray:
        """Energy dissipated by each contact between two responses [J]; (m,).

        It is ``A L (s_old.e_new - s_new.e_old)/2``, its work by the trapezoidal rule less what it stores,
        without :meth:`kinks`.
        """
        work = np.einsum("ca,ca->c", old.traction, new.strain) - np.einsum("ca,ca->c", new.traction, old.strain)
        return np.asarray(0.5 * self.geometry.volume * work - self.kinks(old, new), dtype=np.float64)

    def kinks(self, old: Response, new: Response) -> FloatArray:
        """What the trapezoidal rule counts too much as work where a contact opens or closes, one of which is stiffer.

        Its normal traction is zero on the way: all work of it is stored. Laws that do not close have none of this.

        Parameters
        ----------
        old, new : Response
            States at the ends of a step.

        Returns
        -------
        (m,) array
            Energy [J].
        """
        out = np.zeros(len(self.geometry))
        turned = self.active[old.strain[self.active, 0] * new.strain[self.active, 0] < 0.0]
        if not len(turned):
            return out
        uneven = np.zeros(len(self.geometry), dtype=np.bool_)
        for history in (old.history, new.history):
            left = self.law.intact(history)
            uneven[self.active] |= left[:, 0] != left[:, 1]
        turned = turned[uneven[turned]]
        work = old.traction[turned, 0] * new.strain[turned, 0] - new.traction[turned, 0] * old.strain[turned, 0]
        out[turned] = 0.5 * self.geometry.volume[turned] * work
        return out

    def elastic_utilisation(self, response: Response) -> FloatArray:
        """Effective traction over strength of coarse contacts, 0 for fine ones and in elastic regions; shape (m,)."""
        out = np.zeros(len(self.tessellation.contacts))
        out[self._guarded] = self.elastic_law.utilisation(self.elastic_scale * response.strain[self._guarded])
        return out

    def support_forces(self, response: Response) -> FloatArray:
        """Force of every functional of the supports on the specimen [N], shape (r,)."""
        forces: FloatArray = -self.support_stiffness * (self.support_rows @ response.u[self.support_dofs])
        return forces

    def reactions(self, response: Response, load: float) -> Reactions:
        """Reactions of the supports, and what they and all loads leave out of balance under a load factor."""
        return reactions(self.conditions, self.support_forces(response), self.acting.loads, self.forces(load))

    @cached_property
    def carried(self) -> Carried:
        """Contacts of the bodies on which loads and supports act; the weight, which acts on all, is left out."""
        loads, n = len(self.conditions.loads), len(self.tessellation)
        # What acts on a platen acts on the bodies under it.
        bodies = [self.platens.bodies[some[0] - n] if some[0] >= n else some for some in self.acting.bodies]
        first = len(self.acting.loads)
        ends = first + np.cumsum([0, *(held.functionals for held in self.conditions.held)])
        supports = [np.concatenate(bodies[a:b]) for a, b in pairwise(ends)]
        return carried(self.tessellation, [*bodies[:loads], *supports])

    def largest_utilisation(self, response: Response) -> float:
        """Largest effective traction over strength of all contacts, as if none were damaged."""
        active = self.law.utilisation(response.strain[self.active])
        return max(float(active.max(initial=0.0)), float(self.elastic_utilisation(response).max(initial=0.0)))

    def stress(self, response: Response, load: float) -> FloatArray:
        """Stress in bodies [Pa], with the forces of loads and supports at their points; shape (n, 3, 3)."""
        external = self.acting.points_and_forces(self.forces(load), self.support_forces(response))
        whole = body_stress(self.platens.tessellation, self.geometry.frame, response.traction, *external)
        return whole[: len(self.tessellation)]

    def elastic_share(self, solutions: FloatArray) -> float:
        """Part of the undamaged gauge compliance that is due to coarse contacts [m/N].

        Parameters
        ----------
        solutions : (6 n, 2) array
            Undamaged displacements under the unit load, and under a unit force at the controlled quantity.
        """
        a, b = (contact_strains(self.geometry, np.ascontiguousarray(u).reshape(-1, 6)) for u in solutions.T)
        each = self.geometry.volume * np.einsum("ca,ca,ca->c", a, self.moduli, b)
        return float(each[self.coarse].sum())
