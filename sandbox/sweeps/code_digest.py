"""Digests of functions and other values, which show if two versions of a function differ. A digest is the same in every
process.
"""

import copyreg
import hashlib
import inspect
import logging
import uuid
from collections.abc import Iterator
from functools import cached_property, partial
from types import CodeType, FunctionType, MappingProxyType, MethodType, ModuleType
from typing import Any

import numpy as np

LOGGER = logging.getLogger("softcradle")
ATOMS = (type(None), type(...), bool, int, float, complex, str, bytes)
OF_CODE = (
    "co_code", "co_exceptiontable", "co_flags", "co_argcount", "co_posonlyargcount", "co_kwonlyargcount", "co_names",
    "co_varnames", "co_cellvars", "co_freevars", "co_consts",
)  # fmt: skip


def code_digest(value: Any) -> str:
    """Return the digest of a function or of another value.

    The digest of a function depends on its code, its defaults, the values that it closes over or is bound to, and the
    values that it reads from its module. For functions and classes of other modules only their names count.

    A value that cannot be compared, such as a lock or a generator, gets a random digest, and a warning is logged.
    """
    try:
        return _Digest(value).of(value)
    except Exception as error:  # An object may raise any error if it is asked for its parts.
        told = " ".join(f"{type(error).__name__}: {error}".split())
        LOGGER.warning("what is kept of this sweep is not taken up again: it holds what cannot be compared (%s)", told)
        return uuid.uuid4().hex


class _Digest:
    """Digests of `whole` and its parts, computed recursively from the parts of each value."""

    def __init__(self, whole: Any) -> None:
        while isinstance(whole, (partial, MethodType)):
            whole = whole.func if isinstance(whole, partial) else whole.__func__
        whole = inspect.unwrap(whole)
        module = whole.__module__ if isinstance(whole, (FunctionType, type)) else type(whole).__module__
        # Values of this module are inspected. Modules of softcradle are not, because the study contains their version.
        self._home = "" if module.startswith("softcradle.") else module
        # Digests by identity. The value is kept alive, so that no other object can reuse its identity.
        self._known: dict[int, tuple[Any, str]] = {}

    def of(self, value: Any) -> str:
        """Return the digest of a value."""
        if type(value) in ATOMS:
            return f"{type(value).__name__} {value!r}"
        if id(value) not in self._known:
            self._known[id(value)] = value, "itself"  # placeholder for references of the value to itself
            told = repr([type(value).__qualname__, *self._parts(value)])
            self._known[id(value)] = value, hashlib.sha256(told.encode()).hexdigest()[:16]
        return self._known[id(value)][1]

    def _parts(self, value: Any) -> Iterator[str]:
        """Yield texts that distinguish the value from all other values of its type."""
        if isinstance(value, CodeType):
            yield from (self.of(getattr(value, name)) for name in OF_CODE)
        elif isinstance(value, FunctionType):
            yield from map(self.of, (value.__code__, value.__defaults__, value.__kwdefaults__, vars(value)))
            yield from map(self._cell, value.__closure__ or ())
            if value.__module__ == self._home:
                read, known = dict.fromkeys(_names(value.__code__)), value.__globals__
                yield from (self._read(name, known[name]) for name in read if name in known)
        elif isinstance(value, type):
            yield f"{value.__module__}.{value.__qualname__}"
            if value.__module__ == self._home:
                yield from map(self.of, value.__bases__)
                yield from map(self.of, _written(value))
        elif isinstance(value, ModuleType):
            yield value.__name__
        elif type(value) in (tuple, list):
            yield from map(self.of, value)
        elif isinstance(value, (set, frozenset)):
            yield from sorted(map(self.of, value))
        elif type(value) in (dict, MappingProxyType):
            yield from (self.of(part) for item in value.items() for part in item)
        elif (type(value) is np.ndarray or isinstance(value, np.generic)) and not value.dtype.hasobject:
            yield from map(self.of, (value.dtype.str, value.shape, value.tobytes()))
        elif hasattr(value, "__wrapped__"):  # a method of a class, or a compiled or cached function
            yield self.of(value.__wrapped__)
        else:
            yield from self._object(value)

    def _object(self, value: Any) -> Iterator[str]:
        """Yield the digests of the parts from which pickle would rebuild an object, without cached properties."""
        own = copyreg.dispatch_table.get(type(value))
        reduced = own(value) if own else value.__reduce_ex__(4)
        if isinstance(reduced, str):
            yield f"{getattr(value, '__module__', None)}.{reduced}"
            return
        make, arguments, state, items, pairs = (*reduced, None, None, None)[:5]
        if isinstance(state, dict):
            state = {
                name: part
                for name, part in state.items()
                if not isinstance(getattr(type(value), str(name), None), cached_property)
            }
        yield from map(self.of, (make, arguments, state, [*(items or ())], [*(pairs or ())]))

    def _cell(self, cell: Any) -> str:
        try:
            return self.of(cell.cell_contents)
        except ValueError:  # The closure variable has not been assigned yet.
            return "empty"

    def _read(self, name: str, value: Any) -> str:
        """Return the digest of a module value that a function reads. For a function or class of another module it is
        the name.
        """
        foreign = isinstance(value, (FunctionType, type)) and value.__module__ != self._home
        return f"{name} is {value.__module__}.{value.__qualname__}" if foreign else f"{name} is {self.of(value)}"


def _names(code: CodeType) -> Iterator[str]:
    """Yield the names that a function and its inner functions read."""
    yield from code.co_names
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _names(inner)


def _written(kind: type) -> Iterator[Any]:
    """Yield the functions, getters and plain values that are defined in a class."""
    for name, part in vars(kind).items():
        if isinstance(part, property):
            yield part.fget
        elif isinstance(part, (FunctionType, classmethod, staticmethod)) or (type(part) in ATOMS and name[:2] != "__"):
            yield part
