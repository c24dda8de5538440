import os
import shutil
import sys

import numpy as np
import pytest
from PIL import Image

from fissura.errors import InputError
from fissura.files.folder import MARK
from fissura.pictures.animation import animate, chosen
from fissura.pictures.side_view import COARSE, FINE
from fissura.results.history import read_history
from results.pictured import LOADS, record, share


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    record(folder)
    return folder


@pytest.fixture(scope="module")
def gif(folder):
    path = folder / "small.gif"
    assert animate(folder, path, fps=20, width=401) == len(LOADS) + 1
    return path


def test_every_step_is_a_frame(gif):
    with Image.open(gif) as image:
        assert image.n_frames == len(LOADS) + 1
        assert image.info["loop"] == 0
        assert image.width == 400
        assert image.height % 2 == 0
        durations = []
        for k in range(image.n_frames):
            image.seek(k)
            durations.append(image.info["duration"])
    assert durations == [50] * len(LOADS) + [1500]


def test_frames_show_bodies_growing_finer_and_coarser(gif):
    with Image.open(gif) as image:
        fine, coarse = [], []
        for k in range(image.n_frames):
            image.seek(k)
            pixels = np.asarray(image.convert("RGB")) / 255
            fine.append(share(pixels, FINE))
            coarse.append(share(pixels, COARSE))
    swatch = max(fine[0], fine[1], fine[6])  # of the legend
    assert min(fine[2:6]) > 10 * swatch
    assert min(coarse[0], coarse[1], coarse[6]) > 10 * max(coarse[2:6])


def test_long_runs_are_thinned_out(folder):
    frames = read_history(folder)
    assert chosen(frames) == list(range(7))
    assert chosen(frames, 3) == [0, 3, 6]
    assert chosen(frames * 40, 100)[::99] == [0, 279]
    assert animate(folder, folder / "thin.gif", width=320, most=4) == 4
    with Image.open(folder / "thin.gif") as image:
        assert image.n_frames == 4


def test_the_same_twice(folder, gif):
    animate(folder, folder / "again.gif", fps=20, width=401)
    assert (folder / "again.gif").read_bytes() == gif.read_bytes()


@pytest.mark.parametrize("name", ["x.png", "x", "x.gif.zip"])
def test_other_endings_are_refused(folder, name):
    with pytest.raises(InputError, match=r"--output.*\.gif or \.mp4"):
        animate(folder, folder / name)
    assert not (folder / name).exists()


def test_films_need_ffmpeg(folder, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="ffmpeg is not installed"):
        animate(folder, folder / "x.mp4")


def program(folder, body):
    """Put a program ffmpeg into a folder."""
    path = folder / "ffmpeg"
    path.write_text(f"#!{sys.executable}\nimport sys\n{body}\n")
    path.chmod(0o755)


@pytest.mark.skipif(os.name == "nt", reason="the stand-in is a script")
def test_what_ffmpeg_is_given(folder, monkeypatch, tmp_path):
    program(tmp_path, "open(sys.argv[-1], 'w').write(f'{len(sys.stdin.buffer.read())} ' + ' '.join(sys.argv))")
    monkeypatch.setenv("PATH", str(tmp_path))
    animate(folder, folder / "x.mp4", fps=4, width=401)
    count, *arguments = (folder / "x.mp4").read_text().split()
    width, height = map(int, arguments[arguments.index("-s") + 1].split("x"))
    assert width == 400
    assert height % 2 == 0
    assert int(count) == 4 * width * height * (len(LOADS) + 1)  # red, green, blue and opacity
    assert arguments[arguments.index("-framerate") + 1] == "4"
    assert "stop_mode=clone:stop_duration=1.5" in arguments[arguments.index("-vf") + 1]  # the last one is held


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="needs ffmpeg")
def test_a_film(folder):
    animate(folder, folder / "real.mp4", fps=20, width=320)
    film = (folder / "real.mp4").read_bytes()
    assert film[4:8] == b"ftyp"
    assert len(film) > 2000


@pytest.mark.skipif(os.name == "nt", reason="the stand-in is a script")
def test_ffmpeg_may_fail(folder, monkeypatch, tmp_path, caplog):
    program(tmp_path, "sys.stderr.write('first\\nno such codec\\n'); sys.exit(3)")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="ffmpeg failed: no such codec"):
        animate(folder, folder / "y.mp4", width=320)
    assert not caplog.records  # the error says it
    assert not [*folder.glob("y.*"), *(found for found in folder.glob(".*") if found.name != MARK)]


def test_a_folder_that_does_not_exist_is_not_written(folder):
    with pytest.raises(OSError, match="nowhere"):
        animate(folder, folder / "nowhere" / "x.gif", width=320)
