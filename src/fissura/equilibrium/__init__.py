"""Equilibrium: assembly, linear solvers, Newton and secant under indirect control."""

from __future__ import annotations

from fissura.equilibrium.attach import attach
from fissura.equilibrium.constraint import Constraint, dissipating, prescribed
from fissura.equilibrium.direct import SOLVERS, best_solver
from fissura.equilibrium.leg import Leg
from fissura.equilibrium.linear import SingularMatrixError, UnmovedGaugeError
from fissura.equilibrium.memory import SecantMemory, SolverMemory
from fissura.equilibrium.newton import Equilibrium, Norms, StepSolver, reach_of, settle
from fissura.equilibrium.path import Goal, Leading, PathFollower
from fissura.equilibrium.places import check_places
from fissura.equilibrium.steps import StepLength
from fissura.equilibrium.system import Response, System
from fissura.equilibrium.team import Team

__all__ = [
    "SOLVERS",
    "Constraint",
    "Equilibrium",
    "Goal",
    "Leading",
    "Leg",
    "Norms",
    "PathFollower",
    "Response",
    "SecantMemory",
    "SingularMatrixError",
    "SolverMemory",
    "StepLength",
    "StepSolver",
    "System",
    "Team",
    "UnmovedGaugeError",
    "attach",
    "best_solver",
    "check_places",
    "dissipating",
    "prescribed",
    "reach_of",
    "settle",
]
