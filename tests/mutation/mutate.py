"""Mutations of input files: of values and keys where a file is tables, of bytes in any file.

Everything is drawn from one `random.Random`, so that a mutation can be made again from its seed.
"""

from __future__ import annotations

import copy
import datetime
import json
import math
import random
from collections.abc import Callable
from typing import Any

__all__ = ["Tables", "mutated_bytes", "mutated_tables", "possible_tables", "written", "written_json"]

Tables = dict[str, Any]
Place = tuple[Any, ...]

#: What people and programs write where a number, a text, a list or a table belongs.
ODD: tuple[Any, ...] = (
    0, 1, -1, 2, 0.0, -0.0, 0.5, 1.0, -0.1, 100, 1e-12, 1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9, 1e12, 1e30, 1e300, 1e-300,
    5e-324, 1.7e308, math.nan, math.inf, -math.inf, 2**31, 2**63 - 1, 2**63, 2**64, 10**30, 10**400, 16**6000, True,
    False, "", " ", "0", "1", "5 mm", "5mm", "-5 mm", "0 mm", "5 m", "5 km", "5 kg", "5", "5,0 mm", "1 000 mm", "mm",
    "five mm", "nan mm", "inf mm", "1e400 mm", "1e-400 mm", "5 mm + 3 mm", "(5) mm", "12 (9**9**9)*m", "1 m**9**9**9",
    "5 %", "500 %", "2 MPa", "2 GPa", "2 Pa", "35 J/m^2", "35 Nm/m^2", "35 J/m^2^2^2", "0x10", "1_000", "١ mm",
    "５ mm", "5 µm", "5 mm\x00", "ball", "box", "pin", "roller", "clamp", "guide", "x", "y", "z", "left", "right",
    "bottom", "top", "front", "back", "side", "gauge", "displacement", "dissipation", "utilisation", "rankine",
    "cusatis-cedolin", "exponential", "matern", "gaussian", "lognormal", "weibull", "grafted", "direct", "two-level",
    "amg", "auto", "nuclei.txt", "nuclei.npy", "measured.csv", "case.toml", "missing.txt", ".", "..", "/",
    "/dev/zero", "pipe", "~", "a/b", "a\x00b", "a\nb", "\x1b[31m", "😀" * 50, "x" * 5000, "ü", "\u202e", "{}", "[]",
    "null", "None", "NaN", "true", "$SEED", "%s %d {0}", "<script>", "'\"\\", [], [0], [1, 2, 3], [0, 0, 0],
    [1, 0, 0], [0, -1, 0], [1e300, 0, 0], [math.nan] * 3, ["5 mm"] * 3, ["5 mm", 1, "x"], [1] * 1000, [[1, 2, 3]],
    [[[[[[[[[[1]]]]]]]]]], [{}], [{}] * 200, [True, 1, "x", None], {}, {"type": "ball"},
    {"type": "ball", "center": [0, 0, 0], "radius": 0.01}, {"type": "box", "lower": [0, 0, 0], "upper": [1, 1, 1]},
    {"face": "top"}, {"face": "top", "at": 0.04}, {"face": "bottom", "point": [0.04, 0, 0]}, {"E": 38e9, "nu": 0.2},
    {"a": {"b": {"c": {"d": 1}}}}, {"": 1}, {"a b.c": 1}, datetime.date(2020, 2, 29), datetime.time(1, 2, 3),
    datetime.datetime(1, 1, 1, tzinfo=datetime.UTC),
)  # fmt: skip

#: Keys that exist somewhere, and some that do not.
KEYS = (
    "at", "width", "point", "along", "face", "type", "direction", "normal", "position", "depth", "center", "radius",
    "lower", "upper", "E", "alpha", "f_t", "G_t", "f_s", "f_c", "G_s", "K_c", "mu", "beta", "n_c", "macro", "nu",
    "elastic", "l_f", "l_c", "nuclei", "tolerance", "gamma", "ahead", "r_f", "r_c", "r_w", "coarsen", "regions",
    "target", "max_step", "seed", "first_step", "min_step", "max_iterations", "switch", "stop_load", "length",
    "correlation", "marginal", "cov", "shape", "graft", "leading", "energy", "spacing", "variance_error", "vtk",
    "measured", "linear", "threads", "name", "size", "change", "seeds", "specimens", "case", "limits", "source",
    "model_config", "__class__", "", "a b", "a.b", "x" * 300, "l-f", "L_F", "größe", "\x00", "__proto__",
)  # fmt: skip


