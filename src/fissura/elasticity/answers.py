"""Answers of the command `fissura elastic` as rows of tables, files and pictures."""

import math
from pathlib import Path

from fissura.case import Case
from fissura.case.macroscopic import macroscopic_elasticity, voigt
from fissura.elasticity import limits
from fissura.elasticity.pictures import plot_alpha, plot_size
from fissura.elasticity.study import Study, spread
from fissura.elasticity.tension import macroscopic_tension
from fissura.errors import InputError
from fissura.files.atomic import write_atomically
from fissura.files.folder import Folder

_KINDS = {"periodic": "periodic cell", "gauge": "prism, gauge", "ends": "prism, end to end"}


def _stress(value: float) -> str:
    return f"{value / 1e9:.4g} GPa" if value >= 1e8 else f"{value / 1e6:.4g} MPa"


def _constants(E: float, alpha: float) -> list[tuple[str, str]]:
    """Rows of both sets of constants."""
    macro, nu = macroscopic_elasticity().macroscopic(E, alpha)
    ratio, by_voigt = voigt(alpha)
    return [
        ("contacts: E", _stress(E)),
        ("contacts: alpha", f"{alpha:.4g}"),
        ("bulk: E", f"{_stress(macro)}, {macro / E:.4f} of that of the contacts"),
        ("bulk: nu", f"{nu:.4f}"),
        ("Voigt's estimate", f"E {_stress(ratio * E)}, nu {by_voigt:.4f}"),
    ]


def _tension(case: Case) -> list[tuple[str, str]]:
    """Rows of strength and fracture energy of a case's material as a whole in tension."""
    m = case.material
    rows = _whole(m.E, m.alpha, m.f_t, m.G_t, case.discretization.l_f)
    usual = ((m.f_s, 3.0 * m.f_t), (m.f_c, 16.0 * m.f_t), (m.G_s, 16.0 * m.G_t))
    notes = []
    if not all(math.isclose(value, default, rel_tol=1e-6) for value, default in usual):
        notes.append("measured with the default f_s, f_c and G_s")
    if case.field is not None:
        notes.append("measured without a random field, which weakens")
    return [*rows, *(("but", note) for note in notes)]


def _whole(E: float, alpha: float, f_t: float, G_t: float, l_f: float) -> list[tuple[str, str]]:
    """Rows of strength and fracture energy of the whole in tension, for constants of contacts."""
    known = macroscopic_tension()
    brittleness = 2.0 * E * G_t / f_t**2 / l_f
    strength, energy = known.strength(brittleness, alpha), known.energy(brittleness, alpha)
    prisms = sum(group.prisms for group in known.groups)
    rows = [
        ("contacts: f_t, G_t", f"{_stress(f_t)}, {G_t:.4g} J/m^2"),
        ("whole: strength", f"{_stress(strength[0] * f_t)} to {_stress(strength[1] * f_t)}, {_times(strength)} f_t"),
        ("whole: fracture energy", f"{energy[0] * G_t:.3g} to {energy[1] * G_t:.3g} J/m^2, {_times(energy)} G_t"),
        ("measured on", f"{prisms} prisms pulled apart (docs/theory.md); single ones, ± a standard deviation"),
    ]
    notes = [
        f"{what} is {value:.3g}, measured from {low:g} to {high:g}"
        for what, value, (low, high) in (
            ("l_t / l_f", brittleness, known.limits("brittleness")),
            ("alpha", alpha, known.limits("alpha")),
        )
        if not low <= value <= high
    ]
    return [*rows, *(("but", note) for note in notes)]


def _times(factors: tuple[float, float]) -> str:
    return f"{factors[0]:.2f} to {factors[1]:.2f}"


def case_rows(case: Case) -> list[tuple[str, str]]:
    """Constants of a case's contacts and of its material as a whole: elastic ones, strength and fracture energy.

    Raises
    ------
    InputError
        An `alpha` for which there are no bulk values.
    """
    try:
        return [("case", case.name), *_constants(case.material.E, case.material.alpha), *_tension(case)]
    except InputError as error:
        raise InputError(f"material.{error.key}", error.problem, error.allowed) from None


