"""Live progress over the runs of a study."""

from fissura.batch.progress import ManyProgress
from fissura.progress.live import duration
from fissura.study.definition import LoadedStudy, Task
from fissura.study.record import Record


class StudyProgress(ManyProgress):
    """Shows the runs of a study as they end.

    Seeds follow each other, and each has all specimens and variations: after the first seed, the pace so far is a fair
    guess of what is left.
    """

    def start(self, loaded: LoadedStudy, missing: int, there: int) -> None:
        """Say what is about to run."""
        self.begin(f"{loaded.study.name}: {missing + there} runs", missing, there, "loading kernels")

    def done(self, task: Task, record: Record, left: int) -> None:
        """Show a run that has ended; `left` is how many are left."""
        reason = record.message.strip().splitlines()[-1:] or ["no reason known"]
        self.ended(
            record.status,
            "" if record.status == "finished" else f"{task}: {record.status}: {reason[0]}",
            f"last {task} in {duration(record.summary['wall_s'])}" if record.summary else "",
        )
