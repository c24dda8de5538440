"""Hand-made and Voronoi structures, steps and cases for the tests of this room."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from scipy.spatial import Voronoi

from fissura.case import case_from_dict
from fissura.simulation.step import Snapshot, Step
from fissura.specimen import domain_from_case
from fissura.tessellation.tessellation import Contacts, Polygons, SurfaceFacets, Tessellation

FACES = ("left", "right", "bottom", "top", "front", "back")


def voronoi_structure(x, size, fine=None):
    """Voronoi cells of nuclei in the box [0, size]: nuclei mirrored in all six faces."""
    x, size = np.asarray(x, float), np.asarray(size, float)
    n = len(x)
    images, owner = [x], [np.arange(n)]
    for axis in range(3):
        for plane in (0.0, size[axis]):
            mirrored = x.copy()
            mirrored[:, axis] = 2 * plane - mirrored[:, axis]
            images.append(mirrored)
            owner.append(np.arange(n))
    everything = np.concatenate(images)
    vor = Voronoi(everything)
    fine = np.ones(n, bool) if fine is None else fine
    contacts, surface = [], []
    for (p, q), ridge in zip(vor.ridge_points, vor.ridge_vertices, strict=True):
        p, q = min(p, q), max(p, q)
        if p >= n or -1 in ridge:
            continue
        polygon = vor.vertices[ridge]
        if q < n:
            contacts.append((p, q, polygon))
        elif (q - n) % n == p:
            surface.append((p, (q - n) // n, polygon))
    contacts.sort(key=lambda c: c[:2])
    surface.sort(key=lambda c: c[:2])
    area, centroid = measures([c[2] for c in contacts])
    keep = area > 1e-9 * size.min() ** 2
    contacts = [c for c, k in zip(contacts, keep, strict=True) if k]
    area, centroid = area[keep], centroid[keep]
    bodies = np.array([c[:2] for c in contacts], dtype=np.int64)
    step = x[bodies[:, 1]] - x[bodies[:, 0]]
    length = np.linalg.norm(step, axis=1)
    normal = step / length[:, None]
    s_area, s_centroid = measures([s[2] for s in surface])
    s_body = np.array([s[0] for s in surface])
    s_surface = np.array([s[1] for s in surface])
    s_normal = np.zeros((len(surface), 3))
    s_normal[np.arange(len(surface)), s_surface // 2] = np.where(s_surface % 2, 1.0, -1.0)
    volume = np.zeros(n)
    third = area * np.einsum("mc,mc->m", centroid - x[bodies[:, 0]], normal) / 3
    np.add.at(volume, bodies[:, 0], third)
    np.add.at(volume, bodies[:, 1], area * length / 3 - third)
    np.add.at(volume, s_body, s_area * np.einsum("bc,bc->b", s_centroid - x[s_body], s_normal) / 3)
    return Tessellation(
        nucleus=np.arange(n),
        x=x,
        fine=fine,
        volume=volume,
        contacts=Contacts(
            bodies, area, centroid, normal, length, fine[bodies].all(axis=1), pack([c[2] for c in contacts])
        ),
        surface=SurfaceFacets(s_body, s_area, s_centroid, s_normal, s_surface, FACES, pack([s[2] for s in surface])),
    )


def pack(polygons):
    sizes = [len(p) for p in polygons]
    return Polygons(np.concatenate(polygons), np.concatenate([[0], np.cumsum(sizes)]), np.arange(len(polygons)))


def measures(polygons):
    area, centroid = np.zeros(len(polygons)), np.zeros((len(polygons), 3))
    for k, p in enumerate(polygons):
        cross = np.cross(p[1:-1] - p[0], p[2:] - p[0])
        axis = cross.sum(axis=0) / np.linalg.norm(cross.sum(axis=0))
        part = cross @ axis / 2
        area[k] = part.sum()
        centroid[k] = part @ (p[0] + p[1:-1] + p[2:]) / 3 / area[k]
    return area, centroid


def random_points(n, size, seed=1, spacing=0.0):
    rng = np.random.default_rng(seed)
    if not spacing:
        return rng.uniform(size=(n, 3)) * size
    kept = np.empty((0, 3))
    for trial in rng.uniform(size=(40 * n, 3)) * size:
        if len(kept) == n:
            break
        if not len(kept) or np.sum((kept - trial) ** 2, axis=1).min() > spacing**2:
            kept = np.vstack([kept, trial])
    return kept


def stack():
    """2 x 1 x 1 cubes of 10 mm."""
    return voronoi_structure([[0.005, 0.005, 0.005], [0.015, 0.005, 0.005]], [0.02, 0.01, 0.01])


def snapshot(t, displacement=None, opening=None):
    n, m = len(t), len(t.contacts)
    opening = np.zeros(m) if opening is None else opening
    helper = np.where(np.abs(t.contacts.normal[:, :1]) < 0.7, [[1.0, 0, 0]], [[0, 1.0, 0]])
    first = np.cross(t.contacts.normal, helper)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return Snapshot(
        tessellation=t,
        displacement=np.zeros((n, 6)) if displacement is None else displacement,
        stress=np.tile(np.diag([2e6, 1e6, -3e6]), (n, 1, 1)),
        criterion=np.where(t.fine, np.nan, 0.5),
        strain=np.tile([1e-4, 2e-5, 3e-5], (m, 1)),
        traction=np.tile([2e6, 1e6, 5e5], (m, 1)),
        tangents=np.stack([first, np.cross(t.contacts.normal, first)], axis=1),
        damage=np.where(opening > 0, 0.9, 0.0),
        opening=opening,
    )


def step(number, gauge, load, shot=None, **changes):
    values = {
        "number": number,
        "gauge": gauge,
        "load": load,
        "load_displacement": gauge / 2,
        "bodies": 2,
        "fine_bodies": 2,
        "refinements": 0,
        "coarsenings": 0,
        "iterations": 4,
        "linear_iterations": 30,
        "factorizations": 2,
        "dissipated": 1e-3 * number,
        "stored": 1e-3,
        "work": 1e-3 * number + 1.01e-3,
        "exchanged": 0.0,
        "max_elastic_utilisation": 0.8,
        "residual": 1e-6,
        "snapshot": snapshot(stack()) if shot is None else shot,
        "held": ("support_0",),
        "reactions": np.zeros((1, 6)),
        "dissipated_at": np.zeros(3),
        "done": min(max(gauge / 1e-4, 0.0), 1.0),
    }
    return Step(**(values | changes))


def case(control=None, **output):
    """Small valid case: a notched beam 20 mm long, target 0.1 mm, 2 snapshots."""
    data = {
        "name": "little beam",
        "seed": 7,
        "specimen": {"size": ["20 mm", "10 mm", "10 mm"]},
        "supports": [{"type": "pin", "face": "bottom", "at": "2 mm"}],
        "load": {"face": "top", "at": "10 mm", "width": "2 mm"},
        "gauge": {"a": {"face": "bottom", "at": "9 mm"}, "b": {"face": "bottom", "at": "11 mm"}},
        "material": {"E": "60 GPa", "alpha": 0.29, "f_t": "2.2 MPa", "G_t": "35 J/m^2"},
        "discretization": {"l_f": "2 mm"},
        "control": {"target": "0.1 mm"} | (control or {}),
        "output": {"vtk": 2} | output,
    }
    return case_from_dict(data)


def simulation(control=None, **output):
    """Stand-in for a simulation: what a recorder asks of it."""
    its_case = case(control, **output)
    return SimpleNamespace(
        case=its_case,
        domain=domain_from_case(its_case),
        full=False,
        notices=(),
        bodies_start=2,
        bodies_full=40,
        bodies_full_estimated=False,
        told_full="40",
        nuclei_given=0,
        initial_stiffness=1.5e8,
        elastic_scale=0.9,
        calibration_error=None,
        cpu_repeated=0.1,
        cpu_refining=0.2,
    )


def steps(loads, target=1e-4, **changes):
    """Steps at evenly spaced gauges up to the target."""
    count = len(loads)
    shot = snapshot(stack(), opening=np.array([3e-6]))
    return [step(k + 1, target * (k + 1) / count, load, shot, **changes) for k, load in enumerate(loads)]


#: Gauges [m], loads [N] and dissipated energies [J] of a path that turns back after the third step. The energies of the
#: elastic steps are zero up to round-off.
SNAP_BACK = (
    [1e-5, 2e-5, 3e-5, 2.5e-5, 2e-5, 2.2e-5],
    [100.0, 200.0, 300.0, 200.0, 60.0, 30.0],
    [1e-21, -2e-21, 1e-3, 2e-3, 4e-3, 5e-3],
)


def snapping(gauges=SNAP_BACK[0], loads=SNAP_BACK[1], energies=SNAP_BACK[2]):
    """Steps along a path that turns back; energy leads from the third on."""
    shot = snapshot(stack(), opening=np.array([3e-6]))
    return [
        step(k, gauge, load, shot, dissipated=energy, control="gauge" if k < 3 else "dissipation")
        for k, (gauge, load, energy) in enumerate(zip(gauges, loads, energies, strict=True), 1)
    ]
