"""``fissura compare``, ``moments`` and ``animate``."""

from __future__ import annotations

import errno
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from typer import Exit

from fissura.cli.console import check_ending, writing
from fissura.errors import InputError

from .fakes import call


def test_compare(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = import_module("fissura.results.compare")  # the package has a function of the same name

    def comparison(plot: Callable[[Path], Any]) -> Any:
        return lambda a, b: SimpleNamespace(table=lambda: [("peak load", "+1 %")], save=plot)

    def full(path: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(module, "compare", comparison(lambda path: path.write_text("x")))
    done = call("compare", tmp_path, "b")
    assert (done.exit_code, done.stdout) == (0, f"peak load  +1 %\npicture: {tmp_path / 'compare.png'}\n")
    assert call("compare", "a", "b", "--plot", tmp_path / "p.png").exit_code == 0
    assert (tmp_path / "p.png").exists()
    monkeypatch.setattr(module, "compare", comparison(full))
    done = call("compare", tmp_path, "b")
    assert done.exit_code == 4
    assert "compare.png: cannot be written: No space left" in done.stderr


def test_compare_without_results(tmp_path: Path) -> None:
    done = call("compare", tmp_path / "a", tmp_path / "b")
    assert done.exit_code == 2
    assert done.stderr.startswith("error: ")


# Pictures of bodies


def test_compare_bodies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compared = SimpleNamespace(table=lambda: [("peak load", "+1 %")], save=lambda path: path.write_text("x"))
    monkeypatch.setattr(import_module("fissura.results.compare"), "compare", lambda a, b: compared)
    drawn: list[Path] = []
    monkeypatch.setattr("fissura.pictures.comparison_files.save_bodies", lambda comparison, path: drawn.append(path))
    assert call("compare", "a", "b", "--bodies", "--plot", tmp_path / "p.pdf").exit_code == 0
    assert drawn == [tmp_path / "p_bodies.pdf"]


@pytest.mark.parametrize("name", ["animate", "moments"])
def test_pictures_without_results(tmp_path: Path, name: str) -> None:
    done = call(name, tmp_path / "nowhere")
    assert done.exit_code == 2
    assert "there is no such folder" in done.stderr


@pytest.mark.parametrize(
    "wrong", [["--fps", "0"], ["--fps", "99"], ["--size", "10"], ["--output", "x.avi"], ["--output", "x"]]
)
def test_animate_refuses(tmp_path: Path, wrong: list[str]) -> None:
    done = call("animate", tmp_path, *wrong)
    assert done.exit_code == 2
    assert wrong[0] in done.stderr


def test_pictures_of_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from results.pictured import LOADS, record

    folder = tmp_path / "run"
    record(folder)
    monkeypatch.setattr("fissura.pictures.moments.DPI", 60)
    done = call("moments", folder)
    assert (done.exit_code, done.stdout) == (0, f"picture: {folder / 'moments.png'}\n")
    done = call("animate", folder, "--size", "320", "--fps", "5")
    assert done.exit_code == 0
    assert done.stdout == f"animation: {folder / 'refinement.gif'}, {len(LOADS) + 1} frames\n"
    assert (folder / "refinement.gif").stat().st_size > 0
    # Wherever one stands.
    monkeypatch.chdir(folder)
    assert call("moments", ".").stdout == "picture: moments.png\n"
    assert call("moments", "..").stderr.startswith(f"error: {tmp_path}: holds no results of a run")
    (folder / "compare.png").write_text("mine")
    done = call("compare", ".", ".")
    assert done.stderr.startswith("error: --plot: compare.png is there, and Fissura did not write it")
    assert (folder / "compare.png").read_text() == "mine"
    for name in ("x.abc", "x"):
        done = call("moments", folder, "--output", folder / name)
        assert done.exit_code == 2
        assert "--output" in done.stderr
    assert not list(folder.glob("x*"))
    done = call("animate", folder, "--output", folder / "no" / "x.gif")
    assert done.exit_code == 4
    (folder / "section.npz").unlink()
    assert "run again" in call("animate", folder).stderr


@pytest.mark.parametrize("name", ["x", "x.xyz", ".png", "x.toml"])
def test_endings_that_are_no_pictures(name: str) -> None:
    with pytest.raises(InputError, match=r"\.png, \.pdf or \.svg") as caught:
        check_ending(Path(name), "--plot")
    assert caught.value.key == "--plot"


@pytest.mark.parametrize("name", ["x.png", "x.PDF", "dir.d/x.svg"])
def test_endings_of_pictures(name: str) -> None:
    check_ending(Path(name), "--plot")


def test_a_fault_while_drawing_is_not_blamed_on_the_name_of_the_picture(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="zero-size"), writing(tmp_path / "x.png"):
        raise ValueError("zero-size array")
    with pytest.raises(Exit) as caught, writing(tmp_path / "x.png"):
        raise OSError(28, "No space left on device")
    assert caught.value.exit_code == 4
