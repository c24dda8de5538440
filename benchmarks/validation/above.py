"""Lets the scripts of this folder import what those of the folder above share."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1]))
