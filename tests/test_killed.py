"""Runs that are killed at random moments, and resumed each time (`benchmarks/kill.py` does that many times)."""

import os
import random
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import fissura
from conftest import small_beam
from sameness import assert_same

CASE = {"discretization__l_f": 0.006, "discretization__l_c": 0.02, "adaptivity__r_f": 0.012, "output__vtk": 2}

CHILD = f"""
import sys
from pathlib import Path
import fissura
from conftest import small_beam
from fissura.running import saving
saving._SHARE = 1.0
folder = Path(sys.argv[1])
resume = (folder / "checkpoint.npz").exists()
case = small_beam(output__checkpoint=0.05, **{CASE!r})
fissura.run(case, output=folder, resume=resume, overwrite=not resume, on_start=lambda _: print("begun", flush=True))
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="no such signal")
def test_a_run_that_is_killed_again_and_again_has_the_same_bits(tmp_path):
    fissura.run(small_beam(output__checkpoint=0.05, **CASE), output=tmp_path / "run")
    moments, kills = random.Random(3), 0
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])}
    while True:
        command = [sys.executable, "-c", CHILD, str(tmp_path / "again")]
        with subprocess.Popen(command, stdout=subprocess.PIPE, env=environment, text=True) as run:
            assert run.stdout.readline() == "begun\n"
            try:
                run.wait(moments.uniform(0.3, 1.2) if kills < 4 else None)
                break
            except subprocess.TimeoutExpired:
                run.send_signal(signal.SIGKILL)
                kills += 1
    assert run.returncode == 0
    assert kills > 1
    assert_same(tmp_path / "again", tmp_path / "run")
