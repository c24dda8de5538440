"""Arguments and options that several commands take."""

from pathlib import Path
from typing import Annotated

import typer

CaseArgument = Annotated[
    Path, typer.Argument(metavar="CASE", help="Case file (TOML), or case.json of a run.", show_default=False)
]
FullOption = Annotated[bool, typer.Option("--full", help="Full resolution everywhere, no adaptivity.")]
OverwriteOption = Annotated[bool, typer.Option("--overwrite", help="Replace earlier results there.")]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Write one JSON object to standard output and nothing else; errors, too.")
]
QuietOption = Annotated[bool, typer.Option("--quiet", help="Print errors and warnings only.")]
ResumeOption = Annotated[bool, typer.Option("--resume", help="Go on with what is in the folder.")]
SchedulerOption = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Use the workers of this Dask scheduler instead.")
]
WorkersOption = Annotated[
    int | None, typer.Option(min=1, help="Processes on this machine.", show_default="one per processor")
]
