"""Materials that differ from part to part of a specimen, and what a contact between two of them is made of."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.case import Case
from fissura.material.parameters import Material, material_from_part
from fissura.material.regions import Regions, check_overlap


def joined(a: Material, b: Material) -> Material:
    """Material of a contact between bodies of two materials.

    Half of its length lies in each: normal and tangential stiffness are those of the halves in series. All other
    constants are those of the weaker one, which has the smaller ``f_t``, or the smaller ``G_t`` where these are the
    same.
    """
    if a == b:
        return a
    weaker = min(a, b, key=lambda m: (m.f_t, m.G_t))
    normal = 2.0 / (1.0 / a.E + 1.0 / b.E)
    tangential = 2.0 / (1.0 / (a.alpha * a.E) + 1.0 / (b.alpha * b.E))
    return replace(weaker, E=normal, alpha=tangential / normal)


@dataclass(frozen=True)
class Materials:
    """Materials by place.

    Attributes
    ----------
    base : Material
        That of all places that are in no region.
    parts : tuple of (Regions, Material)
        Others; where regions overlap, the last one counts.
    """

    base: Material
    parts: tuple[tuple[Regions, Material], ...] = ()

    @cached_property
    def each(self) -> tuple[Material, ...]:
        """All materials, each once."""
        found = [self.base]
        for _, material in self.parts:
            if material not in found:  # parameters of a law may have no hash
                found.append(material)
        return tuple(found)

    def kinds(self, x: FloatArray) -> IntArray:
        """Numbers in `each` of the materials at points; (n, 3) -> (n,)."""
        out = np.zeros(len(x), dtype=np.int64)
        for regions, material in self.parts:
            out[regions.contains(x)] = self.each.index(material)
        return out

    def between(self, a: int, b: int) -> Material:
        """Material of a contact between bodies of two kinds."""
        return joined(self.each[a], self.each[b])

    def pairs(self) -> tuple[Material, ...]:
        """Materials of all contacts that there may be."""
        count = len(self.each)
        return tuple(self.between(a, b) for a in range(count) for b in range(a, count))


def materials_from_case(case: Case) -> Materials:
    """Materials of a case.

    Raises
    ------
    InputError
        A region lies outside the specimen.
    """
    parts = []
    for k, (part, material) in enumerate(zip(case.materials, case.resolved_materials, strict=True)):
        key = f"materials[{k}].region"
        check_overlap(case, part.region, key)
        parts.append((Regions.from_parts(part.region), material_from_part(material)))
    return Materials(material_from_part(case.material), tuple(parts))
