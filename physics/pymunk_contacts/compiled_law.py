"""The contact law as a C function pointer, ``double f(void *spring, double distance)``, for C libraries."""

from __future__ import annotations

import math
from functools import cache

from softcradle.physics.numerics.jit import c_function
from softcradle.physics.numerics.law_kernels import force

# Part of the touching distance: deeper contacts are checked in Python, because the bodies may pass through each other.
DEEP = 0.5
LAW_SLOT = 18  # pointer-sized slot of a Chipmunk spring that holds the address of its law

try:
    from llvmlite import ir
    from numba.extending import intrinsic
except ImportError:  # then nothing is compiled
    pass
else:

    @intrinsic
    def call_at(typing_context, address, spring, distance):
        """What the C function ``double f(void *spring, double distance)`` at `address`, an int, returns."""

        def generate(context, builder, signature, values):
            double, pointer = (context.get_value_type(kind) for kind in (distance, spring))
            function = ir.FunctionType(double, [pointer, double]).as_pointer()
            return builder.call(builder.inttoptr(values[0], function), values[1:])

        return distance(address, spring, distance), generate


def push(spring, distance):
    """Force at `distance`; the law is found through the spring.

    It is (preload, stiffness, exponent, touching distance, overlap, was closed, address); an overlap that is not NaN is
    used as it is. A contact that closes, that is deep, or whose overlap is NaN is left to the function at `address`, if
    that is not 0.
    """
    law = spring[LAW_SLOT]
    overlap = law[4]
    if math.isnan(overlap):
        overlap = law[3] - distance
        was_closed, law[5] = law[5], 1.0 if overlap > 0.0 else 0.0
        if law[6] != 0.0 and (law[5] > was_closed or overlap > DEEP * law[3] or math.isnan(overlap)):
            return call_at(int(law[6]), spring, distance)
    return force(law[0], law[1], law[2], overlap)


@cache  # machine code lives as long as the object that made it
def compiled_push():
    """:func:`push` in machine code, with its ``address``; compiled once and kept on disk with the other kernels.

    Raises ImportError without numba, RuntimeError where NUMBA_DISABLE_JIT switches it off.
    """
    from numba import types

    return c_function(push, types.float64(types.CPointer(types.CPointer(types.float64)), types.float64))
