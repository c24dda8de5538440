"""Going on with a run from its checkpoint."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fissura.case import case_from_dict
from fissura.results.curve import COLUMN_OF, peak_position
from fissura.results.done import Done
from fissura.results.provenance import versions
from fissura.running.checkpoint import Checkpoint
from fissura.simulation.entering import extended
from fissura.simulation.saved import restored
from fissura.simulation.step import Moment, Snapshot

if TYPE_CHECKING:
    from fissura.simulation.loop import Simulation

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Begun:
    """What there is of a run that goes on.

    Attributes
    ----------
    checkpoint : Checkpoint
        From which it does.
    last, peak : Moment
        The last step, and that of the largest load.
    share : float
        Share of the run that is done; less than it was when its end was moved.
    """

    checkpoint: Checkpoint
    last: Moment
    peak: Moment
    share: float


def begun(simulation: Simulation, checkpoint: Checkpoint) -> Begun:
    """Bring a simulation that has not begun to where a checkpoint was written.

    Raises
    ------
    InputError
        The specimen is another one than then.
    """
    used, now = checkpoint.versions, versions()
    other = [f"{name} {used.get(name)}, now {now[name]}" for name in now if used.get(name) != now[name]]
    if other:
        _log.warning("the run so far was computed with %s: what follows may differ in the last bits", ", ".join(other))
    model = simulation.model
    shots: dict[int, Snapshot] = {}
    both = () if checkpoint.peak is checkpoint.state else (checkpoint.peak,)
    for found in (*both, checkpoint.state):  # the simulation goes on from the last one
        state = restored(found, model)
        shots[state.number] = model.snapshot(state)
        simulation.state = extended(model, state)
    curve = checkpoint.curve
    controlled = curve[COLUMN_OF[simulation.case.quantity]]

    def moment(k: int) -> Moment:
        gauge, load = float(curve["gauge_m"][k]), float(curve["load_N"][k])
        return Moment(k + 1, gauge, load, float(controlled[k]), shots[k + 1])

    last, peak = moment(checkpoint.steps - 1), moment(peak_position(curve["load_N"]))
    done = Done(simulation.case)
    earlier = case_from_dict(dict(checkpoint.case), files_exist=False)
    if simulation.case.stages == earlier.stages:
        return Begun(checkpoint, last, peak, checkpoint.share)
    done.peak = abs(peak.load)
    return Begun(checkpoint, last, peak, done.after(model.done(extended(model, state)), last.load))
