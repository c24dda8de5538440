"""What a notebook shows of results and comparisons: key numbers, warnings, and curves as a picture in the page."""

from base64 import b64encode
from collections.abc import Iterable
from html import escape

from matplotlib.figure import Figure

from fissura.pictures.attempted import attempted
from fissura.pictures.curves import comparison_figure, curve_figure
from fissura.pictures.lettering import rendered
from fissura.results.comparison import Comparison
from fissura.results.result import Result

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
    name = f"curve of {result.case.name}"
    picture = attempted("the curve", lambda: embedded(curve_figure(result), name)) if result.steps else None
    return notebook_html(rows, map(str, result.summary.get("warnings") or ()), picture)


def comparison_html(comparison: Comparison) -> str:
    """HTML of a comparison, likewise."""
    name = f"{comparison.a.case.name} against {comparison.b.case.name}"
    picture = attempted("the curves", lambda: embedded(comparison_figure(comparison), name))
    return notebook_html(comparison.table(), map(str, comparison.notices), picture)


def notebook_html(rows: Iterable[tuple[str, str]], notices: Iterable[str], picture: str | None) -> str:
    """A table, a picture beside it, and warnings below.

    Parameters
    ----------
    rows : iterable of (str, str)
        Name and value.
    notices : iterable of str
        The warnings.
    picture : str or None
        HTML of the picture, from `embedded`.
    """
    cells = "".join(
        f'<tr><th style="text-align:left">{escape(name)}</th><td style="text-align:left">{escape(value)}</td></tr>'
        for name, value in rows
    )
    told = "".join(f"<li>{escape(notice)}</li>" for notice in notices)
    return (
        '<div style="display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start">'
        f"<table>{cells}</table>{picture or ''}</div>" + (f"<p><b>Warnings</b></p><ul>{told}</ul>" if told else "")
    )


def embedded(figure: Figure, name: str) -> str:
    """HTML of a figure inside the page, with what it shows in words."""
    data = b64encode(rendered(figure, form="png", dpi=RESOLUTION)).decode()
    alt = escape(name, quote=True)
    return f'<img alt="{alt}" src="data:image/png;base64,{data}" style="max-width:min(100%,32em)">'
