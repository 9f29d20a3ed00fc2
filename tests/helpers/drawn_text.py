"""What is written on the window and on films: every text with its place, taken from the one function that writes."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import combinations
from typing import NamedTuple

import pygame
import pytest
from softcradle.sandbox.draw import text
from softcradle.sandbox.draw.palette import luminance
from softcradle.sandbox.draw.scene_picture import Picture
from softcradle.sandbox.motion import Motion
from softcradle.scenes import Scene


class DrawnText(NamedTuple):
    """A text and where it is, whole: parts that the clip of the surface cuts off count too."""

    text: str
    rect: pygame.Rect


@contextmanager
def drawn_texts(size: tuple[int, int]) -> Iterator[list[DrawnText]]:
    """The texts that are written on surfaces of that size while the context is open."""
    found: list[DrawnText] = []
    original = text.write

    def write(surface, words, place, size_of_text, colour=None, *, bold=False, align=(0.0, 0.0)):
        if surface.get_size() == tuple(size) and words:
            wide, high = text.rendered(words, round(size_of_text), (0, 0, 0), bold).get_size()
            left, top = round(place[0] - align[0] * wide), round(place[1] - align[1] * high)
            found.append(DrawnText(words, pygame.Rect(left, top, wide, high)))
        return original(surface, words, place, size_of_text, colour, bold=bold, align=align)

    with pytest.MonkeyPatch.context() as patches:
        for name, module in list(sys.modules.items()):
            if name.startswith("softcradle.") and getattr(module, "write", None) is original:
                patches.setattr(module, "write", write)
        yield found


def colliding(texts: list[DrawnText]) -> list[tuple[str, str]]:
    """Pairs of texts that lie on each other by more than the leading of their lines; numbers of beads move over each other."""
    found = []
    for one, other in combinations(texts, 2):
        common, digits = one.rect.clip(other.rect), one.text.isdigit() and other.text.isdigit()
        if not digits and common.width > 2 and common.height > 0.3 * min(one.rect.height, other.rect.height):
            found.append((one.text, other.text))
    return found


def contrast(one: Sequence[int], other: Sequence[int]) -> float:
    """Ratio of luminances of two colours, as the rules for readable text (WCAG) define it."""
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def film_texts(
    scene: Scene, motions: Sequence[Motion], size: tuple[int, int], rows: Sequence[int]
) -> list[list[DrawnText]]:
    """The texts of the frames of those rows of a film, those of its background first."""
    surface = pygame.Surface(size, 0, 32)
    with drawn_texts(size) as background:
        picture = Picture(scene, motions, size)
    frames = []
    for row in rows:
        with drawn_texts(size) as moving:
            picture.paint(surface, row)
        frames.append([*background, *moving])
    return frames
