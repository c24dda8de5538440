"""What a notebook shows of a result: key numbers, warnings, and the curve as a picture in the page."""

from __future__ import annotations

from base64 import b64encode
from html import escape
from typing import TYPE_CHECKING

from fissura.results.lettering import attempted, rendered
from fissura.results.pictures import curve_figure

if TYPE_CHECKING:
    from fissura.results.result import Result

__all__ = ["result_html"]

RESOLUTION = 90
"""Points per inch of the picture."""


def result_html(result: Result) -> str:
    """HTML of a result; whatever users wrote stands there letter by letter.

    Parameters
    ----------
    result : Result
        Any, also one without steps, which has no picture.
    """
    rows = [*result.table(), *([("results", str(result.folder))] if result.folder else [])]
    cells = "".join(
        f'<tr><th style="text-align:left">{escape(name)}</th><td style="text-align:left">{escape(value)}</td></tr>'
        for name, value in rows
    )
    notices = "".join(f"<li>{escape(str(text))}</li>" for text in result.summary.get("warnings") or ())
    picture = attempted("the curve", lambda: _picture(result)) if result.steps else None
    return (
        '<div style="display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start">'
        f"<table>{cells}</table>{picture or ''}</div>"
        + (f"<p><b>Warnings</b></p><ul>{notices}</ul>" if notices else "")
    )


def _picture(result: Result) -> str:
    data = b64encode(rendered(curve_figure(result), form="png", dpi=RESOLUTION)).decode()
    name = escape(f"curve of {result.case.name}", quote=True)
    return f'<img alt="{name}" src="data:image/png;base64,{data}" style="max-width:min(100%,32em)">'
