"""The JavaScript libraries that a page brings along, with their licences; the extra ``report`` installs them."""

from dataclasses import dataclass
from functools import cache
from importlib import import_module, metadata
from importlib.resources import files
from importlib.util import find_spec

from fissura.errors import InputError
from fissura.reports.packed import compressed

PACKAGES = ("jinja2", "plotly", "k3d", "pyvista")
"""What the extra ``report`` installs, by the names of modules."""


@dataclass(frozen=True)
class Library:
    """A JavaScript library.

    Attributes
    ----------
    name, version, task : str
        What it is called, the version of its Python package, and what a page has it for.
    code : str
        Its source, by `compressed`.
    licence : str
        The licence, and notices of what it is built of.
    """

    name: str
    version: str
    task: str
    code: str
    licence: str


def have_libraries() -> bool:
    """Whether the extra ``report`` is installed."""
    return not _missing()


def require_libraries() -> None:
    """Make sure that a page can be made.

    Raises
    ------
    InputError
        The extra ``report`` is not installed.
    """
    missing = _missing()
    if missing:
        several = "are not installed; reports need them" if len(missing) > 1 else "is not installed; reports need it"
        raise InputError(", ".join(missing), several, 'pip install "fissura[report]"')


@cache
def plotly() -> Library:
    """Plotly.js, which draws curves."""
    code: str = import_module("plotly.offline").get_plotlyjs()
    head = code[: code.find("*/") + 2]
    licence = f"{head}\n\n{_licence('plotly')}"
    return Library("Plotly", metadata.version("plotly"), "curves", compressed(code.encode()), licence)


@cache
def k3d() -> Library:
    """K3D, which draws in three dimensions with three.js."""
    folder = files("k3d") / "static"
    code = (folder / "standalone.js").read_text(encoding="utf-8")
    parts = (folder / "standalone.js.LICENSE.txt").read_text(encoding="utf-8")
    licence = f"{_licence('k3d')}\n\nIt is built of:\n\n{parts}"
    return Library("K3D-jupyter", metadata.version("k3d"), "3D view", compressed(code.encode()), licence)


def _missing() -> list[str]:
    return [name for name in PACKAGES if find_spec(name) is None]


def _licence(package: str) -> str:
    """Text of the licence that came with a package."""
    found = [path for path in metadata.files(package) or () if path.name.upper().startswith("LICENSE")]
    inside = [path for path in found if ".dist-info" in str(path)]
    return inside[0].read_text(encoding="utf-8").strip() if inside else str(metadata.metadata(package)["License"])
