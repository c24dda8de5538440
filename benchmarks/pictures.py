"""Pictures of bodies and cracks for the documentation, and what keeping the section costs a run.

Breaks examples/beam_d200.toml far past its peak, adaptively and at full resolution, and an unnotched beam, and writes
docs/images/beam_d200_moments.png, beam_d200_bodies.png, beam_d200_refinement.gif and unnotched_moments.png. Results
are kept in the folder given (default results/pictures) and used again when they are there. --large runs
examples/beam_d400.toml, too, and times its pictures.
"""

from __future__ import annotations

import argparse
import time
import tomllib
from pathlib import Path

from PIL import Image

import fissura
from fissura.case import case_from_dict
from fissura.pictures.animation import animate
from fissura.pictures.comparison_files import save_bodies
from fissura.pictures.moments import plot_moments
from fissura.results import Result, compare
from fissura.results.history import FILE, HistoryWriter
from small_pictures import save_small

ROOT = Path(__file__).parents[1]
IMAGES = ROOT / "docs" / "images"
TARGET = "0.3 mm"


class Timed:
    """Processor time that a method takes, summed over its calls."""

    def __init__(self, owner: type, name: str) -> None:
        self.seconds = 0.0
        inner = getattr(owner, name)

        def wrapped(*args: object) -> object:
            start = time.process_time()
            try:
                return inner(*args)
            finally:
                self.seconds += time.process_time() - start

        setattr(owner, name, wrapped)


PARTS = [Timed(HistoryWriter, name) for name in ("start", "add", "write")]


def run(name: str, folder: Path, *, full: bool = False, **control: object) -> Path:
    if not (folder / FILE).exists():
        data = tomllib.loads((ROOT / "examples" / f"{name}.toml").read_text(encoding="utf-8"))
        data["control"] |= control
        data["name"] = name
        for part in PARTS:
            part.seconds = 0.0
        start = time.process_time()
        result = fissura.run(case_from_dict(data, ROOT / "examples"), full=full, output=folder, overwrite=True)
        whole, section = time.process_time() - start, sum(part.seconds for part in PARTS)
        size = (folder / FILE).stat().st_size
        print(
            f"{folder.name}: {result.steps} steps, {len(result.last.displacement)} bodies at the end; {whole:.2f} s,"
            f" of which {section:.3f} s ({section / whole:.2%}) for {FILE}; {size / 1e6:.2f} MB"
        )
    return folder


def time_pictures(folder: Path) -> None:
    start = time.process_time()
    plot_moments(folder, folder / "moments.png")
    middle = time.process_time()
    frames = animate(folder, folder / "refinement.gif")
    last = time.process_time() - middle
    print(f"{folder.name}: moments {middle - start:.1f} s, animation {last:.1f} s for {frames} frames")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / "results" / "pictures")
    parser.add_argument("--large", action="store_true", help="run beam_d400, too, and time its pictures")
    options = parser.parse_args()
    folder: Path = options.folder
    if options.large:
        for full in (False, True):
            time_pictures(run("beam_d400", folder / f"beam_d400{'_full' * full}", full=full))
    adaptive = run("beam_d200", folder / "beam_d200", target=TARGET)
    full = run("beam_d200", folder / "beam_d200_full", full=True, target=TARGET)
    unnotched = run("unnotched_beam", folder / "unnotched_beam")

    plot_moments(adaptive, IMAGES / "beam_d200_moments.png")
    save_bodies(compare(adaptive, full), IMAGES / "beam_d200_bodies.png")
    plot_moments(unnotched, IMAGES / "unnotched_moments.png", stress=True)
    for name in ("beam_d200_moments", "beam_d200_bodies", "unnotched_moments"):
        with Image.open(IMAGES / f"{name}.png") as picture:
            save_small(picture, IMAGES / f"{name}.png")
    animation = IMAGES / "beam_d200_refinement.gif"
    frames, steps = animate(adaptive, animation, width=880), Result.load(adaptive).steps
    print(f"{animation.name}: {frames} frames of {steps} steps, {animation.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
