"""Pictures of docs/specimens.md: every case that `fissura new` prints, as `fissura show` draws it, and a 3D view.

It also breaks examples/beam_d100.toml and writes the view of docs/python.md. --folder keeps the single pictures.
"""

from __future__ import annotations

import argparse
import sys
import tomllib
from importlib.resources import files
from itertools import permutations
from pathlib import Path
from tempfile import TemporaryDirectory

import meshio
import numpy as np
from PIL import Image

from common import ROOT, say
from fissura import run
from fissura.case import case_from_dict, load_case
from fissura.pictures.pyvista_tools import screenshot
from fissura.pictures.specimen import plot_specimen
from fissura.pictures.specimen_window import specimen_view
from fissura.simulation.loop import Simulation
from small_pictures import save_small, scaled

TEMPLATES = Path(str(files("fissura") / "templates"))
COLUMNS, WIDTH = 3, 560


def block(path: Path) -> None:
    """The mesh that the template asks for: a block of 80 x 30 x 30 mm in mm, its ends named left and right."""
    count = np.array([5, 2, 2])
    numbers = np.arange((count + 1).prod()).reshape(count + 1)
    points = np.stack(np.unravel_index(numbers.ravel(), numbers.shape), axis=-1) / count * [80.0, 30.0, 30.0]
    first = np.stack(np.meshgrid(*map(np.arange, count), indexing="ij"), axis=-1).reshape(-1, 3)
    tetrahedra = []
    for order in permutations(range(3)):  # the ways along the edges of a cube from its first corner to its last
        steps = np.cumsum([[0, 0, 0], *np.eye(3, dtype=int)[list(order)]], axis=0)
        steps = steps if np.linalg.det(np.diff(steps, axis=0)) > 0.0 else steps[[0, 2, 1, 3]]
        tetrahedra.append(numbers[tuple((first[:, None] + steps).transpose(2, 0, 1))])
    tetrahedra = np.concatenate(tetrahedra)
    faces = tetrahedra[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]].reshape(-1, 3)
    ends = [faces[(points[faces, 0] == x).all(axis=1)] for x in (0.0, 80.0)]
    names = np.repeat([1, 2], [len(end) for end in ends])
    mesh = meshio.Mesh(
        points,
        [("triangle", np.concatenate(ends)), ("tetra", tetrahedra)],
        cell_data={tag: [names, np.full(len(tetrahedra), 3)] for tag in ("gmsh:physical", "gmsh:geometrical")},
        field_data={"left": np.array([1, 2]), "right": np.array([2, 2]), "concrete": np.array([3, 3])},
    )
    meshio.write(path, mesh, file_format="gmsh22", binary=False)


def with_platens(path: Path) -> None:
    """The view of a beam on platens, bent by two loads and its weight."""
    data = tomllib.loads((TEMPLATES / "four-point.toml").read_text(encoding="utf-8"))
    for place in (*data["supports"], *data["loads"].values()):
        place |= {"width": "20 mm", "platen": "glued"}
    case = case_from_dict(data | {"name": "four-point", "gravity": {"density": "2400 kg/m^3"}})
    screenshot(specimen_view(Simulation(case), off_screen=True), path)
    with Image.open(path) as picture:
        save_small(picture, path)


def main() -> int:
    """Draw all templates and put the pictures beside each other."""
    parser = argparse.ArgumentParser(description=__doc__)
    place = ROOT / "docs" / "images" / "specimens.png"
    parser.add_argument("--picture", type=Path, default=place, metavar="PATH")
    parser.add_argument("--view", type=Path, default=place.with_name("specimen_view.png"), metavar="PATH")
    parser.add_argument("--result", type=Path, default=place.with_name("result_view.png"), metavar="PATH")
    parser.add_argument("--folder", type=Path, metavar="PATH")
    found = parser.parse_args()
    pictures = []
    with TemporaryDirectory() as name:
        folder = Path(name) if found.folder is None else found.folder
        folder.mkdir(parents=True, exist_ok=True)
        block(folder / "block.msh")
        for template in sorted(TEMPLATES.glob("*.toml")):
            say(template.stem)
            case = folder / template.name
            case.write_text(template.read_text(encoding="utf-8"), encoding="utf-8")
            plot_specimen(Simulation(load_case(case)), case.with_suffix(".png"))
            with Image.open(case.with_suffix(".png")) as picture:
                pictures.append(scaled(picture, WIDTH))
    rows, height = -(-len(pictures) // COLUMNS), max(picture.height for picture in pictures)
    gallery = Image.new("RGB", (COLUMNS * WIDTH, rows * height), "white")
    for k, picture in enumerate(pictures):
        gallery.paste(picture, ((k % COLUMNS) * WIDTH, (k // COLUMNS) * height))
    save_small(gallery, found.picture)
    with_platens(found.view)
    run(ROOT / "examples" / "beam_d100.toml").show(output=found.result)
    with Image.open(found.result) as picture:
        save_small(picture, found.result)
    return 0


if __name__ == "__main__":
    sys.exit(main())
