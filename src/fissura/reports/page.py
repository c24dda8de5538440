"""What pages have in common: templates, style, libraries, data."""

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from fissura.errors import InputError
from fissura.files.atomic import write_atomically
from fissura.reports.libraries import k3d, plotly, require_libraries
from fissura.reports.packed import packed
from fissura.results.provenance import versions

MOST_BYTES = 15_000_000
"""No page is larger."""

SCRIPTS = ("data.js", "curve.js", "view.js", "page.js")


def rendered(
    template: str, values: Mapping[str, Any], data: Mapping[str, Any] | None = None, *, package: str = "fissura.reports"
) -> str:
    """Make a page; whatever users wrote stands there letter by letter.

    Parameters
    ----------
    template : str
        File in the folder ``templates`` of a package.
    values : mapping
        What it names; ``title`` is one of them.
    data : mapping, optional
        What the page's JavaScript draws, ``kind`` among it; None for a page without JavaScript, which needs Jinja only.
    package : str, optional
        Where the template is; it may extend those of this package.

    Raises
    ------
    InputError
        The extra ``report`` is not installed.
    """
    if data is not None:
        require_libraries()
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

    loader = ChoiceLoader([PackageLoader(name) for name in dict.fromkeys([package, "fissura.reports"])])
    environment = Environment(autoescape=True, loader=loader, undefined=StrictUndefined)
    known: dict[str, Any] = {
        "version": versions()["fissura"],
        "style": _own("page.css"),
        "libraries": (),
        "scripts": (),
        "data": "",
    }
    if data is not None:
        libraries = [library for library, wanted in ((plotly(), "curve"), (k3d(), "scene")) if _wants(data, wanted)]
        known |= {"libraries": libraries, "scripts": [_own(name) for name in SCRIPTS], "data": packed(data)}
    return environment.get_template(template).render({**known, **values})


def write_page(page: str, path: Path) -> None:
    """Write a page, as a whole or not at all.

    Raises
    ------
    InputError
        It is larger than `MOST_BYTES`.
    OSError
        It cannot be written.
    """
    data = page.encode(errors="replace")
    if len(data) > MOST_BYTES:
        size, most = (f"{number / 1e6:.1f} MB" for number in (len(data), MOST_BYTES))
        raise InputError(str(path), f"the page would have {size}", f"{most} at most")
    write_atomically(path, data)


def _wants(data: Mapping[str, Any], part: str) -> bool:
    """Whether a page has curves, or a 3D view."""
    return data.get("scene" if part == "scene" else "curve" if data["kind"] == "run" else "lines") is not None


def _own(name: str) -> str:
    return (files("fissura.reports") / "static" / name).read_text(encoding="utf-8")
