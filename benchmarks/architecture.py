"""Rooms of the source on docs/architecture.md: their table and their picture, both made from the code.

``--write docs/architecture.md`` writes both, ``--check`` tells whether page and picture are those of the code. What a
room is for is the first sentence of its package; layers are those of the contract in ``pyproject.toml``; arrows are the
imports that are there, but those that follow from others.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import grimp
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch, Rectangle
from PIL import Image

from common import ROOT, write_section

SOURCE = ROOT / "src" / "fissura"
PICTURE = ROOT / "docs" / "images" / "architecture.png"
COMMAND = "python benchmarks/architecture.py --write docs/architecture.md"

NAMES: dict[str, tuple[str, ...]] = {
    "cli": ("application.app", "console.errors"),
    "api": ("check.check", "pages.report"),
    "calibration": ("runner.calibrate", "problem.Problem", "result.Calibration"),
    "elasticity": ("homogenise.Homogenisation", "specimen.Prism", "study.study"),
    "study": ("definition.load_study", "runner.run_study", "measures.measure"),
    "ensemble": ("runner.run_ensemble", "plan.Plan", "result.EnsembleResult"),
    "batch": ("computing.compute_all", "machines.Machines"),
    "reports": ("run.run_page", "page.rendered", "view.scene_of"),
    "running": ("run.run", "recorder.Recorder", "checkpoint.Checkpoint"),
    "pictures": ("curves.curve_figure", "crack.plot_crack", "specimen.plot_specimen"),
    "progress": ("live.RunProgress", "time_left.TimeLeft"),
    "results": ("result.Result", "compare.compare", "curve.read_curve"),
    "simulation": ("loop.Simulation", "advance.advance", "state.State", "step.Step"),
    "adaptivity": ("criterion.rankine", "RefinedRegion", "transfer_history"),
    "equilibrium": ("System", "StepSolver", "PathFollower"),
    "linear": ("protocol.LinearSolver", "two_level.TwoLevel"),
    "contact": ("ContactLaw", "kinematics", "body_stress"),
    "tessellation": ("nuclei_from_case", "discretize", "Tessellation"),
    "material": ("materials_from_case", "field_from_case"),
    "specimen": ("domain_from_case", "conditions_from_case", "Domain", "Conditions"),
    "kernels": ("njit", "prepare_cache"),
    "machine": ("threads.usable_processors", "interrupts.shielded"),
    "case": ("load_case", "Case", "registry.CRITERIA"),
    "files": ("atomic.write_atomically", "folder.prepare_folder"),
    "text": ("quantities.force", "rows.aligned"),
    "arrays": ("FloatArray", "IntArray"),
    "errors": ("InputError", "RunStopped", "Notice"),
}
"""What to look for first in each room: names in its files, or in its package itself."""

DATA = {"templates": "case files that `fissura new` writes"}
"""Folders that are no rooms: nothing in them is imported."""

GROUPS = (
    ("what users call", ("cli", "api")),
    ("many runs", ("calibration", "elasticity", "study", "ensemble", "batch")),
    ("one run and\nwhat it leaves", ("reports", "running", "pictures", "progress", "results", "simulation")),
    ("the model", ("adaptivity", "equilibrium", "linear", "contact", "tessellation", "material", "specimen")),
    ("what all of it uses", ("kernels", "machine", "case", "files", "text", "arrays", "errors")),
)
COLOURS = ("#f4d9c6", "#f6e7bd", "#d7e8d0", "#cfe0f0", "#e2e2e6")
INK, LINE = "#30343b", "#5c6370"
WIDE, HIGH, STEP, GAP, APART = 2.0, 0.56, 1.0, 0.25, 3.0
"""Of boxes: width, height, distance of rows, more of it between groups, distance of columns."""
COLUMN = {
    "study": -3.6,
    "elasticity": 3.9,
    "batch": -3.6,
    "running": 1.25,
    "reports": 3.9,
    "files": 0.0,
    "text": 3.9,
    "arrays": -4.4,
    "errors": 0.0,
}
"""Rooms that stand elsewhere in their row, so that no arrow passes behind a box."""


def layers() -> list[list[str]]:
    """Layers of rooms from the top to the bottom, as the contract has them."""
    contract = _contract()
    found = [[room.strip() for room in layer.split("|")] for layer in contract["layers"]]
    return [layer for layer in found if layer != ["__main__"]]


def _contract() -> dict[str, list[str]]:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    found: dict[str, list[str]] = settings["tool"]["importlinter"]["contracts"][0]
    return found


def imports() -> dict[str, set[str]]:
    """Rooms that each room imports, without the exceptions of the contract and imports for type checkers."""
    graph = grimp.build_graph("fissura", exclude_type_checking_imports=True, cache_dir=None)
    for line in _contract()["ignore_imports"]:
        importer, imported = line.split(" -> ")
        graph.remove_import(importer=importer, imported=imported)
    rooms = [room for layer in layers() for room in layer]
    for room in rooms:
        if graph.find_children(f"fissura.{room}"):
            graph.squash_module(f"fissura.{room}")
    found = {room: graph.find_modules_directly_imported_by(f"fissura.{room}") for room in rooms}
    return {room: {name.partition(".")[2] for name in names} - {room, ""} for room, names in found.items()}


def needed(found: dict[str, set[str]]) -> dict[str, set[str]]:
    """Imports that do not follow from others."""

    def reached(room: str) -> set[str]:
        return found[room].union(*(reached(other) for other in found[room])) if found[room] else set()

    return {room: others - set().union(*(reached(other) for other in others)) for room, others in found.items()}


def task(room: str) -> str:
    """The first sentence of a room's package, without the room's own name before a colon."""
    path = SOURCE / room / "__init__.py"
    path = path if path.exists() else SOURCE / f"{room}.py"
    words = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
    assert words, f"{path} says nothing"
    first = words.partition("\n")[0].rstrip(".")
    name, colon, rest = first.partition(": ")
    return (rest if colon and " " not in name else first[0].lower() + first[1:]).replace("``", "`")


def names(room: str) -> list[str]:
    """What to look for first in a room; every name is there."""
    found = []
    for name in NAMES[room]:
        module, _, attribute = f"fissura.{room}.{name}".rpartition(".")
        getattr(import_module(module), attribute)
        found.append(attribute)
    return found


def rooms_there() -> set[str]:
    """Folders and files of the source that are rooms."""
    folders = {path.parent.name for path in SOURCE.glob("*/__init__.py")}
    return folders | {path.stem for path in SOURCE.glob("*.py") if not path.stem.startswith("__")}


def text() -> str:
    """The picture and the table, as the page has them."""
    rooms = [room for layer in layers() for room in layer]
    assert set(rooms) == rooms_there() == set(NAMES) == {room for _, members in GROUPS for room in members}
    lines = [
        f"Made by `{COMMAND}`.",
        "",
        "![Rooms in layers, and which room imports which](images/architecture.png)",
        "",
        "Every room may import the rooms in the layers below it, and no other. An arrow is an import that is there;"
        " what follows from other arrows is left out.",
        "",
        "| room | task | look for |",
        "|---|---|---|",
    ]
    lines += [f"| `{room}` | {task(room)} | {', '.join(f'`{name}`' for name in names(room))} |" for room in rooms]
    lines += [f"| `{folder}` | {what} | |" for folder, what in DATA.items()]
    return "\n".join(lines)


def drawing() -> Figure:
    """The picture of rooms and imports."""
    group = {room: k for k, (_, members) in enumerate(GROUPS) for room in members}
    place: dict[str, tuple[float, float]] = {}
    bands: dict[int, list[float]] = {}
    level, last = 0.0, 0
    for row in layers():
        here = group[row[0]]
        level -= STEP + (GAP if here != last else 0.0)
        last = here
        bands.setdefault(here, []).append(level)
        for k, room in enumerate(row):
            place[room] = (COLUMN.get(room, (k - 0.5 * (len(row) - 1)) * APART), level)
    figure = Figure(figsize=(8.0, -0.45 * level), layout="constrained")
    axes = figure.add_subplot()
    axes.set(xlim=(-6.5, 5.7), ylim=(level - 0.6, -0.3))
    axes.set_axis_off()
    for k, levels in bands.items():
        low, high = min(levels) - 0.5 * STEP, max(levels) + 0.5 * STEP
        axes.add_patch(Rectangle((-6.4, low), 12.0, high - low, facecolor=COLOURS[k], edgecolor="none", zorder=0))
        axes.text(-6.25, high - 0.12, GROUPS[k][0], va="top", fontsize=9, style="italic", color=INK)
    for room, others in needed(imports()).items():
        for other in sorted(others):
            _arrow(axes, place[room], place[other])
    for room, (x, y) in place.items():
        corner, style = (x - 0.5 * WIDE, y - 0.5 * HIGH), "round,pad=0,rounding_size=0.12"
        axes.add_patch(
            FancyBboxPatch(
                corner, WIDE, HIGH, boxstyle=style, facecolor="white", edgecolor=INK, linewidth=0.8, zorder=3
            )
        )
        axes.text(x, y, room, ha="center", va="center", fontsize=10, color=INK, zorder=4)
    return figure


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    """An arrow between boxes; one past many of them goes straight down and then to the side."""
    (x, y), (to_x, to_y) = start, end
    path = "arc3"
    if y - to_y > 6.0 * STEP:
        path = "angle,angleA=0,angleB=90" if to_x else "angle,angleA=90,angleB=0"
    side, over = 0.5 * WIDE, 0.0 if path.startswith("angle") else max(min(0.25 * (to_x - x), 0.7), -0.7)
    begin = (x + side, y) if path.startswith("angle,angleA=0,") else (x + over, y - 0.5 * HIGH)
    finish = (to_x - side, to_y) if path.startswith("angle,angleA=90") else (to_x - over, to_y + 0.5 * HIGH)
    axes.add_patch(
        FancyArrowPatch(
            begin,
            finish,
            connectionstyle=path,
            arrowstyle="-|>",
            mutation_scale=9,
            color=LINE,
            linewidth=1.0,
            shrinkA=0,
            shrinkB=0,
            zorder=2,
        )
    )


def digest() -> str:
    """Of all that the picture shows: layers and arrows."""
    shown = [layers(), {room: sorted(others) for room, others in sorted(needed(imports()).items())}]
    return hashlib.sha256(repr(shown).encode()).hexdigest()[:16]


def main() -> int:
    """Write or check the page and its picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path, metavar="PAGE", help="put picture and table into this page")
    parser.add_argument("--check", type=Path, metavar="PAGE", help="exit with 1 where they are not those of the code")
    found = parser.parse_args()
    if found.write:
        drawing().savefig(PICTURE, dpi=110, metadata={"Source": digest(), "Software": None})
        write_section(found.write, "architecture", text())
    if found.check:
        with Image.open(PICTURE) as picture:
            same = picture.info.get("Source") == digest()
        same = same and text() in found.check.read_text(encoding="utf-8")
        print("up to date" if same else f"old: {COMMAND}")
        return int(not same)
    return 0


if __name__ == "__main__":
    sys.exit(main())
