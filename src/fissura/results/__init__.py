"""What a run leaves behind: curve, summary, states, ParaView files; comparison of runs."""

from fissura.results.compare import compare, compare_results
from fissura.results.comparison import Comparison
from fissura.results.curve import read_curve
from fissura.results.result import Result

__all__ = ["Comparison", "Result", "compare", "compare_results", "read_curve"]
