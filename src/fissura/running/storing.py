"""Writing a result folder as a whole: from results in memory, or from another folder."""

from collections.abc import Callable
from pathlib import Path

from fissura.case import Case
from fissura.errors import InputError
from fissura.files.atomic import write_atomically, write_json
from fissura.files.folder import Folder, copy_files, prepare_folder
from fissura.files.lock import locked
from fissura.material import field_from_case
from fissura.material.field import RandomField
from fissura.pictures.attempted import attempted
from fissura.results.curve_writer import CurveWriter
from fissura.results.history import FILE, HistoryWriter
from fissura.results.result import Result
from fissura.results.state import LAST, state_file, write_state
from fissura.results.summary import result_folder, write_summary
from fissura.running.chosen import ChosenStates
from fissura.simulation.step import Moment
from fissura.specimen import Domain, domain_from_case

Own = Callable[..., Path]
"""Takes names of files that are about to be written, and gives the path of the first one."""

_SUMMARY = "summary.json"


def write_case(case: Case, own: Own) -> None:
    """Write a case: its text, where it was read from a file, and all its values."""
    source = getattr(case, "source", None)
    if isinstance(source, str):
        write_atomically(own("case.toml"), source.encode(errors="replace"))
    write_json(own("case.json"), case.model_dump(mode="json", exclude={"source"}))


def draw_pictures(result: Result, domain: Domain, field: RandomField | None, own: Own) -> None:
    """Draw the curve, the crack and the random field of a run with steps; one that fails is a warning."""
    # Matplotlib takes long to import, and a run starts without it.
    from fissura.pictures.crack import plot_crack
    from fissura.pictures.curves import plot_curve

    attempted("crack.png", lambda: plot_crack(result, own("crack.png")))
    part = result.case.field
    if part is not None and field is not None:
        from fissura.pictures.field import plot_field

        structure, name = result.last.tessellation, result.case.name
        attempted("field.png", lambda: plot_field(field, part, domain, structure, own("field.png"), name))
    attempted("curve.png", lambda: plot_curve(result, own("curve.png")))


def stored(result: Result, path: str | Path, *, overwrite: bool) -> Path:
    """Write a result folder; see `Result.save`."""
    target = Path(path)
    if result.folder is not None and target.exists() and target.samefile(result.folder):
        raise InputError("path", f"{path} is the folder of these results", "another folder")
    target = prepare_folder(target, "run", overwrite=overwrite)
    with locked(target):
        if result.folder is None:
            _written(result, Folder.begun(target, "run"))
        else:
            source = result_folder(result.folder)
            with locked(source if result.status == "running" else None):
                _copied(result, Folder(source), Folder.begun(target, "run"))
    return target


def _written(result: Result, folder: Folder) -> None:
    """Write what is in memory, the summary last, as runs do."""
    own, case, domain = folder.own, result.case, domain_from_case(result.case)
    write_case(case, own)
    CurveWriter(own("curve.csv"), tuple(result.curve), result.curve).close()
    states = ChosenStates(case, folder.path, own)
    for moment in _moments(result):
        states.write(moment)
        write_state(own(LAST if moment.number == result.steps else state_file(moment.number)), moment)
    if result.sections:
        HistoryWriter(float(domain.bounds[:, 2].mean()), result.sections).write(own(FILE))
    if result.snapshots:
        draw_pictures(result, domain, field_from_case(case), own)
    write_summary(own(_SUMMARY), result.summary)


def _copied(result: Result, source: Folder, folder: Folder) -> None:
    """Copy the files of a run, and write states that are in memory only."""
    copy_files(source, folder, last=_SUMMARY)
    for moment in _moments(result):
        if moment.number != result.steps and not (folder.path / state_file(moment.number)).exists():
            write_state(folder.own(state_file(moment.number)), moment)


def _moments(result: Result) -> list[Moment]:
    """The states in memory."""
    curve, values = result.curve, result.controlled
    rows = {int(number): k for k, number in enumerate(curve["step"])}
    return [
        Moment(number, float(curve["gauge_m"][k]), float(curve["load_N"][k]), float(values[k]), snapshot)
        for number, snapshot in result.snapshots.items()
        for k in [rows[number]]
    ]
