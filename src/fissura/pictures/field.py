"""Picture of the random field of a run: slices, colours of bodies, and the marginal distribution with its tail."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator
from scipy.special import log_ndtr, ndtri

from fissura.arrays import FloatArray
from fissura.case import Field
from fissura.material.field import Marginal, RandomField
from fissura.pictures.curves import BLUE, DPI, GREY, INK, ORANGE, bare, legend, tidy
from fissura.pictures.front import projected, rims, seen
from fissura.pictures.lettering import literal, may_shrink, save
from fissura.pictures.panels import plain_bar
from fissura.specimen import Domain
from fissura.tessellation import Tessellation

COLOURS = LinearSegmentedColormap.from_list(
    "strength", ["#5c1124", "#b8402f", "#eba77c", "#f6f3ee", "#9dbfd8", "#3f78ab", "#153a63"]
)
"""Weak is red, the mean is pale, strong is blue."""

PIXELS = 260
"""Pixels of a slice along its longer side."""

PROBABILITIES = (1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.1, 0.5, 0.9, 0.999)
"""Probabilities that the paper is labelled with."""


def plot_field(
    field: RandomField,
    part: Field,
    domain: Domain,
    tessellation: Tessellation,
    path: Path,
    name: str = "",
) -> None:
    """Draw two slices of a realisation, the bodies on the front in its colours, and its marginal distribution.

    Parameters
    ----------
    field : RandomField
        The realisation.
    part : Field
        Its table in the case, for the text.
    domain : Domain
        The specimen.
    tessellation : Tessellation
        Bodies to be coloured.
    path : Path
        File to write; its ending decides the format.
    name : str, optional
        Headline.
    """
    size = domain.size
    tall = size[1] > 1.2 * size[0]
    figure = Figure(layout="constrained")
    if tall:
        figure.set_size_inches(9.0, 5.2 + float(np.clip(5.4 * size[1] / (2.0 * size[0] + size[2]), 2.5, 7.0)))
        places = figure.subplot_mosaic(
            [["slice", "across", "bodies"], ["paper"] * 3],
            width_ratios=[max(side, 0.4 * size[0]) for side in (size[0], size[2], size[0])],
            height_ratios=(figure.get_figheight() - 4.2, 3.6),
        )
    else:
        heights = [max(side, 0.5 * size[1]) for side in (size[1], size[2], size[1])]
        figure.set_size_inches(11.0, 3.2 + float(np.clip(5.6 * sum(heights) / size[0], 1.6, 7.0)))
        places = figure.subplot_mosaic(
            [["slice", "paper"], ["across", "paper"], ["bodies", "paper"]],
            width_ratios=(1.5, 1.0),
            height_ratios=heights,
        )
    norm = Normalize(1.0 - 3.0 * part.cov, 1.0 + 3.0 * part.cov)
    draw_slice(places["slice"], field, domain, (0, 1), norm)
    draw_slice(places["across"], field, domain, (2, 1) if tall else (0, 2), norm)
    _draw_bodies(places["bodies"], tessellation, field.strength(tessellation.x), domain.bounds, norm)
    bar = figure.colorbar(
        ScalarMappable(norm, COLOURS), ax=[places[k] for k in ("slice", "across", "bodies")], shrink=0.7, aspect=30
    )
    plain_bar(bar, "relative strength H")
    draw_marginal(places["paper"], field.marginal, part.marginal, _samples(field, domain))
    titles = {"slice": "middle of the thickness", "across": f"middle of the {'length' if tall else 'depth'}"}
    for key, title in (titles | {"bodies": "bodies on the front"}).items():
        places[key].set_title(title, loc="left", fontsize=9, color=INK)
    lengths = " × ".join(f"{1e3 * length:.4g}" for length in part.length)
    note = f"{part.correlation} correlation, length {lengths} mm, CoV {part.cov:g}, seed {field.seed}"
    title = f"{literal(name)}\n{note}" if name else note
    may_shrink(figure.suptitle(title, x=0.01, ha="left", fontsize=10, color=INK))
    save(figure, path, DPI)


def draw_slice(axes: Axes, field: RandomField, domain: Domain, plane: tuple[int, int], norm: Normalize) -> None:
    """Draw the relative strength on a plane through the middle of a specimen, spanned by two axes."""
    low, high = domain.bounds
    (width, height), (left, bottom) = (high - low)[list(plane)], low[list(plane)]
    pixel = max(width, height) / PIXELS
    across, up = ((np.arange(max(round(s / pixel), 1)) + 0.5) for s in (width, height))
    x = np.tile(0.5 * (low + high), (len(up), len(across), 1))
    x[:, :, plane[0]] = left + across * width / len(across)
    x[:, :, plane[1]] = (bottom + up * height / len(up))[:, None]
    points = x.reshape(-1, 3)
    values = np.where(domain.contains(points), field.strength(points), np.nan).reshape(x.shape[:2])
    extent = (1e3 * left, 1e3 * (left + width), 1e3 * bottom, 1e3 * (bottom + height))
    axes.imshow(values, cmap=COLOURS, norm=norm, origin="lower", extent=extent, aspect="equal", interpolation="nearest")
    bare(axes, *("xyz"[axis] for axis in plane))


def _draw_bodies(
    axes: Axes, tessellation: Tessellation, factor: FloatArray, bounds: FloatArray, norm: Normalize
) -> None:
    surface = tessellation.surface
    polygons, chosen = surface.polygons, seen(surface)
    shapes, body = projected(polygons, chosen), surface.body[polygons.facet[chosen]]
    axes.add_collection(
        PolyCollection(shapes, facecolors=COLOURS(norm(factor[body])), edgecolors="face", linewidths=0.4)
    )
    lines = 1e3 * rims(polygons, chosen, body)[:, :, :2]
    axes.add_collection(LineCollection(list(lines), colors="#ffffffb0", linewidths=0.25))
    axes.set_xlim(*(1e3 * bounds[:, 0]))
    axes.set_ylim(*(1e3 * bounds[:, 1]))
    axes.set_aspect("equal")
    bare(axes)


def _samples(field: RandomField, domain: Domain) -> FloatArray:
    """Values of a realisation all over a specimen, sorted."""
    low, size = domain.bounds[0], domain.size
    count = [12 + round(28 * s / max(size)) for s in size]
    axes = [(np.arange(n) + 0.5) * s / n for n, s in zip(count, size, strict=True)]
    points = low + np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.sort(field.strength(points[domain.contains(points)]))


def draw_marginal(axes: Axes, marginal: Marginal, name: str, samples: FloatArray | None = None) -> None:
    """Draw a distribution on Weibull probability paper, where a Weibull distribution is a straight line.

    Parameters
    ----------
    axes : Axes
        Where.
    marginal : Marginal
        The distribution; a graft is marked, and both its parts are drawn beyond it.
    name : str
        For the legend.
    samples : (n,) array, optional
        Sorted values of a realisation.
    """
    z = np.linspace(ndtri(PROBABILITIES[0]) - 0.2, ndtri(PROBABILITIES[-1]), 400)
    h = marginal.from_gaussian(z)
    axes.plot(np.log(h), _paper(marginal.log_cdf(h)), color=BLUE, linewidth=2.0, label=name, zorder=3)
    low, high = np.log(h[0]), np.log(h[-1])
    if getattr(marginal, "point", None) is not None:
        _draw_graft(axes, marginal, low, high)
    if samples is not None:
        rank = (np.arange(len(samples)) + 0.5) / len(samples)
        kept = np.unique(np.round(np.geomspace(1, len(samples), 120)).astype(int)) - 1
        kept = np.union1d(kept, len(samples) - 1 - kept)
        label = "this realisation, by volume"
        axes.plot(
            np.log(samples[kept]), _paper(np.log(rank[kept])), ".", color=INK, markersize=3, label=label, zorder=3
        )
        low, high = min(low, np.log(samples[0])), max(high, np.log(samples[-1]))
    tidy(axes)
    axes.set_xlim(low - 0.05, high + 0.1)
    axes.set_ylim(_paper(np.log([PROBABILITIES[0]]))[0], _paper(np.log([0.9999]))[0])
    axes.yaxis.set_major_locator(FixedLocator(_paper(np.log(PROBABILITIES)).tolist()))
    axes.set_yticklabels([f"{p:g}" for p in PROBABILITIES])
    marks = [v for v in (0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0) if low - 0.05 < np.log(v) < high + 0.1]
    axes.xaxis.set_major_locator(FixedLocator(np.log(marks).tolist()))
    axes.set_xticklabels([f"{v:g}" for v in marks])
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_xlabel("relative strength H")
    axes.set_ylabel("probability of less")
    axes.set_title("marginal on Weibull paper", loc="left", fontsize=9, color=INK)
    legend(axes, loc="lower right")


def _paper(log_cdf: Any) -> FloatArray:
    """Ordinate of Weibull paper, ``log(-log(1 - F))``, from the logarithm of F."""
    out: FloatArray = np.log(-np.log1p(-np.exp(np.minimum(log_cdf, -1e-16))))
    return out


def _draw_graft(axes: Axes, grafted: Any, low: float, high: float) -> None:
    """Draw both parts of a grafted distribution beyond its graft, between logarithms of values."""
    tail = np.array([low - 0.05, high])
    axes.plot(
        tail,
        grafted.shape * (tail - np.log(grafted.scale)),
        color=ORANGE,
        linewidth=1.0,
        linestyle=(0, (4, 2)),
        label=f"Weibull tail, shape {grafted.shape:g}",
        zorder=2,
    )
    core = np.linspace(max(grafted.mean - 6.0 * grafted.deviation, 0.02), np.exp(high), 300)
    axes.plot(
        np.log(core),
        _paper(log_ndtr((core - grafted.mean) / grafted.deviation)),
        color=GREY,
        linewidth=1.6,
        linestyle=(0, (4, 2)),
        label="its Gaussian core",
        zorder=1,
    )
    axes.plot(np.log(grafted.point), _paper(np.log([grafted.probability])), "o", color=ORANGE, markersize=5, zorder=4)
    axes.annotate(
        "graft",
        (np.log(grafted.point), float(_paper(np.log([grafted.probability]))[0])),
        xytext=(-8, 0),
        textcoords="offset points",
        ha="right",
        va="center",
        fontsize=9,
        color=INK,
    )
