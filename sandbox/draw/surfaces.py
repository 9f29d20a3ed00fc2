"""Cache of drawn surfaces, and conversion of surfaces into PNG files.

The cache is limited by the memory of its pixels. A limit on the number of surfaces would not suffice, because zooming
creates surfaces of many sizes.
"""

from collections import OrderedDict
from collections.abc import Callable
from functools import wraps
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar

import pygame

Drawn = TypeVar("Drawn", pygame.Surface, "tuple[pygame.Surface, ...]")

SURFACE_BYTES = 200  # Approximate memory of a surface object, excluding its pixels [bytes].

_clear_functions: list[Callable[[], None]] = []


def cached_surfaces(megabytes: float) -> Callable[[Callable[..., Drawn]], Callable[..., Drawn]]:
    """Return a decorator that caches the drawings that a function returns. The arguments of the function must be
    hashable.

    The cache keeps the most recently used drawings. The pixels of these drawings occupy at most `megabytes`.
    """

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
    """Empty all caches of surfaces. The window calls this function when the user leaves a page, because the next page
    seldom needs the same drawings.
    """
    for clear in _clear_functions:
        clear()


def _memory(drawing: pygame.Surface | tuple[pygame.Surface, ...]) -> int:
    """Return the memory [bytes] of one surface or of several surfaces."""
    if isinstance(drawing, tuple):
        return sum(_memory(surface) for surface in drawing)
    return drawing.get_pitch() * drawing.get_height() + SURFACE_BYTES


def png_bytes(surface: pygame.Surface) -> bytes:
    """Return the surface as the content of a PNG file."""
    encoded = BytesIO()
    pygame.image.save(surface, encoded, "picture.png")
    return encoded.getvalue()


def write_png(surface: pygame.Surface, path: Path) -> None:
    """Write the surface to the PNG file `path`. Raise OSError if the disk is full."""
    path.write_bytes(png_bytes(surface))
