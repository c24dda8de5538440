"""Files that are there as a whole or not at all."""

from __future__ import annotations

import errno
import json
import os
from pathlib import Path

import pytest

from fissura.files.atomic import part_of, replacing, write_atomically, write_json


def test_a_file_is_replaced_and_nothing_else_is_left(tmp_path: Path) -> None:
    for data in (b"old", b"new"):
        write_atomically(tmp_path / "file", data)
    assert [p.name for p in tmp_path.iterdir()] == ["file"]
    assert (tmp_path / "file").read_bytes() == b"new"


@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
def test_the_old_file_stays_where_writing_fails(tmp_path: Path, error: BaseException) -> None:
    path = tmp_path / "a.png"
    path.write_bytes(b"old")

    def write() -> None:
        with replacing(path) as part:
            part.write_bytes(b"half")
            raise error

    with pytest.raises(type(error)):
        write()
    assert [p.name for p in tmp_path.iterdir()] == ["a.png"]
    assert path.read_bytes() == b"old"


def test_a_file_is_on_the_disk_before_it_takes_its_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[str] = []
    force, move = os.fsync, os.replace

    def forced(number: int) -> None:
        done.append("folder" if os.path.samestat(os.fstat(number), tmp_path.stat()) else "file")
        force(number)

    def moved(source: str, target: str) -> None:
        done.append("move")
        move(source, target)

    monkeypatch.setattr(os, "fsync", forced)
    monkeypatch.setattr(os, "replace", moved)
    write_atomically(tmp_path / "file", b"data")
    assert done == (["file", "move", "folder"] if os.name != "nt" else ["file", "move"])


def test_a_full_disk_is_told_of_the_file_the_user_knows(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="No such file") as caught:
        write_atomically(tmp_path / "none" / "curve.png", b"")
    assert caught.value.filename == str(tmp_path / "none" / "curve.png")


def test_a_file_system_that_cannot_force_is_no_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(number: int) -> None:
        raise OSError(errno.EINVAL, "Invalid argument")

    monkeypatch.setattr(os, "fsync", refuse)
    write_atomically(tmp_path / "file", b"data")
    assert (tmp_path / "file").read_bytes() == b"data"


@pytest.mark.skipif(os.name == "nt", reason="needs links")
def test_links_and_devices_stay_what_they_are(tmp_path: Path) -> None:
    (tmp_path / "target").write_bytes(b"old")
    (tmp_path / "link").symlink_to("target")
    write_atomically(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").read_bytes() == b"new"
    write_atomically(Path(os.devnull), b"gone")
    assert Path(os.devnull).is_char_device()


def test_the_ending_is_kept_while_writing() -> None:
    assert part_of(Path("a/moments.png")) == Path("a/.moments.part.png")
    assert part_of(Path("a/file")) == Path("a/.file.part")


def test_json_is_strict_and_takes_names_that_are_not_utf8(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    write_json(path, {"name": "Brücke"})
    assert "Brücke" in path.read_text(encoding="utf-8")
    write_json(path, {"name": "band\udcff.csv"})
    assert json.loads(path.read_bytes()) == {"name": "band\udcff.csv"}
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_json(path, {"x": float("nan")})