def _places(value: Any, here: Place = ()) -> list[Place]:
    """Where something stands in nested tables and lists, the whole left out."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [place for key, item in inner for place in ((*here, key), *_places(item, (*here, key)))]


def _at(tables: Any, place: Place) -> Any:
    for key in place:
        tables = tables[key]
    return tables


def _number(rng: random.Random, value: Any) -> Any:
    """A number near, far, or on the other side of what stands there; of a text with a unit its number."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return rng.choice(ODD)
    text, _, unit = value.partition(" ") if isinstance(value, str) else (value, "", "")
    try:
        number = float(text)
    except (OverflowError, ValueError):
        return rng.choice(ODD)
    near = (0.1, 0.5, 0.7, 0.9, 1.1, 1.5, 2.0, 3.0, 10.0)
    number *= rng.choice((*near, *near, -1.0, 0.0, 1e-3, 1e3, 1e6, 1e-6, 10.0 ** rng.uniform(-20.0, 20.0)))
    if isinstance(value, str):
        return f"{number!r} {rng.choice((*[unit] * 12, 'mm', 'm', 'MPa', 'J/m^2', 'km', ''))}".strip()
    return int(number) if isinstance(value, int) and abs(number) < 1e18 and rng.random() < 0.8 else number


#: What may stand at some keys, so that cases stay possible.
_CHOICES: dict[str, tuple[Any, ...]] = {
    "face": ("left", "right", "bottom", "top", "front", "back"),
    "along": ("x", "y", "z"),
    "normal": ("x", "y", "z"),
    "criterion": ("utilisation", "rankine"),
    "correlation": ("squared-exponential", "exponential", "matern"),
    "marginal": ("grafted", "gaussian", "lognormal", "weibull"),
    "linear": ("auto", "direct", "two-level", "amg"),
    "seed": (0, 1, 2, 3, 12345, 2**63 - 1),
    "direction": ([1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [1, 2, -3], [0, 1e-9, 1]),
}


def possible_tables(rng: random.Random, tables: Tables, changes: int) -> tuple[Tables, tuple[str, ...]]:
    """Copy of tables with some numbers scaled by up to four and some names replaced: many are possible cases.

    Parameters and results are those of `mutated_tables`.
    """
    found: Tables = copy.deepcopy(tables)
    touched: list[str] = []
    for _ in range(changes):
        places = [place for place in _places(found) if not isinstance(_at(found, place), (dict, list))]
        place = rng.choice(places)
        outer, key, value = _at(found, place[:-1]), place[-1], _at(found, place)
        touched.append(str(place[0]))
        if key in _CHOICES:
            outer[key] = copy.deepcopy(rng.choice(_CHOICES[key]))
        elif key == "type":
            control = ("gauge", "displacement", "dissipation")
            outer[key] = rng.choice(control if value in control else ("pin", "roller", "clamp", "guide"))
        elif isinstance(value, bool):
            outer[key] = not value
        elif isinstance(value, int):
            outer[key] = rng.randrange(10)
        elif isinstance(value, (float, str)):
            number, _, unit = str(value).partition(" ")
            try:
                scaled = float(number) * 4.0 ** rng.uniform(-1.0, 1.0)
            except ValueError:
                continue
            outer[key] = f"{scaled!r} {unit}" if isinstance(value, str) else scaled
    return found, tuple(touched)


def _word(rng: random.Random, text: str) -> str:
    """A text with one letter more, less or another."""
    k = rng.randrange(len(text) + 1)
    return text[:k] + rng.choice(("", "e", "_", " ", ".", "ß")) + text[k + rng.randrange(2) :]


def mutated_tables(rng: random.Random, tables: Tables, changes: int) -> tuple[Tables, tuple[str, ...]]:
    """Copy of tables with some values or keys changed.

    Parameters
    ----------
    rng : random.Random
        Source of randomness.
    tables : dict
        What a file says.
    changes : int
        How many changes to make.

    Returns
    -------
    tables : dict
        The copy.
    touched : tuple of str
        Keys of the outermost table in which, or to which, something was changed.
    """
    found: Tables = copy.deepcopy(tables)
    touched: list[str] = []
    for _ in range(changes):
        places = _places(found)
        if not places:
            break
        place = rng.choice(places)
        outer, key = _at(found, place[:-1]), place[-1]
        touched.append(str(place[0]))
        kind = rng.randrange(16)
        if kind <= 6:
            outer[key] = _number(rng, outer[key])
        elif kind <= 10:
            outer[key] = copy.deepcopy(rng.choice(ODD))
        elif kind == 11:
            del outer[key]
        elif kind == 12 and isinstance(outer, dict):
            new = _word(rng, key) if rng.random() < 0.7 else rng.choice(KEYS)
            outer[new] = outer.pop(key)
            touched += [new] if len(place) == 1 else []
        elif kind == 13:
            outer[key] = [copy.deepcopy(outer[key]) for _ in range(rng.choice((1, 2, 3, 101)))]
        elif kind == 14:
            other = rng.choice(places)
            touched.append(str(other[0]))
            outer[key] = copy.deepcopy(_at(found, other))
        else:
            inside = outer[key] if isinstance(outer[key], dict) else found
            new = rng.choice(KEYS)
            inside[new] = copy.deepcopy(rng.choice(ODD))
            touched += [new] if inside is found else []
    return found, tuple(touched)


def written(tables: Any) -> str:
    """Tables as TOML; what TOML cannot say, such as None, becomes text."""
    return "".join(f"{_quoted(key)} = {_value(item)}\n" for key, item in tables.items())


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_quoted(key)} = {_value(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return hex(value) if value >= 2**63 else str(value)
    if isinstance(value, float):
        return str(value)
    if isinstance(value, (datetime.date, datetime.time)):
        return value.isoformat()
    return _quoted(str(value))


def _quoted(text: str) -> str:
    text = json.dumps(text.encode("utf-8", "replace").decode(), ensure_ascii=False)
    return text.replace("\x7f", "\\u007f")


def written_json(tables: Any) -> str:
    """Tables as JSON, which has no other way to write whole numbers that Python refuses to write than to cut them."""

    def shorter(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: shorter(item) for key, item in value.items()}
        if isinstance(value, (list, tuple)):
            return [shorter(item) for item in value]
        return 10**4000 if isinstance(value, int) and value > 10**4000 else value

    return json.dumps(shorter(tables), default=str)


#: Bytes that trouble readers.
_BYTES = (
    b"\x00", b"\xff", b"\xff\xfe", b"\xef\xbb\xbf", b"\r", b"\n\n", b"\t", b"#", b'"', b"'", b"[", b"]", b"{", b"}",
    b"=", b",", b";", b".", b"nan", b"inf", b"-", b"1e999", b"9" * 5000, b"0x" + b"f" * 6000, b"a." * 200,
    b"[" * 2000, b"\xe2\x80\xae", "μ".encode(), b"\x93NUMPY", b"1 2 3\n", b"1;2;3\n", b"1,2\n", b"\x1a", b"\\", b"%",
)  # fmt: skip


def _cut(rng: random.Random, data: bytes) -> tuple[int, int]:
    start = rng.randrange(len(data) + 1)
    return start, min(len(data), start + rng.choice((0, 1, 2, 10, 100)))


def _another_byte(rng: random.Random, data: bytes) -> bytes:
    start, _ = _cut(rng, data)
    return data[:start] + bytes([rng.randrange(256)]) + data[start + 1 :]


def _removed(rng: random.Random, data: bytes) -> bytes:
    start, end = _cut(rng, data)
    return data[:start] + data[end:]


def _repeated(rng: random.Random, data: bytes) -> bytes:
    start, end = _cut(rng, data)
    return data[:end] + data[start:end] * rng.choice((1, 2, 50)) + data[end:]


def _inserted(rng: random.Random, data: bytes) -> bytes:
    start, end = _cut(rng, data)
    return data[:start] + rng.choice(_BYTES) + data[rng.choice((start, end)) :]


def _ended(rng: random.Random, data: bytes) -> bytes:
    return data[: rng.randrange(len(data) + 1)]


def _lines(rng: random.Random, data: bytes) -> bytes:
    lines = data.split(b"\n")
    k, j = rng.randrange(len(lines)), rng.randrange(len(lines))
    lines[k], lines[j] = lines[j], lines[k]
    return b"\n".join(lines if rng.random() < 0.5 else [*lines[:k], *lines[j:]])


def _digit(rng: random.Random, data: bytes) -> bytes:
    digits = [k for k, byte in enumerate(data) if byte in b"0123456789"]
    if not digits:
        return data
    k = rng.choice(digits)
    return data[:k] + rng.choice((b"", b"9", b"0", b"-", b"e9", b"e-9", b".", b",", b"99")) + data[k + 1 :]


def _encoded(rng: random.Random, data: bytes) -> bytes:
    text = data.decode("utf-8", "replace")
    return text.encode(rng.choice(("utf-16", "utf-32", "utf-8-sig", "cp037")), "replace")


_CHANGES: tuple[Callable[[random.Random, bytes], bytes], ...] = (
    _another_byte, _removed, _repeated, _inserted, _inserted, _ended, _lines, _digit, _digit, _digit, _encoded,
)  # fmt: skip


def mutated_bytes(rng: random.Random, data: bytes, changes: int) -> bytes:
    """Bytes of a file with some of them changed, lost, repeated or in another place."""
    for _ in range(changes):
        data = rng.choice(_CHANGES)(rng, data)
    return data
