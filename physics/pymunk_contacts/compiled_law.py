"""Contact law as a C function pointer, ``double f(void *spring, double distance)``, for C libraries."""

from __future__ import annotations

import math
from functools import cache

from softcradle.physics.numerics.jit import c_function
from softcradle.physics.numerics.law_kernels import force

# Fraction of the touching distance. Deeper contacts are checked in Python, because the bodies may pass through each
# other.
DEEP = 0.5
LAW_SLOT = 18  # Index of the pointer-sized slot of a Chipmunk spring that holds the address of its law.

try:
    from llvmlite import ir
    from numba.extending import intrinsic
except ImportError:  # without numba nothing is compiled
    pass
else:

    @intrinsic
    def call_at(typing_context, address, spring, distance):
        """Return the result of the C function ``double f(void *spring, double distance)`` at the integer `address`."""

        def generate(context, builder, signature, values):
            double, pointer = (context.get_value_type(kind) for kind in (distance, spring))
            function = ir.FunctionType(double, [pointer, double]).as_pointer()
            return builder.call(builder.inttoptr(values[0], function), values[1:])

        return distance(address, spring, distance), generate


def push(spring, distance):
    """Return the force [N] at `distance` [m]; the law is found through the spring.

    The law holds preload, stiffness, exponent, touching distance, overlap, the flag "was closed" and an address. If the
    stored overlap is not NaN, it is used instead of the distance. If the address is not 0, the function there handles a
    contact that has just closed, is deep, or has a NaN overlap.
    """
    # the stiffness slot of the spring holds the address of the law
    law = spring[LAW_SLOT]
    overlap = law[4]
    if math.isnan(overlap):
        # remember if the contact is closed, so that Python is called when it closes
        overlap = law[3] - distance
        was_closed, law[5] = law[5], 1.0 if overlap > 0.0 else 0.0
        if law[6] != 0.0 and (law[5] > was_closed or overlap > DEEP * law[3] or math.isnan(overlap)):
            return call_at(int(law[6]), spring, distance)
    return force(law[0], law[1], law[2], overlap)


@cache  # machine code lives as long as the object that created it
def compiled_push():
    """Return :func:`push` as machine code with its ``address``, compiled once and cached on disk with the other kernels.

    Raises ImportError without numba, and RuntimeError if NUMBA_DISABLE_JIT is set.
    """
    from numba import types

    return c_function(push, types.float64(types.CPointer(types.CPointer(types.float64)), types.float64))
