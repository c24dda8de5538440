"""Pictures with a palette: for GIF, and for PNG files a third as large."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fissura.results.pictures import BLUE, ORANGE
from fissura.results.stage import COARSE, FINE, HEAT, TENSION

if TYPE_CHECKING:
    from PIL.Image import Image

__all__ = ["palette_of", "with_palette"]

Palette = NDArray[np.uint8]

CLOSE = 8.0
"""Colours nearer than this to one of the flat ones (of 255, along the diagonal) are taken for it."""


def palette_of(pictures: Sequence[Image], colours: int) -> Palette:
    """Find a palette for pictures of bodies and cracks.

    Parameters
    ----------
    pictures : sequence of Image
        Pictures of one size, mode RGB.
    colours : int
        Size of the palette, at most 256.

    Returns
    -------
    (colours, 3) array
        Red, green and blue.
    """
    from PIL import Image

    width, height = pictures[0].size
    # The colours of cracks cover little of a picture, but matter: half a picture of them is added; likewise stress.
    part = np.linspace(0.0, 1.0, width)
    shades = np.round(255 * np.stack([HEAT(part), TENSION(part)])[..., :3]).astype(np.uint8)
    sample = Image.new("RGB", (width, height * len(pictures) + height // 2))
    for k, picture in enumerate(pictures):
        sample.paste(picture, (0, k * height))
    sample.paste(Image.fromarray(np.repeat(shades, height // 4, axis=0)), (0, height * len(pictures)))
    reduced = sample.quantize(colours, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    values = np.array(reduced.getpalette(), dtype=np.int64).reshape(-1, 3)[:colours]
    # Large areas must have their colours exactly, and lines of the curve theirs.
    for colour in (BLUE, ORANGE, FINE, COARSE, "#ffffff"):
        exact = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
        distance = np.linalg.norm(values - exact, axis=1)
        values[distance <= max(float(distance.min()), CLOSE)] = exact
    return values.astype(np.uint8)


def with_palette(picture: Image, palette: Palette) -> Image:
    """The picture in the nearest colours of a palette, without dithering; mode P."""
    from PIL import Image

    pixels = np.asarray(picture.convert("RGB")).astype(np.int64)
    codes, place = np.unique(pixels @ np.array([65536, 256, 1]), return_inverse=True)
    found = np.stack([codes >> 16, codes >> 8 & 255, codes & 255], axis=1)
    nearest = np.asarray(cKDTree(palette.astype(np.float64)).query(found)[1]).astype(np.uint8)
    flat = Image.fromarray(nearest[place].reshape(pixels.shape[:2]))
    flat.putpalette(palette.ravel().tolist())
    return flat
