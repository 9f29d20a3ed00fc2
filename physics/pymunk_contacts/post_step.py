"""Tasks and errors that callbacks of a pymunk step leave for its end, where pymunk lets exceptions through."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from weakref import WeakKeyDictionary, ref

import pymunk


@dataclass
class _Pending:
    tasks: list[Callable[[], None]] = field(default_factory=list)
    errors: list[BaseException] = field(default_factory=list)


_pending: WeakKeyDictionary[pymunk.Space, _Pending] = WeakKeyDictionary()
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
    _of(constraint).tasks.append(task)


def raise_after_step(constraint: pymunk.Constraint, error: BaseException) -> None:
    """Raise `error` at the end of the step under way: pymunk prints errors in its callbacks and goes on."""
    _of(constraint).errors.append(error)


def require_finite(body: pymunk.Body, what: str) -> None:
    """Raise ValueError where what moves `body` is no finite number."""
    for name in ("velocity", "position", "angular_velocity", "angle", "force"):
        value = getattr(body, name)
        if not math.isfinite(value if isinstance(value, float) else sum(value)):
            raise ValueError(f"{what} has the {name} {value}: give it, and its neighbours, finite numbers")


def _of(constraint: pymunk.Constraint) -> _Pending:
    space = space_of(constraint)
    space.add_post_step_callback(_finish, _finish)
    return _pending.setdefault(space, _Pending())


def _finish(space: pymunk.Space, key: object) -> None:
    """Do the pending tasks and raise the first error. After an error pymunk calls this once more, with nothing pending."""
    pending = _pending.pop(space, _Pending())
    for task in pending.tasks:
        try:
            task()
        except Exception as error:  # errors of the step itself are before those of its tasks
            pending.errors.append(error)
    if pending.errors:
        if len(pending.errors) > 1:
            pending.errors[0].add_note(f"{len(pending.errors) - 1} more callbacks failed in the same step")
        raise pending.errors[0]
