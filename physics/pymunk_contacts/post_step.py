"""Tasks and errors that callbacks of a pymunk step leave for its end, where pymunk lets exceptions through."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any
from weakref import WeakKeyDictionary, ref

import pymunk

_pending: WeakKeyDictionary[pymunk.Space, list[Callable[[], None]]] = WeakKeyDictionary()
_spaces: WeakKeyDictionary[pymunk.Constraint, Callable[[], pymunk.Space | None]] = WeakKeyDictionary()


def space_of(constraint: pymunk.Constraint) -> pymunk.Space:
    """The Space that steps `constraint`: that of its bodies, or the last one where they have been removed."""
    space = constraint.a.space or constraint.b.space
    if space is None:
        space = _spaces.get(constraint, lambda: None)()
        assert space is not None, "a constraint was added to a Space, and none of its bodies"
    else:
        _spaces[constraint] = ref(space)
    return space


def call_after_step(constraint: pymunk.Constraint, task: Callable[[], None]) -> None:
    """Call `task` at the end of the step under way."""
    space = space_of(constraint)
    space.add_post_step_callback(_finish, _finish)
    _pending.setdefault(space, []).append(task)


def raise_after_step(constraint: pymunk.Constraint, error: BaseException) -> None:
    """Raise `error` at the end of the step under way: pymunk prints errors in its callbacks and goes on."""

    def fail() -> None:
        raise error

    call_after_step(constraint, fail)


def require_finite(body: pymunk.Body, what: str) -> None:
    """Raise ValueError where what moves `body` is no finite number."""
    for name in ("velocity", "position", "angular_velocity", "angle", "force"):
        value = getattr(body, name)
        if not math.isfinite(value if isinstance(value, float) else sum(value)):
            raise ValueError(f"{what} has the {name} {value}: give it, and its neighbours, finite numbers")


def settled(value: Callable[[Any], object], why: str) -> property:
    """A property of a spring that nobody sets: who tries is told `why`."""

    def refuse(spring: object, given: object) -> None:
        raise AttributeError(why)

    return property(value, refuse, doc=why)


def _finish(space: pymunk.Space, key: object) -> None:
    """Do the pending tasks and raise the first error. After an error pymunk calls this once more, with nothing pending."""
    errors: list[BaseException] = []
    for task in _pending.pop(space, []):
        try:
            task()
        except BaseException as error:  # KeyboardInterrupt too: the other tasks are still done
            errors.append(error)
    if errors:
        if len(errors) > 1:
            errors[0].add_note(f"{len(errors) - 1} more callbacks failed in the same step")
        raise errors[0]
