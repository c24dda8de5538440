"""Pictures of the documentation as small PNG files."""

from __future__ import annotations

from pathlib import Path

from PIL import Image

__all__ = ["save_small", "scaled", "with_palette"]


def scaled(picture: Image.Image, width: int) -> Image.Image:
    """The picture in another width [pixels]."""
    size = (width, round(width * picture.height / picture.width))
    return picture.convert("RGB").resize(size, Image.Resampling.LANCZOS)


def with_palette(picture: Image.Image) -> Image.Image:
    """The picture in 256 colours, a third as large as a file."""
    # Unlike a median cut, an octree keeps the colours of thin lines apart.
    return picture.convert("RGB").quantize(256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)


def save_small(picture: Image.Image, path: Path) -> None:
    """Save a picture with a palette, a third as large as without, and say how large it is."""
    with_palette(picture).save(path, optimize=True)
    print(f"{path.name}: {path.stat().st_size / 1e3:.0f} kB", flush=True)
