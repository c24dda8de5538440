"""From a case to its specimen."""

from functools import lru_cache

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fissura.case import Case
from fissura.case import Notch as NotchPart
from fissura.case.registry import SHAPES
from fissura.case.shape import Specimen, Void
from fissura.errors import InputError, Notice
from fissura.specimen.assemble import complex_of
from fissura.specimen.convex import Degenerate
from fissura.specimen.cutting import cut_notches
from fissura.specimen.domain import Domain
from fissura.specimen.limits import FARTHEST
from fissura.specimen.shapes.mesh import mesh
from fissura.specimen.shapes.minus import subtract
from fissura.specimen.shapes.outline import extruded
from fissura.specimen.shapes.prism import AXES, box, cylinder
from fissura.specimen.slots import slot_from_part
from fissura.specimen.solid import Solid


def box_of(part: Specimen, l_f: float) -> Solid:
    """The box of a case."""
    assert part.size is not None
    return box(part.size)


def outline_of(part: Specimen, l_f: float) -> Solid:
    """The extruded outline of a case."""
    assert part.outline is not None
    assert part.thickness is not None
    return extruded(part.outline, part.thickness, part.names, l_f)


def cylinder_of(part: Specimen, l_f: float) -> Solid:
    """The cylinder of a case."""
    assert part.cylinder is not None
    return cylinder(part.cylinder.diameter, part.cylinder.length, AXES[part.cylinder.axis], l_f)


def mesh_of(part: Specimen, l_f: float) -> tuple[Solid, tuple[Notice, ...]]:
    """The mesh of a case, and what looks wrong in it."""
    assert part.mesh is not None
    return mesh(part.mesh, part.scale, l_f)


def _shape(part: Specimen, l_f: float) -> tuple[Solid, tuple[Notice, ...]]:
    """The shape of a case, and what looks wrong in it."""
    made = SHAPES.named(part.shape)(part.parameters or part, l_f)
    solid, notices = made if isinstance(made, tuple) else (made, ())
    if not isinstance(solid, Solid) or not solid.cells:
        what = "an empty Solid" if isinstance(solid, Solid) else type(solid).__name__
        raise InputError(part.key, f"the shape {part.shape!r} gives {what}", "a Solid with a cell or more")
    return solid, notices


def domain_from_case(case: Case) -> Domain:
    """Build the specimen that the case describes.

    Raises
    ------
    InputError
        An outline that crosses itself, a mesh that cannot be used, a void that leaves two parts or nothing, a notch
        that does not fit.
    """
    return _domain(case.specimen, case.minus, case.notch, case.discretization.l_f)


@lru_cache(maxsize=4)
def _domain(part: Specimen, minus: tuple[Void, ...], notch: tuple[NotchPart, ...], l_f: float) -> Domain:
    """The same again for all that asks for the specimen of a case."""
    stage = [part.key]
    try:
        return _built(part, minus, notch, l_f, stage)
    except Degenerate:
        problem = "some of it is so thin that round-off decides whether it is there"
        raise InputError(stage[-1], problem, "dimensions that differ by less, faces farther apart") from None


def _built(
    part: Specimen, minus: tuple[Void, ...], notch: tuple[NotchPart, ...], l_f: float, stage: list[str]
) -> Domain:
    """The specimen; `stage` is told the key that is being built, and begins with that of the shape."""
    solid, notices = _shape(part, l_f)
    _check_size(solid, l_f, stage[0])
    many = len(minus) > 1
    for k, void in enumerate(minus):
        stage.append(f"minus[{k}]" if many else "minus")
        subtract(solid, void, l_f, stage[-1])
    plain = Domain(*complex_of(solid), notices=notices)
    _check_whole(plain, "minus" if minus else stage[0])
    if not notch:
        return plain
    many = len(notch) > 1
    keys = [f"notch[{k}]" if many else "notch" for k in range(len(notch))]
    stage.append(keys[0])
    slots = [slot_from_part(one, plain, l_f, key) for one, key in zip(notch, keys, strict=True)]
    notches = cut_notches(solid, slots)
    domain = Domain(*complex_of(solid), notches=notches, notices=notices)
    _check_whole(domain, keys[-1])
    return domain


def _check_size(solid: Solid, l_f: float, key: str) -> None:
    """A length that leaves no room for one body is wrong, and coordinates that round-off would blur."""
    far = float(np.abs(solid.planes.centre).max())
    if far > FARTHEST * solid.extent:
        problem = f"its middle is {far:.4g} m from the origin, and it is {solid.extent:.4g} m large"
        raise InputError(key, problem, f"coordinates of at most {FARTHEST:g} times its size")
    if l_f > solid.extent:
        raise InputError(
            "discretization.l_f",
            f"{l_f:g} m is larger than the specimen",
            f"less than {solid.extent:.4g} m, better a tenth of the specimen's smallest dimension",
        )


def _check_whole(domain: Domain, key: str) -> None:
    """All cells must hang together."""
    c = domain.complex
    count = np.diff(c.part_start)
    cell = np.repeat(np.repeat(np.arange(len(c.low)), np.diff(c.plane_start)), count)
    open_ones = c.part_to >= 0
    links = (np.ones(int(open_ones.sum())), (cell[open_ones], c.part_to[open_ones]))
    parts, label = connected_components(coo_array(links, shape=(len(c.low),) * 2), directed=False)
    if parts > 1:
        volumes = np.sort(np.bincount(label, domain.cell_volumes))[::-1]
        shown = ", ".join(f"{v:.3g}" for v in volumes[:4]) + (", ..." if parts > 4 else "")
        raise InputError(key, f"the specimen falls into {parts} parts, of {shown} m^3", "a specimen in one piece")
