"""Runs docs/tutorial.md: its commands, changes of files and Python in their order, in an empty folder.

Writes what they print into the page, and the pictures that it shows. --check only tells what would be different.
"""

from __future__ import annotations

import argparse
import os
import shlex
import subprocess
import sys
from difflib import unified_diff
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from blocks import blocks
from small_pictures import save_small, scaled

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "tutorial.md"

#: Pictures on the page, and where the commands leave them.
PICTURES = {
    "tutorial_specimen.png": "beam_specimen.png",
    "tutorial_curve.png": "results/beam/curve.png",
    "tutorial_moments.png": "results/beam/moments.png",
    "tutorial_compare.png": "results/deep/compare_bodies.png",
    "tutorial_ensemble.png": "results/beam_ensemble/pictures/curves.png",
}

#: Rows that differ from run to run.
VARY = ("time", "memory", "processor time", "wall time")

_WIDEST, _PICTURE_WIDTH = 110, 1200


def worked(page: str, folder: Path) -> str:
    """The page with what its commands print now, run in a folder.

    Raises
    ------
    ValueError
        If a block cannot be run as it stands.
    subprocess.CalledProcessError
        If a command fails.
    """
    printed, parts, last = "", [], 0
    for block in blocks(page):
        if block.language == "bash":
            printed = "".join(command(line, folder) for line in block.text.splitlines())
        elif block.language == "python":
            printed = output([sys.executable, "-c", block.text], folder)
        elif block.language == "diff" and block.title:
            path = folder / block.title
            path.write_text(changed(path.read_text(encoding="utf-8"), block.text), encoding="utf-8")
        elif block.language == "text":
            parts += [page[last : block.start], "".join(f"{shortened(line)}\n" for line in printed.splitlines())]
            last = block.end
    return "".join([*parts, page[last:]])


def command(line: str, folder: Path) -> str:
    """Run a line such as ``fissura new beam > beam.toml``; returns what it prints."""
    words = shlex.split(line)
    target = words[words.index(">") + 1] if ">" in words else None
    words = words[: words.index(">")] if ">" in words else words
    if words[0] != "fissura":
        raise ValueError(f"{line!r} does not begin with fissura")
    text = output([sys.executable, "-m", *words], folder)
    if target is None:
        return text
    (folder / target).write_text(text, encoding="utf-8")
    return ""


def output(words: list[str], folder: Path) -> str:
    """What a program prints."""
    utf8 = {**os.environ, "PYTHONUTF8": "1"}
    done = subprocess.run(words, cwd=folder, env=utf8, stdout=subprocess.PIPE, encoding="utf-8", check=True)
    return done.stdout


def changed(text: str, diff: str) -> str:
    """A file with lines exchanged, which may have a comment: a line of the block with ``-``, then one with ``+``."""
    lines, pairs = text.splitlines(), diff.splitlines()
    code = [line.partition("#")[0].rstrip() for line in lines]
    for old, new in zip(pairs[::2], pairs[1::2], strict=True):
        if (old[0], new[0], code.count(old[1:])) != ("-", "+", 1):
            raise ValueError(f"{old!r} stands in the file {code.count(old[1:])} times; it is to become {new!r}")
        lines[code.index(old[1:])] = new[1:]
    return "\n".join([*lines, ""])


def shortened(line: str) -> str:
    """A line that fits on the page."""
    return line.rstrip() if len(line) <= _WIDEST else line[: _WIDEST - 2].rpartition(" ")[0] + " …"


def differences(page: str, new: str) -> list[str]:
    """Lines that differ, but for rows of time and memory."""
    kept = [[line for line in text.splitlines() if not line.startswith(VARY)] for text in (page, new)]
    return list(unified_diff(*kept, "page", "now", n=0, lineterm=""))


def draw(folder: Path) -> None:
    """Put the pictures of the page into the documentation."""
    for name, source in PICTURES.items():
        with Image.open(folder / source) as picture:
            save_small(scaled(picture, _PICTURE_WIDTH), PAGE.parent / "images" / name)


def main() -> int:
    """Run the page and write it, or tell what differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing; status 1 if numbers on the page differ")
    check = parser.parse_args().check
    page = PAGE.read_text(encoding="utf-8")
    with TemporaryDirectory() as name:
        new = worked(page, Path(name))
        if not check:
            draw(Path(name))
            PAGE.write_text(new, encoding="utf-8")
    found = differences(page, new)
    print("\n".join(found))
    return 1 if check and found else 0


if __name__ == "__main__":
    sys.exit(main())
