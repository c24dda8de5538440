"""Numbers that decide something in the engine stand in one place of each room, with what they are for."""

import ast
from pathlib import Path

import pytest

import fissura

ROOMS = (
    "simulation",
    "equilibrium",
    "linear",
    "adaptivity",
    "contact",
    "material",
    "material/field",
    "elasticity",
    "kernels",
)
#: Numbers that are no limits: columns of arrays, indices, places in a file.
OTHERS = {"_CLOSED", "PAIRS", "SPARSE"}
SOURCE = Path(fissura.__file__).parent


def numbers(value):
    """Whether an expression is a number, or several of them."""
    if isinstance(value, ast.Constant):
        return isinstance(value.value, int | float) and not isinstance(value.value, bool)
    if isinstance(value, ast.Tuple):
        return all(map(numbers, value.elts))
    if isinstance(value, ast.BinOp):
        return numbers(value.left) and numbers(value.right)
    return isinstance(value, ast.UnaryOp) and numbers(value.operand)


def constants(tree):
    """Names at the top level of a module and of its classes that are given numbers, with their lines."""
    bodies = [tree.body, *(node.body for node in tree.body if isinstance(node, ast.ClassDef))]
    for node in (node for body in bodies for node in body):
        if isinstance(node, ast.Assign) and numbers(node.value):
            names = [name.id for target in node.targets for name in ast.walk(target) if isinstance(name, ast.Name)]
            yield names, node.lineno


@pytest.mark.parametrize("room", ROOMS)
def test_limits_of_a_room_stand_in_one_file(room):
    for path in sorted((SOURCE / room).glob("*.py")):
        if path.name == "limits.py":
            continue
        found = [names for names, _ in constants(ast.parse(path.read_text())) if not OTHERS.issuperset(names)]
        found = [names for names in found if any(name.isupper() for name in names)]
        assert not found, f"{path}: {found} belongs into limits.py"


@pytest.mark.parametrize("path", sorted(SOURCE.rglob("limits.py")), ids=lambda path: path.parent.name)
def test_every_limit_is_explained_and_used(path):
    text = path.read_text()
    lines, room = text.splitlines(), path.parent
    others = "\n".join(other.read_text() for other in room.rglob("*.py") if other != path)
    others += "\n".join(line for line in lines if not line.startswith("#"))
    asked = "\n".join(other.read_text() for other in (SOURCE / "cli").glob("*.py"))
    for names, line in constants(ast.parse(text)):
        while not lines[line - 2].startswith("#:") and lines[line - 2] and lines[line - 2][0].isupper():
            line -= 1  # several under one explanation
        assert lines[line - 2].startswith("#:"), f"{path}, {names}: why?"
        for name in names:
            assert others.count(name) > 1 or name in asked, f"{path}: {name} is not used"
