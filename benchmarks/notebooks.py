"""Runs the notebooks in docs/notebooks, each in an empty folder, and stores what their cells show.

--check stores nothing and tells what would be different, but for times and memory; names choose some of them.
"""

from __future__ import annotations

import argparse
import io
import math
import re
import sys
import time
from base64 import b64decode, b64encode
from difflib import unified_diff
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import nbformat
from nbclient import NotebookClient
from PIL import Image

from small_pictures import with_palette
from tutorial import VARY

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "notebooks"

LONGEST = 600
"""Seconds that a cell may take."""

_NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?")


def notebooks() -> list[Path]:
    """All notebooks."""
    return sorted(FOLDER.glob("*.ipynb"))


def executed(path: Path) -> Any:
    """A notebook with what its cells show now.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        A cell fails.
    """
    notebook = nbformat.read(path, as_version=4)
    with TemporaryDirectory() as folder:
        place = {"metadata": {"path": folder}}
        NotebookClient(notebook, timeout=LONGEST, kernel_name="python3", resources=place).execute()
    return tidied(notebook)


def tidied(notebook: Any) -> Any:
    """The same without what differs from machine to machine, and without lines of progress, which are empty now."""
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    for cell in notebook.cells:
        cell.metadata = {}
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if not _is_empty(output)]
            for output in cell.outputs:
                output.pop("transient", None)
                output.get("data", {}).pop("image/jpeg", None)  # PNG is there, too
                if "image/png" in output.get("data", {}):
                    output.data["image/png"] = _small(output.data["image/png"])
    return notebook


def texts(notebook: Any) -> list[str]:
    """What cells print, and results as plain text, line by line; rows of times and memory aside."""
    lines: list[str] = []
    for number, cell in enumerate(notebook.cells):
        for output in cell.get("outputs", ()):
            text = output.get("text") or output.get("data", {}).get("text/plain", "")
            kept = [line for line in text.splitlines() if not line.startswith((*VARY, "memory"))]
            lines += [f"cell {number}: {line}" for line in kept]
    return lines


def differences(old: Any, new: Any) -> list[str]:
    """Lines that differ; numbers may differ by a hundredth: last digits depend on the processor."""
    before, now = texts(old), texts(new)
    if len(before) == len(now) and all(map(_alike, before, now)):
        return []
    return list(unified_diff(before, now, "stored", "now", n=0, lineterm=""))


def _alike(one: str, other: str) -> bool:
    """Whether two lines say the same, but for blanks and last digits."""
    words = [[re.sub(r"\s+", " ", word) for word in _NUMBER.split(line)] for line in (one, other)]
    numbers = [[float(number) for number in _NUMBER.findall(line)] for line in (one, other)]
    return words[0] == words[1] and all(
        math.isclose(a, b, rel_tol=0.01, abs_tol=1e-12) for a, b in zip(*numbers, strict=True)
    )


def _is_empty(output: Any) -> bool:
    if output.output_type == "stream":
        return "bad X server connection" in output.text  # VTK says so where there is no screen, and draws
    data = output.get("data")
    return data is not None and not any(data.values())


def _small(data: str) -> str:
    """A picture with few colours, which takes a third of the bytes."""
    with Image.open(io.BytesIO(b64decode(data))) as picture:
        buffer = io.BytesIO()
        with_palette(picture).save(buffer, "PNG", optimize=True)
    return b64encode(buffer.getvalue()).decode()


def main() -> int:
    """Run notebooks and store them, or tell what differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--check", action="store_true", help="store nothing; status 1 if what cells print differs")
    parser.add_argument("names", nargs="*", help="notebooks, without their ending; by default all")
    options = parser.parse_args()
    found = False
    for path in notebooks():
        if options.names and path.stem not in options.names:
            continue
        began = time.perf_counter()
        stored, now = nbformat.read(path, as_version=4), executed(path)
        print(f"{path.stem}: {time.perf_counter() - began:.0f} s")
        different = differences(stored, now)
        found = found or bool(different)
        if options.check:
            print("\n".join(different))
        else:
            nbformat.write(now, path)
    return 1 if options.check and found else 0


if __name__ == "__main__":
    sys.exit(main())
