import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fissura.reports.packed import packed, packed_size, quantised

from .unpacking import dequantised, unpacked

KINDS = [np.float32, np.float64, np.uint8, np.uint16, np.int16, np.int32, np.uint32]
some_arrays = st.sampled_from(KINDS).flatmap(lambda kind: arrays(kind, st.integers(0, 7)))
plain = st.none() | st.booleans() | st.integers(-(2**40), 2**40) | st.floats(allow_nan=False, allow_infinity=False)
content = st.recursive(
    plain | st.text() | some_arrays,
    lambda part: (
        st.lists(part, max_size=4) | st.dictionaries(st.text(max_size=5).filter(lambda k: k != "$array"), part)
    ),
    max_leaves=12,
)


def same(a, b):
    if isinstance(a, np.ndarray):
        return a.dtype.itemsize == b.dtype.itemsize and a.tobytes() == b.tobytes()
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, list):
        return len(a) == len(b) and all(map(same, a, b))
    return a == b


@given(content)
def test_what_is_packed_is_there_again(what):
    text = packed(what)
    assert re.fullmatch(r"[A-Za-z0-9+/=]*", text)
    assert len(text) == packed_size(what)
    assert same(what, unpacked(text))


def test_equal_arrays_are_there_once():
    noise = np.random.default_rng(1).integers(0, 65536, 10_000).astype(np.uint16)
    once, twice = packed_size([noise]), packed_size([noise, noise.copy()])
    assert twice < once + 100
    first, second = unpacked(packed([noise, noise.copy()]))
    np.testing.assert_array_equal(first, second)


def test_bytes_other_byte_orders_and_numbers_that_are_none():
    big = np.arange(3, dtype=">f8")
    found = unpacked(packed({"data": b"\x00\xff", "big": big, "nan": np.nan, "inf": -np.inf, "count": np.int64(3)}))
    assert found["data"].tolist() == [0, 255]
    assert found["big"].tolist() == [0.0, 1.0, 2.0]
    assert (found["nan"], found["inf"], found["count"]) == (None, None, 3)


@pytest.mark.parametrize("what", [object(), {1, 2}, np.zeros(2, complex), np.array(["a"])])
def test_what_cannot_be_packed(what):
    with pytest.raises(TypeError, match="cannot be packed"):
        packed({"x": [what]})


@given(arrays(np.float64, 20, elements=st.floats(-1e6, 1e6)), st.floats(-1e6, 1e6), st.floats(1e-3, 1e6))
def test_quantised_values_are_off_by_half_a_step_at_most(values, low, extent):
    high = low + extent
    found = dequantised(quantised(values, low, high))
    np.testing.assert_allclose(found, np.clip(values, low, high), atol=0.5001 * (high - low) / 65535, rtol=1e-12)


def test_quantised_values_of_one_size():
    found = quantised(np.array([2.0, 2.0, np.nan]), 2.0, 2.0)
    np.testing.assert_array_equal(dequantised(found), [2.0, 2.0, 2.0])
