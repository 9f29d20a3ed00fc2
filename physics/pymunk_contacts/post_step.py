"""Work that a callback of a pymunk step leaves for the end of the step, where pymunk lets exceptions through."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from weakref import WeakKeyDictionary

import pymunk


@dataclass
class _Waiting:
    tasks: list[Callable[[], None]] = field(default_factory=list)
    errors: list[BaseException] = field(default_factory=list)


_waiting: WeakKeyDictionary[pymunk.Space, _Waiting] = WeakKeyDictionary()


def call_after_step(constraint: pymunk.Constraint, task: Callable[[], None]) -> None:
    """Let the step under way call `task` at its end."""
    _of(constraint).tasks.append(task)


def raise_after_step(constraint: pymunk.Constraint, error: BaseException) -> None:
    """Let the step under way end by raising `error`: pymunk prints and swallows what its callbacks raise."""
    _of(constraint).errors.append(error)


def _of(constraint: pymunk.Constraint) -> _Waiting:
    space = constraint.a.space or constraint.b.space
    assert space is not None
    space.add_post_step_callback(_finish, _finish)
    return _waiting.setdefault(space, _Waiting())


def _finish(space: pymunk.Space, key: object) -> None:
    """Do what waits and raise the first error. After an error pymunk calls this once more, with nothing waiting."""
    waiting = _waiting.pop(space, _Waiting())
    for task in waiting.tasks:
        try:
            task()
        except Exception as error:  # what failed in the step itself comes first
            waiting.errors.append(error)
    if waiting.errors:
        if len(waiting.errors) > 1:
            waiting.errors[0].add_note(f"{len(waiting.errors) - 1} more callbacks failed in the same step")
        raise waiting.errors[0]
