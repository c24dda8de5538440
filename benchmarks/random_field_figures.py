"""Pictures of docs/random-field.md: a realisation, covariance models side by side, marginal distributions."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from common import ROOT, changed, example, say
from fissura.case import Field
from fissura.material import field_from_case
from fissura.material.field import marginal_named
from fissura.pictures.curves import BLUE, INK, ORANGE, tidy
from fissura.pictures.field import draw_marginal, draw_slice, plot_field
from fissura.simulation.loop import Simulation
from fissura.specimen import domain_from_case

FOLDER = ROOT / "docs" / "images"
#: Fields shown side by side, all with one seed: title and values.
MODELS = [
    ("squared exponential, 30 mm", {"length": "30 mm"}),
    ("Matérn, ν = 2.5, 30 mm", {"length": "30 mm", "correlation": "matern", "nu": 2.5}),
    ("Matérn, ν = 1.5, 30 mm", {"length": "30 mm", "correlation": "matern", "nu": 1.5}),
    ("exponential, 30 mm", {"length": "30 mm", "correlation": "exponential", "variance_error": 0.08}),
    ("squared exponential, 90 × 15 × 15 mm", {"length": ["90 mm", "15 mm", "15 mm"]}),
    ("squared exponential, 10 mm", {"length": "10 mm"}),
]
COLOURS = {"grafted": BLUE, "gaussian": "#8a8f98", "lognormal": "#3a8f4d", "weibull": ORANGE}


def realisation(path: Path) -> None:
    """The picture of a run, all bodies fine."""
    case = changed(example("beam_d100", 1), field=Field.model_validate({"length": "50 mm", "seed": 1}))
    simulation = Simulation(case, full=True)
    assert simulation.field is not None
    assert case.field is not None
    name = "a realisation in examples/beam_d100.toml"
    plot_field(simulation.field, case.field, simulation.domain, simulation.tessellation, path, name)


def models(path: Path) -> None:
    """Slices of fields with different correlations."""
    figure = Figure(figsize=(11.0, 6.2), layout="constrained")
    norm = Normalize(0.25, 1.75)
    for axes, (title, values) in zip(figure.subplots(3, 2).ravel(), MODELS, strict=True):
        case = changed(example("beam_d100", 1), field=Field.model_validate({"seed": 2, **values}))
        field = field_from_case(case)
        assert field is not None
        draw_slice(axes, field, domain_from_case(case), (0, 1), norm)
        axes.set_title(title, loc="left", fontsize=9, color=INK)
    figure.savefig(path, dpi=130)


def marginals(path: Path) -> None:
    """Densities, and the grafted distribution against Gaussian, lognormal and Weibull on probability paper."""
    figure = Figure(figsize=(11.0, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    h = np.linspace(0.05, 2.2, 600)
    z = np.linspace(-4.9, 3.6, 400)
    draw_marginal(right, marginal_named("grafted", 0.25), "grafted")
    for name, colour in COLOURS.items():
        marginal = marginal_named(name, 0.25)
        left.plot(h, marginal.pdf(h), color=colour, label=name + (", truncated at 0.1" if name == "gaussian" else ""))
        if name != "grafted":
            values = marginal.from_gaussian(z)
            log_cdf = np.minimum(marginal.log_cdf(values), -1e-16)
            right.plot(np.log(values), np.log(-np.log1p(-np.exp(log_cdf))), color=colour, linewidth=1.0, zorder=2)
    tidy(left)
    left.set_xlabel("relative strength H")
    left.set_ylabel("density")
    left.set_title("marginal distributions, mean 1, CoV 0.25", loc="left", fontsize=9, color=INK)
    left.legend(fontsize=9, labelcolor=INK, edgecolor="none")
    figure.savefig(path, dpi=130)


def main() -> int:
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    FOLDER.mkdir(parents=True, exist_ok=True)
    for draw in (realisation, models, marginals):
        path = FOLDER / f"field_{draw.__name__}.png"
        draw(path)
        say(f"written: {path}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
