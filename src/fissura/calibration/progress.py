"""Live progress over the runs of a calibration."""

from fissura.calibration.problem import Problem
from fissura.ensemble.progress import OutcomeProgress


class CalibrationProgress(OutcomeProgress):
    """Shows the rounds of a calibration, and the runs as they end."""

    def start(self, problem: Problem, most: int) -> None:
        """Say what is about to be found."""
        self._problem = problem
        names = ", ".join(unknown.key for unknown in problem.unknowns)
        tests = f"{len(problem.tests)} test" + ("s" if len(problem.tests) > 1 else "")
        self.begin(f"{problem.name}: {names} from {tests}, {most} runs at most", most)

    def round(self, number: int, designs: list[dict[str, float]], seeds: int) -> None:
        """Say what is run next."""
        told = "; ".join(
            ", ".join(f"{unknown.name} {unknown.told(point[unknown.key])}" for unknown in self._problem.unknowns)
            for point in designs
        )
        self.say(f"round {number}, {seeds} seeds each: {told}")
