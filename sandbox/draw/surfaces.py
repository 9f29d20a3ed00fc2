"""Surfaces: a cache of drawn ones, bounded by the memory of their pixels, for zooming makes new sizes all the time; PNG files."""

from collections import OrderedDict
from collections.abc import Callable
from functools import wraps
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar

import pygame

Drawn = TypeVar("Drawn", pygame.Surface, "tuple[pygame.Surface, ...]")

SURFACE_BYTES = 200  # of a surface beside its pixels, about

_clear_functions: list[Callable[[], None]] = []


def cached_surfaces(megabytes: float) -> Callable[[Callable[..., Drawn]], Callable[..., Drawn]]:
    """Decorate a function of hashable arguments: the drawings used last are kept, up to `megabytes` of pixels."""

    def decorate(draw: Callable[..., Drawn]) -> Callable[..., Drawn]:
        cache: OrderedDict[tuple[Any, ...], Drawn] = OrderedDict()
        used = 0

        def clear() -> None:
            nonlocal used
            cache.clear()
            used = 0

        _clear_functions.append(clear)

        @wraps(draw)
        def cached(*arguments: Any) -> Drawn:
            nonlocal used
            if arguments in cache:
                cache.move_to_end(arguments)
                return cache[arguments]
            drawing = cache[arguments] = draw(*arguments)
            used += _memory(drawing)
            while used > megabytes * 2**20 and len(cache) > 1:
                used -= _memory(cache.popitem(last=False)[1])
            return drawing

        return cached

    return decorate


def clear_cached_surfaces() -> None:
    """Empty all caches. A page that is left does so, because the next one seldom needs the same drawings."""
    for clear in _clear_functions:
        clear()


def _memory(drawing: pygame.Surface | tuple[pygame.Surface, ...]) -> int:
    """Bytes of a surface, or of several."""
    if isinstance(drawing, tuple):
        return sum(_memory(surface) for surface in drawing)
    return drawing.get_pitch() * drawing.get_height() + SURFACE_BYTES


def png_bytes(surface: pygame.Surface) -> bytes:
    """The surface as a PNG file."""
    encoded = BytesIO()
    pygame.image.save(surface, encoded, "picture.png")
    return encoded.getvalue()


def write_png(surface: pygame.Surface, path: Path) -> None:
    """Write the surface to `path`. Raises OSError where the disk is full."""
    path.write_bytes(png_bytes(surface))
