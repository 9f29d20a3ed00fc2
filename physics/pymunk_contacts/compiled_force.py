"""Compiled force callbacks for pymunk springs, through pymunk's private C interface.

pymunk does not guarantee that this interface stays the same. Each part that softcradle uses is checked once, on a test
spring. If a check fails, Python callbacks are used instead.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import pymunk
from softcradle.physics.pymunk_contacts.compiled_law import LAW_SLOT, compiled_push

# Fields of a law: preload, stiffness, exponent, touching distance, overlap, a flag, and an address. If the overlap is
# NaN, it is computed from the distance. The flag is 1 if the contact was closed. The address is that of the C function
# that calls the Python callback.
LAW_TYPE = "double[7]"


def unavailable() -> str:
    """Return the reason why compiled callbacks are not available, or an empty string if they are."""
    return _callback()[1]


def attach(spring: pymunk.DampedSpring) -> Any:
    """Replace the force function of `spring` by compiled code. Return the array of numbers that define its contact law.

    The numbers may be changed at any time. The array must live as long as the spring, so store a reference to it in the
    spring.
    """
    from pymunk._chipmunk_cffi import ffi, lib

    # The law is a C array. The address of this array is stored in the stiffness field of the spring, which is not used
    # otherwise.
    law = ffi.new(LAW_TYPE)
    law[6] = _python_address()
    ffi.cast("double **", spring._constraint)[LAW_SLOT] = law
    lib.cpDampedSpringSetSpringForceFunc(spring._constraint, _callback()[0])
    return law


@cache
def _callback() -> tuple[Any, str]:
    """Return the C function pointer and "". If compiled callbacks are not available, return None and the reason."""
    try:
        from pymunk._chipmunk_cffi import ffi

        _check_layout(ffi)
        function = ffi.cast("cpDampedSpringForceFunc", compiled_push().address)
        _check_call(ffi, function)
    except Exception as error:  # A private interface or a compiler may raise any exception.
        return None, f"{type(error).__name__}: {error}"
    return function, ""


def _python_address() -> float:
    """Return the address of pymunk's C function that calls a Python callback.

    The address is returned as a float, which is exact below 2**53.
    """
    from pymunk._chipmunk_cffi import ffi, lib

    return float(int(ffi.cast("intptr_t", ffi.addressof(lib, "ext_cpDampedSpringForceFunc"))))


def _probe(stiffness: float) -> pymunk.DampedSpring:
    return pymunk.DampedSpring(pymunk.Body(1, 1), pymunk.Body(1, 1), (0, 0), (0, 0), 2.0, stiffness, 0.0)


def _check_layout(ffi: Any) -> None:
    """Raise RuntimeError unless the field with the address of the law is the stiffness of the spring.

    The compiled force does not need the stiffness of the spring.
    """
    # Use two unusual values. A wrong field would hardly contain both.
    for stiffness in (1.25e67, -3.5e-41):
        if ffi.cast("double *", _probe(stiffness)._constraint)[LAW_SLOT] != stiffness:
            raise RuntimeError(f"pymunk {pymunk.version} lays its springs out in another way")


def _check_call(ffi: Any, function: Any) -> None:
    # Test the force of a closed contact and of an open contact.
    spring, law = _probe(0.0), ffi.new(LAW_TYPE, [0.5, 3.0, 1.0, 2.0, math.nan, 1.0, _python_address()])
    ffi.cast("double **", spring._constraint)[LAW_SLOT] = law
    if function(spring._constraint, 1.75) != 1.25 or function(spring._constraint, 2.5) != 0.0:
        raise RuntimeError("the compiled callback gives wrong forces")
    # A contact that has just closed, or whose distance is NaN, must call the Python function. All other contacts must
    # not.
    spring.force_func = lambda _, distance: 8.0
    if [function(spring._constraint, distance) for distance in (1.75, 1.75, math.nan)] != [8.0, 1.25, 8.0]:
        raise RuntimeError("the compiled callback does not leave a contact that closes to Python")
    law[4] = 0.5
    if function(spring._constraint, 1.75) != 2.0:
        raise RuntimeError("the compiled callback does not take an overlap")
