"""What a run leaves behind: curve, summary, ParaView files, pictures, comparison of runs."""

from fissura.results.compare import compare, compare_results
from fissura.results.comparison import Comparison
from fissura.results.curve import read_curve
from fissura.results.recorder import Recorder
from fissura.results.result import Result

__all__ = ["Comparison", "Recorder", "Result", "compare", "compare_results", "read_curve"]