def inverse_rows(E: float, nu: float, tension: tuple[float, float, float] | None = None) -> list[tuple[str, str]]:
    """Contact constants that give a modulus of elasticity [Pa] and a Poisson's ratio.

    Parameters
    ----------
    E, nu : float
        Of the whole; `E` [Pa].
    tension : tuple of float, optional
        Tensile strength [Pa] and fracture energy [J/m^2] of the whole and the size of bodies [m]; adds the strength and
        the fracture energy of the contacts.

    Raises
    ------
    InputError
        A Poisson's ratio that cannot be reached.
    """
    try:
        contact, alpha = macroscopic_elasticity().contact(E, nu)
    except InputError as error:
        raise InputError(f"--inverse {error.key}", error.problem, error.allowed) from None
    rows, more = _constants(contact, alpha), ", ..."
    if tension is not None:
        strength, energy, l_f = tension
        f_t, G_t = macroscopic_tension().contact(strength, energy, contact, alpha, l_f)
        rows += _whole(contact, alpha, f_t, G_t, l_f)
        more = f', f_t = "{f_t / 1e6:.4g} MPa", G_t = "{G_t:.4g} J/m^2"'
    case_file = f'material = {{ macro = {{ E = "{E / 1e9:g} GPa", nu = {nu:g} }}{more} }}'
    return [*rows, ("in a case file", case_file)]


def _number(value: float, decimals: int = 4) -> str:
    return f"{value:.{decimals}f}" if math.isfinite(value) else "-"


def study_table(found: Study, E: float | None = None) -> tuple[list[str], list[list[str]]]:
    """Heads and rows of a study: means with half of their 95 % confidence interval, and standard deviations.

    Parameters
    ----------
    found : Study
        The study.
    E : float, optional
        Modulus of the contacts [Pa]; adds a column with the macroscopic one.
    """
    heads = ["structure", "alpha", "l_min/size", "bodies", "seeds", "E/E_c", "std", "nu", "std", "anisotropy"]
    rows = []
    for row in found.rows:
        modulus, deviation, half = spread(row.E)
        nu, nu_deviation, nu_half = spread(row.nu)
        line = [_KINDS[row.kind], f"{row.alpha:g}", f"{1.0 / row.size:.4f}", f"{row.bodies:.0f}", f"{row.seeds}"]
        line += [f"{_number(modulus)} ± {_number(half)}", _number(deviation)]
        line += [f"{_number(nu)} ± {_number(nu_half)}", _number(nu_deviation), _number(row.anisotropy)]
        rows.append(line + ([] if E is None else [_stress(modulus * E)]))
    return heads + ([] if E is None else ["E"]), rows


def layer_table(found: Study) -> tuple[list[str], list[list[str]]]:
    """Heads and rows of fits ``E = E_bulk (1 + c l_min/size)`` to prisms; no rows where there is too little to fit."""
    heads = ["structure", "alpha", "E_bulk/E_c", "c"]
    rows = []
    for kind in ("gauge", "ends"):
        for alpha in found.alphas:
            fit = found.layer(kind, alpha)
            if fit is not None:
                limit = f"{_number(fit.E_bulk)} ± {_number(fit.E_bulk_error)}"
                rows.append([_KINDS[kind], f"{alpha:g}", limit, f"{fit.c:+.3f} ± {fit.c_error:.3f}"])
    return heads, rows


def write_csv(found: Study, path: Path, E: float | None = None) -> None:
    """Write all rows of a study as full numbers; moduli relative to that of the contacts, which `E` [Pa] adds."""
    head = "structure,alpha,l_min_over_size,bodies,seeds,E_ratio,E_ratio_std,E_ratio_ci95,nu,nu_std,nu_ci95,anisotropy"
    lines = [head + ("" if E is None else ",E_Pa")]
    for row in found.rows:
        modulus, nu = spread(row.E), spread(row.nu)
        numbers = [row.alpha, 1.0 / row.size, row.bodies, row.seeds, *modulus, *nu, row.anisotropy]
        numbers += [] if E is None else [E * modulus[0]]
        lines.append(",".join([row.kind, *(f"{number:.10g}" for number in numbers)]))
    write_atomically(path, ("\n".join(lines) + "\n").encode())


def write(found: Study, folder: Path, E: float | None = None) -> list[str]:
    """Write table and pictures of a study; returns the names of the files.

    Parameters
    ----------
    found : Study
        The study.
    folder : Path
        Exists already.
    E : float, optional
        Modulus of the contacts [Pa].
    """
    # The picture over sizes shows one alpha: the one nearest to that of concrete.
    shown = min(found.alphas, key=lambda alpha: abs(alpha - limits.CONCRETE))
    names = ["elastic.csv", "elastic_alpha.png", "elastic_size.png"]
    Folder.begun(folder, "elastic").add(*names)
    write_csv(found, folder / names[0], E)
    plot_alpha(found, folder / names[1])
    plot_size(found, folder / names[2], shown)
    return names
