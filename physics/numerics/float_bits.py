"""The bits of a float as an integer, and back: one move between registers, and no obstacle to vectorised loops."""

from __future__ import annotations

import struct

try:
    import numba

    COMPILED = not numba.config.DISABLE_JIT
except ImportError:
    COMPILED = False


def _has_vectors():
    """Whether this machine has vector code for float and integer alike: wide registers and fused products."""
    from llvmlite import binding

    features = binding.get_host_cpu_features()
    return bool(features.get("avx2") and features.get("fma"))


def _plain_bits(number):
    """The 64 bits of a float as an integer."""
    return struct.unpack("<q", struct.pack("<d", number))[0]


def _plain_float(bits):
    """The float that has these 64 bits."""
    return struct.unpack("<d", struct.pack("<q", bits))[0]


VECTORS = COMPILED and _has_vectors()

if COMPILED:
    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic

    @intrinsic
    def bits_of(typing_context, number):
        """The 64 bits of a float as an integer."""

        def generate(context, builder, signature, arguments):
            return builder.bitcast(arguments[0], ir.IntType(64))

        return types.int64(types.float64), generate

    @intrinsic
    def float_of(typing_context, bits):
        """The float that has these 64 bits."""

        def generate(context, builder, signature, arguments):
            return builder.bitcast(arguments[0], ir.DoubleType())

        return types.float64(types.int64), generate

    # what plain Python calls in their place, as of a kernel
    bits_of.py_func, float_of.py_func = _plain_bits, _plain_float

else:
    bits_of, float_of = _plain_bits, _plain_float
