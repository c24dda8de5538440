"""Linear algebra of 6x6 blocks: assembly into a fixed pattern, direct and two-level solvers."""

from fissura.linear.protocol import SingularMatrixError

__all__ = ["SingularMatrixError"]
