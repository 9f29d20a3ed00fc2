"""Tasks and errors that callbacks of a pymunk step postpone to the end of the step.

At the end of the step, pymunk passes exceptions on. In callbacks during the step, it only prints them.
"""

from __future__ import annotations

import gc
import math
from collections.abc import Callable
from typing import Any
from weakref import WeakKeyDictionary, ref

import pymunk

_pending: WeakKeyDictionary[pymunk.Space, list[Callable[[], None]]] = WeakKeyDictionary()
_spaces: WeakKeyDictionary[pymunk.Constraint, Callable[[], pymunk.Space | None]] = WeakKeyDictionary()


def space_of(constraint: pymunk.Constraint) -> pymunk.Space:
    """Return the Space that steps `constraint`. Its bodies may have been removed from the Space or may never have been
    added.
    """
    space = constraint.a.space or constraint.b.space
    if space is None:
        space = _spaces.get(constraint, lambda: None)()
    # pymunk does not store the Space in its constraints. This search is slow, but it is only used for an error message.
    if space is None:
        spaces = (found for found in gc.get_objects() if isinstance(found, pymunk.Space))
        space = next(found for found in spaces if constraint in found.constraints)
    _spaces[constraint] = ref(space)
    return space


def call_after_step(constraint: pymunk.Constraint, task: Callable[[], None]) -> None:
    """Call `task` at the end of the current step."""
    space = space_of(constraint)
    space.add_post_step_callback(_finish, _finish)
    _pending.setdefault(space, []).append(task)


def raise_after_step(constraint: pymunk.Constraint, error: BaseException) -> None:
    """Raise `error` at the end of the current step, because pymunk only prints errors in its callbacks and continues."""

    def fail() -> None:
        raise error

    call_after_step(constraint, fail)


def require_finite(body: pymunk.Body, what: str) -> None:
    """Raise ValueError if the position, velocity or force of `body` is not finite."""
    for name in ("velocity", "position", "angular_velocity", "angle", "force"):
        value = getattr(body, name)
        if not math.isfinite(value if isinstance(value, float) else sum(value)):
            raise ValueError(f"{what} has the {name} {value}: give it, and its neighbours, finite numbers")


def settled(value: Callable[[Any], object], why: str) -> property:
    """Return a read-only property of a spring.

    Setting the property raises an AttributeError with the text `why`.
    """

    def refuse(spring: object, given: object) -> None:
        raise AttributeError(why)

    return property(value, refuse, doc=why)


def _finish(space: pymunk.Space, key: object) -> None:
    """Do the pending tasks and raise the first error.

    After an error, pymunk calls this function again. There are then no pending tasks.
    """
    errors: list[BaseException] = []
    for task in _pending.pop(space, []):
        try:
            task()
        except BaseException as error:  # This includes KeyboardInterrupt. The other tasks are still done.
            errors.append(error)
    if errors:
        if len(errors) > 1:
            errors[0].add_note(f"{len(errors) - 1} more callbacks failed in the same step")
        raise errors[0]
