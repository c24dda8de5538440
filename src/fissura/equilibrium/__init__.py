"""Equilibrium: equations of one discretization, Newton and secant under indirect control."""

from fissura.equilibrium.attach import attach
from fissura.equilibrium.leg import Leg
from fissura.equilibrium.memory import SecantMemory, SolverMemory
from fissura.equilibrium.newton import StepSolver
from fissura.equilibrium.path import Goal, Leading, PathFollower
from fissura.equilibrium.places import check_places
from fissura.equilibrium.reactions import reactions
from fissura.equilibrium.response import Response, dissipation
from fissura.equilibrium.settled import Equilibrium, UnmovedGaugeError, reach_of, settle
from fissura.equilibrium.steps import StepLength
from fissura.equilibrium.system import System

__all__ = [
    "Equilibrium",
    "Goal",
    "Leading",
    "Leg",
    "PathFollower",
    "Response",
    "SecantMemory",
    "SolverMemory",
    "StepLength",
    "StepSolver",
    "System",
    "UnmovedGaugeError",
    "attach",
    "check_places",
    "dissipation",
    "reach_of",
    "reactions",
    "settle",
]
