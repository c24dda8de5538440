"""Files that are right, to be mutated: three cases that use most keys, a study, nuclei and measured loads."""

from __future__ import annotations

import io

import numpy as np

from changes import TINY_BEAM

__all__ = ["BAR", "BEAM", "PLATE", "STUDY", "base_files", "npy"]

BEAM = f"""{TINY_BEAM}
output.measured = "measured.csv"
control = {{ target = "0.01 mm", max_step = "0.2 um", stop_load = 0.1 }}
adaptivity = {{ r_f = "8 mm", r_c = "20 mm", gamma = 0.7, coarsen = true, notch_tips = true }}
solver = {{ linear = "direct", threads = 1 }}
"""

BAR = """
name = "bar"
seed = 3
specimen = { shape = "box", size = ["40 mm", "20 mm", "20 mm"] }
supports = [{ type = "clamp", face = "left" }]
load = { face = "right", direction = [1, 0, 0] }
discretization = { l_f = "5 mm", l_c = "10 mm", nuclei = "nuclei.txt" }
control = { type = "dissipation", target = "0.02 mm", stop_load = "20 %" }
output.vtk = 3
field = { length = "30 mm", cov = 0.2, leading = [0.5], energy = { cross_correlation = 0.5, cov = 0.1 } }
[material]
macro = { E = "38 GPa", nu = 0.2 }
f_t = "2.2 MPa"
G_t = "35 J/m^2"
f_s = "7 MPa"
mu = 0.25
elastic = [{ type = "box", lower = [0, 0, 0], upper = ["5 mm", "20 mm", "20 mm"] }]
[adaptivity]
criterion = "rankine"
tolerance = "1 %"
regions = { type = "ball", center = ["20 mm", "10 mm", "10 mm"], radius = "6 mm" }
"""

PLATE = """
seed = 5
specimen = { size = ["60 mm", "30 mm", "15 mm"] }
notch = [
    { face = "bottom", normal = "x", position = "30 mm", depth = "6 mm", width = "3 mm" },
    { face = "top", position = "30 mm", depth = "5 mm" },
]
supports = [
    { type = "roller", face = "bottom", at = "8 mm", width = "6 mm" },
    { type = "pin", face = "bottom", at = "52 mm", along = "x", width = "6 mm" },
    { type = "roller", face = "front", point = ["30 mm", "15 mm", 0] },
    { type = "clamp", face = "left" },
]
load = { face = "top", at = "22 mm", width = "4 mm", direction = [0.1, -1, 0] }
gauge = { a = { face = "bottom", at = "26 mm" }, b = { face = "bottom", at = "34 mm" }, direction = [1, 0, 0] }
discretization = { l_f = "5 mm", l_c = "12 mm" }
adaptivity = { r_f = "10 mm", ahead = 0.9, calibrate = false, gamma_coarse = 0.4, r_w = "10 mm" }
control = { type = "displacement", target = "0.02 mm", switch = false, max_iterations = 20, tolerance = 1e-4 }
solver.linear = "two-level"
[material]
E = "60 GPa"
alpha = 0.3
f_t = "2.2 MPa"
G_t = "35 Nm/m^2"
K_c = "20 GPa"
n_c = 1.5
beta = 1.2
elastic = { type = "ball", center = ["22 mm", "30 mm", "7 mm"], radius = "6 mm" }
[field]
length = ["40 mm", "20 mm", "30 mm"]
correlation = "matern"
nu = 1.5
marginal = "gaussian"
lower = 0.2
variance_error = 0.05
spacing = "12 mm"
"""

STUDY = """
name = "two beams"
seeds = [1, 2]
specimens = [
    { name = "beam", case = "beam.toml", type = "notched", limits.load = "2 %" },
    { name = "deep", case = "beam.toml", seeds = [1], change.notch.depth = "9 mm" },
]
variations = [
    { name = "default" },
    { name = "wide", seeds = [2, 3], specimens = ["beam"], change.adaptivity.r_f = "12 mm" },
]
"""


def base_files() -> dict[str, bytes]:
    """Files that are right, by name."""
    rng = np.random.default_rng(5)
    nuclei = np.stack(np.meshgrid(*(np.arange(0.003, end, 0.007) for end in (0.04, 0.02, 0.02))), -1).reshape(-1, 3)
    nuclei += rng.uniform(-0.0005, 0.0005, nuclei.shape)
    lines = "".join(" ".join(f"{x:.6f}" for x in row) + "\n" for row in nuclei.tolist())
    band = "# cmod_mm,min_N,max_N\n" + "".join(f"{0.001 * k},{50 * k},{60 * k}\n" for k in range(1, 20))
    return {"nuclei.txt": lines.encode(), "measured.csv": band.encode(), "beam.toml": BEAM.encode()}


def npy(text: bytes) -> bytes:
    """The numbers of a text file as NumPy's own format has them."""
    buffer = io.BytesIO()
    np.save(buffer, np.loadtxt(io.BytesIO(text)))
    return buffer.getvalue()
