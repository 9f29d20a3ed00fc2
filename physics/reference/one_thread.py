"""Dense solves of the reference on one thread of BLAS: its matrices are small, and threads that wait for each other cost more."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, wraps
from threading import Lock
from typing import Any, ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
T = TypeVar("T")

_lock = Lock()
_limits: list[Any] = []  # one for each run under way; the number of threads of BLAS is one for the whole process


@cache
def _controller() -> ThreadpoolController:
    """What the libraries of this process are known by; looking for them takes milliseconds."""
    return ThreadpoolController()


@contextmanager
def one_thread() -> Iterator[None]:
    """BLAS keeps to one thread until the last of the runs that began beside each other is over, so that digits are the same."""
    with _lock:
        _limits.append(_limits[0] if _limits else _controller().limit(limits=1, user_api="blas"))
    try:
        yield
    finally:
        with _lock:
            limit = _limits.pop()
            if not _limits:
                limit.restore_original_limits()


def on_one_thread(call: Callable[P, T]) -> Callable[P, T]:
    """The function `call`, during which BLAS keeps to one thread."""

    @wraps(call)
    def limited(*arguments: P.args, **options: P.kwargs) -> T:
        with one_thread():
            return call(*arguments, **options)

    return limited
