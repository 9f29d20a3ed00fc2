"""Dense solves of the reference on one thread of BLAS: its matrices are small, and threads that wait for each other cost more."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
T = TypeVar("T")


@cache
def _controller() -> ThreadpoolController:
    """What the libraries of this process are known by; looking for them takes milliseconds."""
    return ThreadpoolController()


def on_one_thread(call: Callable[P, T]) -> Callable[P, T]:
    """The function `call`, during which BLAS keeps to one thread."""

    @wraps(call)
    def limited(*arguments: P.args, **options: P.kwargs) -> T:
        with _controller().limit(limits=1, user_api="blas"):
            return call(*arguments, **options)

    return limited
