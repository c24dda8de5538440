"""The command ``fissura elastic``."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from fissura.cli.console import errors, not_written, print_columns, print_table, warnings
from fissura.cli.options import OverwriteOption
from fissura.errors import InputError

ALPHA = "0.05,0.1,0.2,0.29,0.4,0.5,0.7,1"


#: Options that say what to compute, and where to write it.
STUDY = {
    "alpha": "--alpha",
    "sizes": "--sizes",
    "seeds": "--seeds",
    "aspect": "--aspect",
    "modulus": "--E",
    "output": "--output",
    "overwrite": "--overwrite",
}


def elastic(
    context: typer.Context,
    case: Annotated[
        Path | None, typer.Argument(metavar="[CASE]", help="Print the constants of this case.", show_default=False)
    ] = None,
    alpha: Annotated[str, typer.Option(help="Tangential over normal stiffness of contacts.")] = ALPHA,
    sizes: Annotated[str, typer.Option(help="Sides of cells and widths of prisms, in l_min.")] = "4,6,8,12",
    seeds: Annotated[int, typer.Option(min=1, max=1000, help="Number of structures of each kind and size.")] = 5,
    aspect: Annotated[float, typer.Option(min=1.0, max=10.0, help="Length over width of prisms; 1: cubes.")] = 2.0,
    modulus: Annotated[
        str | None, typer.Option("--E", metavar="STRESS", help='Modulus of contacts, "60 GPa"; else all are relative.')
    ] = None,
    inverse: Annotated[
        tuple[str, str] | None,
        typer.Option(metavar="E=38GPa nu=0.18", help="Print the contact constants that give these of the material."),
    ] = None,
    tension: Annotated[
        tuple[str, str, str] | None,
        typer.Option(
            metavar="f=3MPa G_F=100J/m^2 l_f=10mm",
            help="With --inverse: contacts for this tensile strength and fracture energy, too.",
        ),
    ] = None,
    output: Annotated[Path, typer.Option(help="Folder for table and pictures.")] = Path("results/elastic"),
    overwrite: OverwriteOption = False,
) -> None:
    """Elastic constants of the material as a whole: computed from structures, of a case, or the inverse."""
    with errors():
        from fissura.elasticity import answers, asked, limits

        if case is not None or inverse is not None:
            _check_nothing_to_compute(context, "a case" if inverse is None else "--inverse")
        if inverse is not None:
            if case is not None:
                raise InputError("--inverse", "is given together with a case", "one of both")
            pull = None if tension is None else asked.parse_tension(tension)
            print_table(answers.inverse_rows(*asked.parse_inverse(inverse), pull))
        elif tension is not None:
            raise InputError("--tension", "needs the elastic constants, too", "--inverse E=38GPa nu=0.18 --tension ...")
        elif case is not None:
            from fissura.case import load_case

            print_table(answers.case_rows(load_case(case)))
        else:
            E = None if modulus is None else asked.parse_modulus(modulus, "--E")
            wanted = asked.parse_numbers(alpha, "--alpha", 0.001, 1.0)
            widths = asked.parse_numbers(sizes, "--sizes", limits.SMALLEST, limits.LARGEST)
            _study(wanted, widths, seeds, aspect, E, output, overwrite)


def _check_nothing_to_compute(context: typer.Context, given: str) -> None:
    """Refuse options of what is computed where nothing is."""
    for name, option in STUDY.items():
        source = context.get_parameter_source(name)
        if source is not None and source.name != "DEFAULT":
            raise InputError(option, f"has no effect together with {given}, for which nothing is computed", "either")


def _study(
    alphas: Sequence[float],
    sizes: Sequence[float],
    seeds: int,
    aspect: float,
    E: float | None,
    output: Path,
    overwrite: bool,
) -> None:
    """Compute, print and write a study of elastic constants."""
    from rich.progress import Progress

    from fissura.elasticity import answers
    from fissura.elasticity.study import structure_seeds, study
    from fissura.files.folder import prepare_folder

    folder = prepare_folder(output, "elastic", overwrite=overwrite)
    console = Console(stderr=True)
    with warnings(console), Progress(console=console, transient=True) as bar:
        task = bar.add_task("structures", total=None)
        found = study(
            alphas,
            sizes,
            structure_seeds(seeds),
            aspect=aspect,
            on_structure=lambda done, total: bar.update(task, completed=done, total=total),
        )
    for heads, rows in (answers.study_table(found, E), answers.layer_table(found)):
        if rows:
            print_columns(heads, rows)
    try:
        names = answers.write(found, folder, E)
    except OSError as error:
        raise not_written(error, folder) from None
    typer.echo(f"written in {folder}: {', '.join(names)}")
