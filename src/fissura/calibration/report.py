"""One page about a calibration: ``calibration.html``, which needs no other file and no network."""

from __future__ import annotations

import base64
from importlib.resources import files
from typing import TYPE_CHECKING

from fissura.calibration.picture import plot_calibration
from fissura.files.atomic import write_atomically
from fissura.pictures.attempted import attempted
from fissura.pictures.curves import DPI
from fissura.pictures.lettering import rendered
from fissura.results.provenance import versions

if TYPE_CHECKING:
    from fissura.calibration.result import Calibration

__all__ = ["write_report"]


def write_report(result: Calibration) -> None:
    """Write ``calibration.png`` and ``calibration.html``."""
    from jinja2 import Environment

    picture = attempted("calibration.png", lambda: rendered(plot_calibration(result), form="png", dpi=DPI))
    if picture is not None:
        write_atomically(result.folder / "calibration.png", picture)
    template = (files("fissura.calibration") / "templates" / "calibration.html").read_text(encoding="utf-8")
    names = [key.rpartition(".")[2] for key in result.estimates]
    page = (
        Environment(autoescape=True)
        .from_string(template)
        .render(
            name=result.name,
            version=versions()["fissura"],
            overview=result.table(),
            warnings=result.warnings,
            estimates=list(result.estimates.values()),
            names=names,
            correlation=[[f"{value:+.2f}" for value in row] for row in result.correlation.tolist()],
            fits=result.fits,
            picture=None if picture is None else base64.b64encode(picture).decode(),
        )
    )
    write_atomically(result.folder / "calibration.html", page.encode(errors="replace"))
