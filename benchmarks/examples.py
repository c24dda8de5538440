"""Gallery of all examples: runs those that are named (default: all), one after another, and writes docs/examples.md.

What a run has found is kept in docs/examples.json, its picture in docs/images/examples, so that long runs need not be
done again: `--page` only writes the page. What an example shows is the comment at the top of its file.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
from datetime import date
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from PIL import Image

from common import ROOT, machine, say, write_section
from fissura.pictures.moments import plot_moments
from fissura.text import quantities
from small_pictures import save_small, scaled

EXAMPLES = ROOT / "examples"
PAGE = ROOT / "docs" / "examples.md"
FOUND = ROOT / "docs" / "examples.json"
PICTURES = ROOT / "docs" / "images" / "examples"
WIDTH = 1000

#: One thread each, so that times can be compared.
ALONE = {"FISSURA_THREADS": "1", "MKL_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}

#: Groups of the page and their examples, in the order of the page.
GROUPS = {
    "Beams with a notch": [
        "beam_d100",
        "beam_d200",
        "beam_d400",
        "beam_350",
        "gregoire_d50_halfnotch",
        "beam_d100_cycles",
        "four_point_bending",
        "long_beam_weight",
    ],
    "Shear and mixed mode": ["garcia_alvarez_mixed_mode", "four_point_shear", "nooru_mohamed"],
    "No notch": ["unnotched_beam", "gregoire_d50_unnotched", "tension_bar", "winkler_lpanel"],
    "Tension and splitting with a notch": ["wedge_splitting", "notched_bar", "tension_fixed", "tension_hinged"],
    "Compression": ["compression_frictionless", "compression_glued"],
    "Random material": ["random_unnotched", "random_notched"],
}


def about(name: str) -> str:
    """What an example shows: the comment at the top of its file, in one line."""
    lines = []
    for line in (EXAMPLES / f"{name}.toml").read_text(encoding="utf-8").splitlines():
        if not line.startswith("# "):
            break
        lines.append(line[2:].strip())
    return re.sub(r"fissura [a-z]+ .*", lambda found: f"`{found[0]}`", " ".join(lines))


def worked(name: str) -> dict[str, Any]:
    """Run an example; what the page says of it."""
    with TemporaryDirectory() as folder:
        out = Path(folder) / name
        command = [sys.executable, "-m", "fissura", "run", f"examples/{name}.toml", "--output", str(out), "--quiet"]
        done = subprocess.run(command, cwd=ROOT, env={**os.environ, **ALONE}, stderr=subprocess.PIPE, encoding="utf-8")
        if not (out / "summary.json").is_file():
            raise SystemExit(f"{name}: {done.stderr}")
        found = json.loads((out / "summary.json").read_text(encoding="utf-8"))
        plot_moments(out, out / "moments.png")
        PICTURES.mkdir(exist_ok=True)
        with Image.open(out / "moments.png") as picture:
            save_small(scaled(picture, WIDTH), PICTURES / f"{name}.png")
    where = machine()
    return {
        "status": found["status"],
        "peak_N": found["peak_load_N"],
        "bodies": [found["bodies_start"], found["bodies_end"], found["bodies_full"]],
        "steps": found["steps"],
        "cpu_s": round(found["cpu_s"], 1),
        "memory_MB": round(found["peak_memory_MB"]),
        "date": date.today().isoformat(),
        "machine": f"{where['processor']}, {where['platform']}, Python {where['python']}, {where['solver']}",
    }


def entry(name: str, found: dict[str, Any]) -> str:
    """An example on the page."""
    start, end, full = found["bodies"]
    seconds = found["cpu_s"]
    time = f"{seconds:.0f} s" if seconds >= 10 else f"{seconds:.1f} s"
    numbers = f"Peak load {quantities.force(found['peak_N'])}; {start} bodies at the start, {end} at the end ({full} at"
    return f"""### {name}

{about(name)}

```bash
fissura run examples/{name}.toml
```

{numbers} full resolution); {found["steps"]} steps; {time} of processor time, {found["memory_MB"]} MB; status
`{found["status"]}`.

![Bodies, cracks and curve of {name}](images/examples/{name}.png)
"""


def page(found: dict[str, dict[str, Any]]) -> str:
    """The generated part of the page."""
    machines = sorted({(one["machine"], one["date"]) for one in found.values()})
    text = [
        "Made by `python benchmarks/examples.py` (`python benchmarks/examples.py NAME` renews one of them). Times are"
        " processor times of one thread, without compiling, measured while other programs ran on "
        + "; ".join(f"{name} ({day})" for name, day in machines)
        + ". Pictures are those of `fissura moments`.\n"
    ]
    for title, names in GROUPS.items():
        text += [f"## {title}\n", *(entry(name, found[name]) for name in names if name in found)]
    return "\n".join(text)


def main() -> int:
    """Run examples, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    names = [name for group in GROUPS.values() for name in group]
    parser.add_argument("names", nargs="*", metavar="NAME", help="examples to run; all without a name")
    parser.add_argument("--page", action="store_true", help="run nothing")
    given = parser.parse_args()
    if unknown := set(given.names) - set(names):
        parser.error(f"no example: {', '.join(sorted(unknown))}")
    found = json.loads(FOUND.read_text(encoding="utf-8")) if FOUND.exists() else {}
    for name in [] if given.page else given.names or names:
        found[name] = worked(name)
        say(f"{name}: {found[name]}")
        FOUND.write_text(json.dumps({key: found[key] for key in names if key in found}, indent=1) + "\n", "utf-8")
    write_section(PAGE, "examples", page(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
