"""Folders of results: what may be replaced, and that nothing else is ever removed."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fissura.errors import InputError
from fissura.files.folder import MARK, Folder, FolderKind, claimed, copied, kind_of, prepare_folder

KINDS: tuple[FolderKind, ...] = ("run", "ensemble", "study", "elastic", "calibration")


def everything(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file() or path.is_symlink()}


def put(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("text")


@pytest.mark.parametrize("kind", KINDS)
def test_a_folder_of_a_stranger_is_refused_and_left_as_it_is(tmp_path: Path, kind: FolderKind) -> None:
    names = {"runs/photo.jpg", "pictures/holiday.png", "companions/a/b.txt", "summary.json", "curve.csv"}
    put(tmp_path, *names)
    for options in ({}, {"overwrite": True}, {"go_on": True}):
        with pytest.raises(InputError, match="files that Fissura did not write"):
            prepare_folder(tmp_path, kind, **options)
    assert everything(tmp_path) == names
    assert kind_of(tmp_path) is None


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("other", KINDS)
def test_results_are_replaced_by_results_of_their_kind_only(
    tmp_path: Path, kind: FolderKind, other: FolderKind
) -> None:
    Folder.begun(tmp_path, kind).add("a.txt")
    put(tmp_path, "a.txt")
    with pytest.raises(InputError, match="is not empty"):
        prepare_folder(tmp_path, other)
    if kind == other:
        assert (
            prepare_folder(tmp_path, other, overwrite=True) == prepare_folder(tmp_path, other, go_on=True) == tmp_path
        )
    else:
        with pytest.raises(InputError, match="which are not replaced"):
            prepare_folder(tmp_path, other, overwrite=True)
    assert (tmp_path / "a.txt").exists()


def test_new_and_empty_folders_may_be_of_anything(tmp_path: Path) -> None:
    assert prepare_folder(tmp_path, "study") == tmp_path
    assert prepare_folder(tmp_path / "a" / "b", "run").is_dir()


def test_what_is_listed_is_removed_and_nothing_else(tmp_path: Path) -> None:
    folder = Folder.begun(tmp_path, "ensemble")
    folder.add("report.html", "pictures/curves.png", "runs/0001/", "runs/0002/", "gone.csv")
    inner = tmp_path / "runs" / "0001"
    put(tmp_path, "report.html", "pictures/curves.png", "pictures/holiday.png", "bodies_9999.vtu", ".report.part.html")
    put(inner, "curve.csv", "notes.txt")
    Folder.begun(inner, "run").add("curve.csv")
    put(tmp_path, "runs/0002/photo.jpg")  # not ours, though its folder is listed
    Folder.begun(tmp_path, "ensemble")
    assert everything(tmp_path) == {
        MARK,
        "pictures/holiday.png",
        "bodies_9999.vtu",
        "runs/0001/notes.txt",
        "runs/0002/photo.jpg",
    }
    assert list(Folder(tmp_path).names()) == []


def test_folders_that_are_empty_then_go_too(tmp_path: Path) -> None:
    Folder.begun(tmp_path, "study").add("runs/beam/seed0001/full.npz", "runs/beam/seed0002/full.npz")
    put(tmp_path, "runs/beam/seed0001/full.npz", "runs/beam/seed0002/full.npz", "runs/beam/seed0002/mine")
    Folder(tmp_path).clear()
    assert everything(tmp_path) == {MARK, "runs/beam/seed0002/mine"}
    assert not (tmp_path / "runs/beam/seed0001").exists()


@pytest.mark.skipif(os.name == "nt", reason="needs links")
def test_nothing_outside_of_the_folder_is_removed(tmp_path: Path) -> None:
    outside, inside = tmp_path / "outside", tmp_path / "inside"
    put(outside, "a.txt", "0001/curve.csv")
    inside.mkdir()
    Folder.begun(outside / "0001", "run").add("curve.csv")
    Folder.begun(inside, "ensemble").add(
        "../outside/a.txt", str(outside / "a.txt"), "runs/a.txt", "runs/0001/", "link.txt", "linked/"
    )
    (inside / "runs").symlink_to(outside)
    (inside / "linked").symlink_to(outside / "0001")
    (inside / "link.txt").symlink_to(outside / "a.txt")
    Folder.begun(inside, "ensemble")
    assert everything(outside) == {"a.txt", "0001/curve.csv", f"0001/{MARK}"}
    assert {path.name for path in inside.iterdir()} == {MARK, "runs", "linked"}


def test_names_are_listed_once_and_a_line_cut_off_does_not_count(tmp_path: Path) -> None:
    folder = Folder.begun(tmp_path, "run")
    folder.add("a", "b", "a")
    folder.add("b", "c")
    Folder(tmp_path).add("a")
    assert list(folder.names()) == ["a", "b", "c"]
    with (tmp_path / MARK).open("a") as mark:
        mark.write("half of a na")
    assert list(Folder(tmp_path).names()) == ["a", "b", "c"]
    assert kind_of(tmp_path) == "run"


@pytest.mark.parametrize("text", ["", "fissura", "fissura cake 1\n", "other run 1\na\n", "\0\0\0", "fissura run 1"])
def test_a_mark_that_is_none(tmp_path: Path, text: str) -> None:
    (tmp_path / MARK).write_text(text)
    assert kind_of(tmp_path) is None


def test_a_picture_replaces_only_a_picture_of_ours(tmp_path: Path) -> None:
    Folder.begun(tmp_path, "run").add("curve.csv")
    picture = tmp_path / "moments.png"
    claimed(picture, "--output")
    picture.write_text("ours")
    claimed(picture, "--output")
    assert list(Folder(tmp_path).names()) == ["curve.csv", "moments.png"]
    put(tmp_path, "compare.png")
    with pytest.raises(InputError, match=r"--plot: .*compare\.png is there, and Fissura did not write it"):
        claimed(tmp_path / "compare.png", "--plot")


@pytest.mark.parametrize("kind", ["ensemble", "calibration"])
def test_a_copy_onto_itself_is_refused_and_nothing_is_lost(tmp_path: Path, kind: FolderKind) -> None:
    Folder.begun(tmp_path, kind).add("a.csv", "sub/")
    (tmp_path / "a.csv").write_text("1")
    (tmp_path / "sub").mkdir()
    (tmp_path / "foreign.txt").write_text("of somebody else")
    with pytest.raises(InputError, match=f"is the folder of the {kind} itself"):
        copied(tmp_path, tmp_path, kind, overwrite=True)
    assert (tmp_path / "a.csv").read_text() == "1"
    other = copied(tmp_path, tmp_path.parent / f"{kind}-copy", kind)
    assert sorted(path.name for path in other.iterdir()) == [MARK, "a.csv", "sub"]
