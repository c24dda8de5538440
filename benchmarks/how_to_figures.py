"""Pictures of docs/own-specimen.md and docs/paraview.md: runs the case and the Python of these pages."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from blocks import blocks
from common import ROOT
from small_pictures import save_small, scaled

IMAGES = ROOT / "docs" / "images"


def first(page: str, language: str) -> str:
    """The first block of a page in a language."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    return next(block.text for block in blocks(text) if block.language == language)


def own_specimen(folder: Path) -> None:
    """The specimen before its run, beside its cracks."""
    (folder / "tee.toml").write_text(first("own-specimen.md", "toml"), encoding="utf-8")
    for command in (["show", "tee.toml"], ["run", "tee.toml", "--quiet"]):
        subprocess.run([sys.executable, "-m", "fissura", *command], cwd=folder, check=True)
    height = 520
    parts = []
    for name in ("tee_specimen.png", "results/tee/crack.png"):
        with Image.open(folder / name) as picture:
            parts.append(scaled(picture, round(height * picture.width / picture.height)))
    whole = Image.new("RGB", (sum(part.width for part in parts), height), "white")
    for k, part in enumerate(parts):
        whole.paste(part, (sum(before.width for before in parts[:k]), 0))
    save_small(whole, IMAGES / "own_specimen.png")


def paraview(folder: Path) -> None:
    """The crack between warped bodies."""
    os.symlink(ROOT / "examples", folder / "examples")
    subprocess.run([sys.executable, "-c", first("paraview.md", "python")], cwd=folder, check=True)
    with Image.open(folder / "crack_paraview.png") as picture:
        save_small(picture, IMAGES / "paraview.png")


if __name__ == "__main__":
    for draw in (own_specimen, paraview):
        with TemporaryDirectory() as name:
            draw(Path(name))
