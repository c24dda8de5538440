"""Products of 6x6 blocks inside kernels: in vector instructions, or plainly where FISSURA_SIMD is 0."""

from __future__ import annotations

import os

if os.environ.get("FISSURA_SIMD") == "0":
    from fissura.linear.plain import prefetch, prefetch_item, times, transposed_times
else:
    from fissura.linear.simd import prefetch, prefetch_item, times, transposed_times

__all__ = ["prefetch", "prefetch_item", "times", "transposed_times"]
