"""One run at a time in a folder."""

import os
import signal
import subprocess
import sys

import pytest

import fissura
from conftest import small_beam
from fissura.errors import InputError
from fissura.files.folder import MARK, prepare_folder
from fissura.files.lock import locked


def test_the_second_is_refused_until_the_first_has_ended(tmp_path):
    with locked(tmp_path):
        with pytest.raises(InputError, match="another run is writing in") as caught, locked(tmp_path):
            pass
        assert caught.value.key == "output"
    with locked(tmp_path):
        pass


def test_without_a_folder_nothing_is_locked():
    with locked(None), locked(None):
        pass


def test_nothing_is_left_where_nothing_was_written(tmp_path):
    with locked(tmp_path):
        assert (tmp_path / MARK).exists()
    assert not list(tmp_path.iterdir())
    with locked(tmp_path):
        (tmp_path / MARK).write_text("fissura run 1\n")
    assert (tmp_path / MARK).exists()


def test_an_empty_mark_of_a_killed_run_is_nothing(tmp_path):
    (tmp_path / MARK).write_text("")
    assert prepare_folder(tmp_path) == tmp_path
    (tmp_path / "mine").write_text("")
    with pytest.raises(InputError, match="is not empty"):
        prepare_folder(tmp_path)


def test_a_run_is_refused_while_another_one_goes_on(tmp_path):
    case = small_beam(control__target=4e-6, output__vtk=0)

    def again(simulation):
        for options in ({"overwrite": True}, {"overwrite": True, "full": True}):
            with pytest.raises(InputError, match="another run is writing in"):
                fissura.run(case, output=tmp_path, **options)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fissura.run(case, output=tmp_path, on_start=again)
    assert not list(tmp_path.iterdir())


HOLD = """
import sys, time
from pathlib import Path
from fissura.files.lock import locked
with locked(Path(sys.argv[1])):
    print("locked", flush=True)
    time.sleep(60)
"""


@pytest.mark.skipif(os.name == "nt", reason="no such signal")
def test_it_vanishes_with_a_process_that_is_killed(tmp_path):
    with subprocess.Popen([sys.executable, "-c", HOLD, tmp_path], stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout.readline() == "locked\n"
        with pytest.raises(InputError, match="another run"), locked(tmp_path):
            pass
        holder.send_signal(signal.SIGKILL)
    with locked(tmp_path):
        pass
