"""Mutated input files, many of them: none may end in a traceback, take long, or be refused without naming a key.

The mutations are those of the tests (`tests/mutation`): of cases as TOML and JSON, of studies, nuclei and measured
loads, by values, by keys and by bytes. `python benchmarks/bad_input.py` makes 20 000 of them and shows what is wrong;
the status is 1 if anything is.
"""

from __future__ import annotations

import argparse
import logging
import sys
import tempfile
import time
from pathlib import Path

from common import ROOT, say

sys.path.insert(0, str(ROOT / "tests"))

from mutation.trial import Tally, trials

#: Trials between two lines about how far it is.
CHUNK = 1000


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=20_000, help="how many (default: %(default)s)")
    parser.add_argument("--first", type=int, default=0, help="number of the first one (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="decides all of them (default: %(default)s)")
    parser.add_argument("--faults", type=int, default=10, help="how many faults to show (default: %(default)s)")
    given = parser.parse_args()
    logging.getLogger("fissura").setLevel(logging.ERROR)
    tally, began = Tally(), time.process_time()
    end = given.first + given.trials
    for start in range(given.first, end, CHUNK):
        with tempfile.TemporaryDirectory() as folder:
            found = trials(given.seed, range(start, min(start + CHUNK, end)), Path(folder))
        tally.ends += found.ends
        tally.faults += found.faults
        say(f"{min(start + CHUNK, end) - given.first} trials, {len(tally.faults)} faults")
    for fault in tally.faults[: given.faults]:
        print(f"\n{fault}")
    print(f"\n{sum(tally.ends.values())} trials in {time.process_time() - began:.0f} s: ", end="")
    print(", ".join(f"{count} {name}" for name, count in tally.ends.most_common()) + f"; {len(tally.faults)} faults")
    return 1 if tally.faults else 0


if __name__ == "__main__":
    sys.exit(main())
