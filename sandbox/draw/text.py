"""Text on surfaces. There is one font with two weights. Rendered text is cached."""

import re
from bisect import bisect_right
from functools import lru_cache

import pygame
from softcradle.sandbox.draw.palette import Colour, tones
from softcradle.sandbox.draw.surfaces import cached_surfaces
from softcradle.sandbox.files import resource

_FONTS = {False: "Inter-Regular.otf", True: "Inter-SemiBold.otf"}


@lru_cache(maxsize=64)
def font(size: int, bold: bool = False) -> pygame.font.Font:
    """Return the font with a height of `size` pixels."""
    if not pygame.font.get_init():
        pygame.font.init()
    return pygame.font.Font(str(resource(_FONTS[bold])), max(4, size))


@cached_surfaces(6)
def rendered(text: str, size: int, colour: Colour, bold: bool = False) -> pygame.Surface:
    """Return a surface with `text` on a transparent background. The surface is cached: callers must not draw on it."""
    return font(size, bold).render(text, True, colour)


def write(
    surface: pygame.Surface,
    text: str,
    place: tuple[float, float],
    size: float,
    colour: Colour | None = None,
    *,
    bold: bool = False,
    align: tuple[float, float] = (0.0, 0.0),
) -> pygame.Rect:
    """Write one line of text. The default colour is the foreground colour of the theme.

    `align` selects the point of the text that is placed at `place`. (0, 0) is the top left corner. (0.5, 1) is the
    middle of the lower edge.
    """
    image = rendered(text, round(size), tones.foreground if colour is None else colour, bold)
    width, height = image.get_size()
    return surface.blit(image, (round(place[0] - align[0] * width), round(place[1] - align[1] * height)))


def width(text: str, size: float, *, bold: bool = False) -> int:
    """Return the width [pixels] of `text` if :func:`write` writes it."""
    return int(font(round(size), bold).size(text)[0])


def shortened(text: str, size: float, room: float, *, bold: bool = False) -> str:
    """Return `text`. If it is wider than `room` pixels, cut it and append an ellipsis."""
    if width(text, size, bold=bold) <= room:
        return text
    fitting = bisect_right(range(1, len(text) + 1), room, key=lambda n: width(text[:n] + "…", size, bold=bold))
    return text[:fitting].rstrip() + "…"


def paragraphs(text: str, size: float, room: float) -> list[str]:
    """Return the lines of a text. Each line is at most `room` pixels wide. Line breaks in the text are kept."""
    return [line for part in text.split("\n") for line in wrapped(part, size, room)]


def wrapped(text: str, size: float, room: float, *, bold: bool = False) -> list[str]:
    """Return the lines of `text`, broken between words. Each line is at most `room` pixels wide. Lines are not broken
    at non-breaking spaces.
    """
    lines = [""]
    for word in re.split(r"[ \n\t]+", text.strip(" \n\t")):
        longer = f"{lines[-1]} {word}".strip()
        if lines[-1] and width(longer, size, bold=bold) > room:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines
