"""Laws of one's own as functions that kernels call: machine code where numba can compile them, else calls of Python.

All laws of a chain become one function of (number of the law, overlap), known to kernels by its address alone. What Python
raises in a call is kept, and raised when the kernel has come back; until then the force counts as nan.

The energy in steps is the integral of the force, exact to round-off at any overlap: a closed form such as ``expm1(d) - d``
loses its digits where d is small, and the solver of the steps would not converge there.
"""

from __future__ import annotations

import ctypes
import dis
import math
import warnings
from collections import namedtuple
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from numbers import Real
from typing import Any

from softcradle.physics.numerics.own_contacts import LawFunction
from softcradle.physics.own_law import OwnLaw
from softcradle.physics.own_law_energy import energy_function

KEPT = 64  # combinations of laws whose functions are kept
PROBE = 0.5  # an overlap, to see whether a function compiles; its value is not used

try:
    import numba
    from numba.core.types import WrapperAddressProtocol
except ImportError:
    COMPILES = False
else:
    COMPILES = not numba.config.DISABLE_JIT


@dataclass(frozen=True)
class LawFunctions:
    """Force and energy of several laws by their number, for kernels.

    Attributes:
        force, energy: the functions.
        compiled: whether they are machine code.
        raised: what Python has raised in a call; the first exception counts.
    """

    force: LawFunction
    energy: LawFunction
    compiled: bool
    raised: list[BaseException] = field(default_factory=list)

    def raise_again(self) -> None:
        """Raise what a call has raised, if any has."""
        if self.raised:
            first = self.raised[0]
            self.raised.clear()
            raise first


@lru_cache(maxsize=KEPT)
def functions_of(laws: tuple[OwnLaw, ...]) -> LawFunctions:
    """The functions of `laws`, made once for each combination of laws."""
    forces = [_plain(law.force_of) for law in laws]
    energies = [energy_function(force, law.stored) for force, law in zip(forces, laws, strict=True)]
    if not COMPILES:
        return LawFunctions(_chosen(forces), _chosen(energies), False)
    machine = [_compiled(law.force_of) for law in laws]
    if all(force is not None for force in machine):
        pairs = zip(machine, laws, strict=True)
        integrals = [numba.njit(error_model="numpy")(energy_function(force, law.stored)) for force, law in pairs]
        return LawFunctions(_pointer(machine), _pointer(integrals), True)
    raised: list[BaseException] = []
    return LawFunctions(_callback(_chosen(forces), raised), _callback(_chosen(energies), raised), False, raised)


def _plain(function: Callable[[Any], Any]) -> Callable[[float], float]:
    """A function of a number as Python calls it; nan where arithmetic has no number for it, as in machine code."""

    def called(overlap: float) -> float:
        try:
            return float(function(overlap))
        except ArithmeticError:
            return math.nan

    return called


def _chosen(functions: Sequence[Callable[[float], float]]) -> LawFunction:
    return lambda number, overlap: functions[number](overlap)


def _compiled(function: Callable[[Any], Any]) -> Any:
    """`function` as a numba function from a number to a float; None where numba cannot, or where it may raise."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            inner = _without_self(function)
            made = numba.njit(error_model="numpy")(lambda overlap: float(inner(overlap)))
            made(PROBE)
    except Exception:  # whatever numba or the function itself has against it
        return None
    return made


def _without_self(function: Any) -> Any:
    """A numba function; a bound method gets, in place of its object, a record of the object's numbers."""
    plain = getattr(function, "py_func", function)
    owner = getattr(plain, "__self__", None)
    if owner is None:
        return numba.njit(error_model="numpy")(_without_raise(plain))
    values = _numbers_of(owner)
    record: Any = namedtuple(type(owner).__name__, values)(**values)
    method = numba.njit(error_model="numpy")(_without_raise(plain.__func__))
    return numba.njit(error_model="numpy")(lambda overlap: method(record, overlap))


def _without_raise(function: Any) -> Any:
    """`function`, if it raises nothing itself: machine code has nobody to raise it to."""
    if any(instruction.opname == "RAISE_VARARGS" for instruction in dis.get_instructions(function)):
        raise TypeError("a law that raises exceptions is called as Python")
    return function


def _numbers_of(owner: object) -> dict[str, float]:
    """The attributes of an object that are numbers, those of its class included, private ones left out."""
    names = [name for name in dir(owner) if not name.startswith("_")]
    found = {name: getattr(owner, name) for name in names}
    return {name: float(value) for name, value in found.items() if isinstance(value, Real)}


def _pointer(functions: Sequence[Any]) -> LawFunction:
    """One C function of (number, overlap) that calls the numba function with this number."""
    chosen = _either(functions[-1], len(functions) - 1, None)
    for number in range(len(functions) - 2, -1, -1):
        chosen = _either(functions[number], number, chosen)
    code = numba.cfunc("float64(int64, float64)", error_model="numpy")(chosen.py_func)
    return _Addressed(code.address, chosen, code)


def _either(function: Any, number: int, rest: Any) -> Any:
    """The function of (number, overlap) that is `function` for this number and `rest` for others."""
    if rest is None:
        return numba.njit(error_model="numpy")(lambda wanted, overlap: function(overlap))
    return numba.njit(error_model="numpy")(
        lambda wanted, overlap: function(overlap) if wanted == number else rest(wanted, overlap)
    )


def _callback(function: LawFunction, raised: list[BaseException]) -> LawFunction:
    """A C function that calls Python."""

    def called(number: int, overlap: float) -> float:
        try:
            return function(number, overlap)
        except BaseException as error:  # KeyboardInterrupt too: C has nobody to raise it to
            raised.append(error)
            return math.nan

    code = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_int64, ctypes.c_double)(called)
    return _Addressed(ctypes.cast(code, ctypes.c_void_p).value or 0, called, code)


if COMPILES:

    class _Addressed(WrapperAddressProtocol):  # numba has no types
        """A function that kernels call by address; Python can call it too. It keeps alive what is at the address."""

        def __init__(self, address: int, function: LawFunction, code: object) -> None:
            self.address, self.function, self.code = address, function, code

        def __call__(self, number: int, overlap: float) -> float:
            return self.function(number, overlap)

        def __wrapper_address__(self) -> int:
            return self.address

        def signature(self) -> Any:
            return numba.float64(numba.int64, numba.float64)
