"""6x6 blocks times vectors of six numbers, in vector instructions, and a hint to load blocks in time.

Loops over six numbers are too short for the compiler to turn into vector instructions, so the products are given as
such. Sums may be taken in any order, always the same one in one build.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils as _cgutils
from numba.extending import intrinsic

_DOUBLE = ir.DoubleType()
_SIX = ir.VectorType(_DOUBLE, 6)
_FLAGS = ("reassoc", "contract", "nsz")
cgutils: Any = _cgutils  # its functions have no types
_TUPLE: Any = types.UniTuple(types.float64, 6)  # type: ignore[no-untyped-call]


def _row(context: Any, builder: Any, array_type: Any, array: Any, k: Any, a: int) -> Any:
    """Row a of block k as a vector of doubles."""
    items = context.make_array(array_type)(context, builder, array)
    place = builder.add(builder.mul(k, ir.Constant(k.type, 36)), ir.Constant(k.type, 6 * a))
    pointer = builder.gep(items.data, [place])
    if array_type.dtype == types.float64:
        return builder.load(builder.bitcast(pointer, _SIX.as_pointer()), align=8)
    single = ir.VectorType(ir.FloatType(), 6)
    return builder.fpext(builder.load(builder.bitcast(pointer, single.as_pointer()), align=4), _SIX)


def _vector(builder: Any, numbers: list[Any]) -> Any:
    out = ir.Constant(_SIX, ir.Undefined)
    for d, number in enumerate(numbers):
        out = builder.insert_element(out, number, ir.Constant(ir.IntType(32), d))
    return out


def _numbers(builder: Any, vector: Any) -> list[Any]:
    return [builder.extract_element(vector, ir.Constant(ir.IntType(32), d)) for d in range(6)]


def _transposed_times(typing_context, blocks, k, x):  # type: ignore[no-untyped-def]
    """``blocks[k].T @ x``: C-ordered (n, 6, 6) array, number, tuple of six -> tuple of six."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        array, k, x = arguments
        total = None
        for a, number in enumerate(cgutils.unpack_tuple(builder, x)):
            term = builder.fmul(
                _row(context, builder, signature.args[0], array, k, a), _vector(builder, [number] * 6), flags=_FLAGS
            )
            total = term if total is None else builder.fadd(total, term, flags=_FLAGS)
        return cgutils.pack_array(builder, _numbers(builder, total))

    return _TUPLE(blocks, types.int64, x), generate


def _times(typing_context, blocks, k, x):  # type: ignore[no-untyped-def]
    """``blocks[k] @ x``: C-ordered (n, 6, 6) array, number, tuple of six -> tuple of six."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        array, k, x = arguments
        vector = _vector(builder, cgutils.unpack_tuple(builder, x))
        found = []
        for a in range(6):
            terms = builder.fmul(_row(context, builder, signature.args[0], array, k, a), vector, flags=_FLAGS)
            reduce = cgutils.get_or_insert_function(
                builder.module, ir.FunctionType(_DOUBLE, [_DOUBLE, _SIX]), "llvm.vector.reduce.fadd.v6f64"
            )
            found.append(builder.call(reduce, [ir.Constant(_DOUBLE, -0.0), terms], fastmath=_FLAGS))
        return cgutils.pack_array(builder, found)

    return _TUPLE(blocks, types.int64, x), generate


def _hint(context: Any, builder: Any, kind: Any, array: Any, place: Any, items: int) -> Any:
    """Ask for items from a place on to be loaded, one in each line of the cache; it may lie beyond the array."""
    data = context.make_array(kind)(context, builder, array).data
    byte, word = ir.IntType(8).as_pointer(), ir.IntType(32)
    hint_kind = ir.FunctionType(ir.VoidType(), [byte, word, word, word])
    hint = builder.module.declare_intrinsic("llvm.prefetch", [byte], hint_kind)
    first = builder.gep(data, [place])
    for item in range(0, items, 64 // (kind.dtype.bitwidth // 8)):
        at = builder.bitcast(builder.gep(first, [ir.Constant(place.type, item)]), byte)
        builder.call(hint, [at, word(0), word(3), word(1)])  # to read, and to keep
    return context.get_dummy_value()


def _prefetch(typing_context, blocks, k):  # type: ignore[no-untyped-def]
    """Ask for ``blocks[k]``, which may lie beyond the array, to be loaded: C-ordered (n, 6, 6) array, number."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        array, k = arguments
        place = builder.mul(k, ir.Constant(k.type, 36))
        return _hint(context, builder, signature.args[0], array, place, 36)

    return types.void(blocks, types.int64), generate


def _prefetch_item(typing_context, items, k):  # type: ignore[no-untyped-def]
    """Ask for ``items[k]``, which may lie beyond the array, to be loaded: array with one axis, number."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        array, k = arguments
        return _hint(context, builder, signature.args[0], array, k, 1)

    return types.void(items, types.int64), generate


# Typed as what they are inside compiled functions.
prefetch: Any = intrinsic(_prefetch)
prefetch_item: Any = intrinsic(_prefetch_item)
times: Any = intrinsic(_times)
transposed_times: Any = intrinsic(_transposed_times)
