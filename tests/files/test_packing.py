import json
from dataclasses import dataclass, field

import numpy as np
import pytest

from fissura.files.packing import pack, unpack


@dataclass(frozen=True)
class Inner:
    value: float | None
    some: np.ndarray = field(default_factory=lambda: np.arange(3))


@dataclass(frozen=True)
class Outer:
    name: str
    inner: Inner | None
    all: tuple[Inner, ...] = ()
    count: int = 3


def again(value, types=(Inner, Outer)):
    arrays = {}
    return unpack(json.loads(json.dumps(pack(value, "top", arrays))), arrays, types)


@pytest.mark.parametrize("number", [0.1, -0.0, 5e-324, 1e308, np.inf, np.nan, 2**62, True, None, "ä"])
def test_plain_values_come_back_to_the_last_bit(number):
    found = again(number)
    assert type(found) is type(number)
    assert repr(found) == repr(number)


def test_nested_dataclasses_come_back():
    found = again(Outer("a", Inner(0.1), (Inner(None, np.eye(2)), Inner(np.float64(0.3)))))
    assert (found.name, found.count, found.inner.value, found.all[1].value) == ("a", 3, 0.1, 0.3)
    assert [type(part) for part in found.all] == [Inner, Inner]
    np.testing.assert_array_equal(found.all[0].some, np.eye(2))
    assert again(Outer("b", None)).inner is None


@pytest.mark.parametrize("some", [np.empty((0, 3)), np.empty(0, np.int32), np.zeros((2, 0), bool)])
def test_empty_arrays_keep_their_shape(some):
    arrays = {}
    found = unpack(json.loads(json.dumps(pack(some, "some", arrays))), arrays, ())
    assert (found.shape, found.dtype) == (some.shape, some.dtype)
    assert not arrays


def test_fields_of_later_versions_get_their_defaults():
    arrays = {}
    tree = pack(Outer("a", None), "", arrays)
    del tree["fields"]["count"], tree["fields"]["all"]
    assert unpack(tree, arrays, (Outer,)) == Outer("a", None)


def test_nothing_else_is_made():
    with pytest.raises(KeyError):
        again(Outer("a", None), types=())
    with pytest.raises(TypeError, match="set cannot be packed"):
        pack({1}, "", {})
    with pytest.raises(TypeError):
        unpack({"type": "Inner", "fields": {"nonsense": 1}}, {}, (Inner,))
