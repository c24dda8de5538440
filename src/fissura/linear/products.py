"""6x6 blocks times vectors of six numbers inside kernels: in vector instructions, else plainly.

Vector instructions need llvmlite as it is written for, with pointers that have types; FISSURA_SIMD=0 does without them.
Results then differ by round-off.
"""

import os
from typing import Any

from llvmlite import ir

from fissura.linear import plain, simd

_used: Any = simd if os.environ.get("FISSURA_SIMD") != "0" and hasattr(ir.Type, "as_pointer") else plain
prefetch, prefetch_item = _used.prefetch, _used.prefetch_item
times, transposed_times = _used.times, _used.transposed_times
