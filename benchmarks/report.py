"""Sizes of reports, and the picture of docs/report.md.

Breaks some examples, makes their reports, and writes a table of their sizes into the page that --write names. --picture
opens the report of examples/beam_d200.toml, run with 20 states, in a browser (chromium, and the package playwright) and
writes docs/images/report.png. Results are kept in the folder given (default results/reports), and used again.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import time
import tomllib
from pathlib import Path

import fissura
from common import ROOT, machine, say, table, write_section
from fissura.case import case_from_dict
from fissura.pictures.meshes import steps_with_states
from fissura.reports.bodies import shown_steps, states_of
from fissura.reports.libraries import k3d, plotly
from fissura.reports.packed import packed_size
from fissura.results import Result

#: Example, whether at full resolution, states that are recorded evenly.
RUNS = [
    ("beam_d100", False, 5),
    ("beam_d200", False, 5),
    ("beam_d200", False, 20),
    ("winkler_lpanel", False, 5),
    ("beam_d400", False, 5),
    ("beam_d400", True, 5),
    ("beam_d400", True, 50),
]


def result_of(name: str, full: bool, states: int, folder: Path) -> Result:
    place = folder / f"{name}{'_full' if full else ''}_{states}"
    if not (place / "summary.json").exists():
        say(f"running {place.name}")
        data = tomllib.loads((ROOT / "examples" / f"{name}.toml").read_text(encoding="utf-8"))
        data["output"] = data.get("output", {}) | {"vtk": states}
        data["name"] = name
        fissura.run(case_from_dict(data, ROOT / "examples"), full=full, output=place, overwrite=True)
    return Result.load(place)


def row(name: str, full: bool, states: int, folder: Path) -> list[str]:
    result = result_of(name, full, states, folder)
    start = time.perf_counter()
    size = result.report().stat().st_size
    seconds = time.perf_counter() - start
    found = states_of(result, shown_steps(result))
    say(f"{result.folder}: {size / 1e6:.2f} MB")
    return [
        f"`{name}`{', full resolution' if full else ''}",
        str(result.summary["bodies_end"]),
        str(result.steps),
        str(len(steps_with_states(result))),
        str(len(found)),
        f"{packed_size(found) / 1e6:.2f}",
        f"{size / 1e6:.2f}",
        f"{seconds:.1f}",
    ]


def picture(path: Path, page: Path) -> None:
    """The upper part of a page, as a browser shows it at a step after the peak."""
    from playwright.sync_api import sync_playwright

    browser = shutil.which("chromium") or shutil.which("google-chrome")
    options = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=browser, args=options)
        shown = started.new_page(viewport={"width": 1180, "height": 800}, color_scheme="light")
        shown.goto(page.resolve().as_uri())
        shown.wait_for_selector("html[data-ready]", timeout=120_000)
        shown.wait_for_timeout(1000)
        shown.screenshot(path=path)
        started.close()
    from gallery import shrink

    shrink(path)
    say(f"picture: {path}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--folder", type=Path, default=Path("results/reports"), help="where results are kept")
    parser.add_argument("--write", type=Path, metavar="PAGE", help="put the table into this Markdown page")
    parser.add_argument("--picture", action="store_true", help="write docs/images/report.png only")
    found = parser.parse_args()
    if found.picture:
        result = result_of("beam_d200", False, 20, found.folder)
        picture(ROOT / "docs" / "images" / "report.png", result.report())
        return 0
    heads = ["run", "bodies", "steps", "recorded", "in the page", "bodies and cracks [MB]", "page [MB]", "made in [s]"]
    text = table(heads, [row(*which, found.folder) for which in RUNS])
    here, libraries = machine(), (plotly(), k3d())
    sizes = ", ".join(f"{one.name} {one.version} {len(one.code) / 1e6:.2f} MB" for one in libraries)
    text = (
        f"Made by `python benchmarks/report.py --write docs/report.md` on {here['processor']}, while other processes"
        f" ran. Of each page libraries take {sum(len(one.code) for one in libraries) / 1e6:.2f} MB: {sizes}.\n\n{text}"
    )
    print(text)
    if found.write:
        write_section(found.write, "report", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
