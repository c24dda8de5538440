"""One page about a calibration: ``calibration.html``, which needs no other file and no network."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING

from fissura.calibration.picture import plot_calibration
from fissura.files.atomic import write_atomically
from fissura.pictures.attempted import attempted
from fissura.pictures.curves import DPI
from fissura.pictures.lettering import rendered as png_of
from fissura.reports.page import rendered, write_page

if TYPE_CHECKING:
    from fissura.calibration.result import Calibration


def write_report(result: Calibration) -> None:
    """Write ``calibration.png`` and ``calibration.html``."""
    picture = attempted("calibration.png", lambda: png_of(plot_calibration(result), form="png", dpi=DPI))
    if picture is not None:
        write_atomically(result.folder / "calibration.png", picture)
    values = {
        "title": f"{result.name}: calibration",
        "overview": result.table(),
        "warnings": result.warnings,
        "estimates": list(result.estimates.values()),
        "names": [key.rpartition(".")[2] for key in result.estimates],
        "correlation": [[f"{value:+.2f}" for value in row] for row in result.correlation.tolist()],
        "fits": result.fits,
        "picture": None if picture is None else base64.b64encode(picture).decode(),
    }
    page = rendered("calibration.html", values, package="fissura.calibration")
    write_page(page, result.folder / "calibration.html")
