"""Lists of values on the command line."""

import tomllib
from collections.abc import Iterable
from typing import Any

from fissura.errors import InputError

_VARY = '"KEY=VALUE, VALUE", such as "material.f_t=2.5 MPa, 3 MPa"'


def varied(options: Iterable[str]) -> dict[str, list[Any]]:
    """Values by key, from texts such as ``"material.f_t=2.5 MPa, 3 MPa"``.

    What TOML reads as a list of values is one, ``"supports[0].at=5, 6"``; else values are texts between commas.

    Raises
    ------
    InputError
        A text has no key or no value, or a key comes twice.
    """
    found: dict[str, list[Any]] = {}
    for option in options:
        key, sign, text = (part.strip() for part in option.partition("="))
        if not key or not sign or not text:
            raise InputError("--vary", f"{option!r} is not a key with values", _VARY)
        if key in found:
            raise InputError("--vary", f"{key} is given twice", "all values of a key in one --vary")
        found[key] = _values(text)
    return found


def _values(text: str) -> list[Any]:
    try:
        return list(tomllib.loads(f"v = [{text}]")["v"])
    except tomllib.TOMLDecodeError:
        return [_value(part.strip()) for part in text.split(",") if part.strip()]


def _value(text: str) -> Any:
    try:
        return tomllib.loads(f"v = {text}")["v"]
    except tomllib.TOMLDecodeError:
        return text


def setting(option: str) -> tuple[str, Any]:
    """Key and value from a text such as ``"material.macro.E=37 GPa"``.

    Raises
    ------
    InputError
        The text has no key or no value.
    """
    key, sign, text = (part.strip() for part in option.partition("="))
    if not key or not sign or not text:
        raise InputError("--set", f"{option!r} is not a key with a value", '"KEY=VALUE", such as "material.mu=0.3"')
    return key, _value(text)


def seed_list(text: str) -> list[int]:
    """Whole numbers between commas or blanks.

    Raises
    ------
    InputError
        Something else is there.
    """
    try:
        return [int(part) for part in text.replace(",", " ").split()]
    except ValueError:
        raise InputError("--seeds", f"{text!r} is not a list of whole numbers", '"1, 2, 3"') from None
