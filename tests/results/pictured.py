"""Small runs with pictures: a block that is refined and made coarser again, and what one sees of it."""

from __future__ import annotations

import numpy as np

from fissura.running.recorder import Recorder

from .synthetic import random_points, simulation, snapshot, step, voronoi_structure

SIZE = np.array([0.02, 0.01, 0.01])
LOADS = [50.0, 100.0, 200.0, 150.0, 60.0, 20.0]
"""Load [N] of every step; the block is fine in the steps 2 to 5."""


def coarse_and_fine():
    """A coarse and a fine structure of the block."""
    return (
        voronoi_structure(random_points(25, SIZE), SIZE, np.zeros(25, bool)),
        voronoi_structure(random_points(150, SIZE, 2), SIZE, np.ones(150, bool)),
    )


def record(folder, loads=LOADS, *, full=False, status="finished", **control):
    """Result folder of a block torn in two at half its length."""
    coarse, fine = coarse_and_fine()
    run = simulation(control, vtk=0)
    run.full, run.tessellation = full, fine if full else coarse
    recorder = Recorder(run, folder)
    recorder._draw = lambda *_: None  # other pictures, which take longer
    for k, load in enumerate(loads):
        t = fine if full or 0 < k < 5 else coarse
        torn = 2e-6 * k * k
        right = t.x[:, 0] > 0.5 * SIZE[0]
        displacement = np.zeros((len(t), 6))
        displacement[right, 0] = torn + 1e-7
        across = right[t.contacts.bodies[:, 0]] != right[t.contacts.bodies[:, 1]]
        shot = snapshot(t, displacement, np.where(across, torn, 0.0))
        recorder.add(step(k + 1, 1e-5 * (k + 1), load, shot, bodies=len(t), refinements=int(k == 1)))
    return recorder.finish(status)


def share(pixels, colour, near=0.03):
    """Share of pixels (h, w, 3 or more), from 0 to 1, that have a colour."""
    wanted = np.array([int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)])
    return float(np.mean(np.abs(pixels[..., :3] - wanted).max(axis=-1) < near))
