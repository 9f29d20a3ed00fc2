"""Bits of a float as an integer and back, and constant tables of floats inside the machine code."""

from __future__ import annotations

import struct
from collections.abc import Callable
from hashlib import sha256

try:
    import numba

    INSTALLED, COMPILED = True, not numba.config.DISABLE_JIT
except ImportError:
    INSTALLED = COMPILED = False


_packed, _unpacked = struct.Struct("<d"), struct.Struct("<q")


def _plain_bits(number, pack=_packed.pack, unpack=_unpacked.unpack):
    """Return the 64 bits of a float as an integer."""
    return unpack(pack(number))[0]


def _plain_float(bits, pack=_unpacked.pack, unpack=_packed.unpack):
    """Return the float with these 64 bits."""
    return unpack(pack(bits))[0]


if COMPILED:
    from llvmlite import ir
    from numba import types
    from numba.core import cgutils
    from numba.extending import intrinsic

    @intrinsic
    def bits_of(typing_context, number):
        """Return the 64 bits of a float as an integer."""

        def generate(context, builder, signature, arguments):
            return builder.bitcast(arguments[0], ir.IntType(64))

        return types.int64(types.float64), generate

    @intrinsic
    def float_of(typing_context, bits):
        """Return the float with these 64 bits."""

        def generate(context, builder, signature, arguments):
            return builder.bitcast(arguments[0], ir.DoubleType())

        return types.float64(types.int64), generate

    # functions for plain Python, under the attribute name that numba's kernels use
    bits_of.py_func, float_of.py_func = _plain_bits, _plain_float

    def table(values: tuple[float, ...]) -> Callable[[int], float]:
        """Return a function that returns the float at an index, from constants in the machine code. The index is not checked."""
        # A name made from the values: all kernels that use this table then share one copy.
        name = f"table.{sha256(repr(values).encode()).hexdigest()[:16]}"

        @intrinsic
        def at(typing_context, index):
            """Return the float at `index`."""

            def generate(context, builder, signature, arguments):
                rows = builder.module.globals.get(name) or cgutils.global_constant(
                    builder.module,
                    name,
                    ir.Constant(ir.ArrayType(ir.DoubleType(), len(values)), values),
                    "linkonce_odr",
                )
                return builder.load(builder.gep(rows, [ir.IntType(32)(0), arguments[0]], inbounds=True))

            return types.float64(types.int64), generate

        at.py_func = lambda index, values=values: values[index]
        return at

else:
    bits_of, float_of = _plain_bits, _plain_float

    def table(values: tuple[float, ...]) -> Callable[[int], float]:
        """Return a function that returns the float at an index."""
        return lambda index: values[index]
