"""`cached_surfaces`: a cache of drawings that is bounded by the memory they take; zooming makes new sizes all the time."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

import pygame

Drawn = TypeVar("Drawn", pygame.Surface, "tuple[pygame.Surface, ...]")

_forgetting: list[Callable[[], None]] = []
OBJECT = 200  # bytes of a surface beside its pixels, about


def cached_surfaces(megabytes: float) -> Callable[[Callable[..., Drawn]], Callable[..., Drawn]]:
    """Decorate a function of hashable arguments: what it drew last stays, up to `megabytes` of pixels."""

    def decorate(draw: Callable[..., Drawn]) -> Callable[..., Drawn]:
        found: OrderedDict[tuple[Any, ...], Drawn] = OrderedDict()
        used = 0

        def forget_these() -> None:
            nonlocal used
            found.clear()
            used = 0

        _forgetting.append(forget_these)

        @wraps(draw)
        def drawn(*arguments: Any) -> Drawn:
            nonlocal used
            if arguments in found:
                found.move_to_end(arguments)
                return found[arguments]
            picture = found[arguments] = draw(*arguments)
            used += _memory(picture)
            while used > megabytes * 2**20 and len(found) > 1:
                used -= _memory(found.popitem(last=False)[1])
            return picture

        return drawn

    return decorate


def clear_cached_surfaces() -> None:
    """Let go of every drawing that is kept: those of a page that was left are hardly those of the next."""
    for forget_these in _forgetting:
        forget_these()


def _memory(picture: pygame.Surface | tuple[pygame.Surface, ...]) -> int:
    if isinstance(picture, tuple):
        return sum(_memory(one) for one in picture)
    return picture.get_pitch() * picture.get_height() + OBJECT
