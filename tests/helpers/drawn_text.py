"""Record every text that the window and films draw, and the place of the text. The function that draws all texts is
patched for this purpose.
"""

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
    """A text and its rectangle, including parts outside the clipping area of the surface."""

    text: str
    rect: pygame.Rect


@contextmanager
def drawn_texts(size: tuple[int, int]) -> Iterator[list[DrawnText]]:
    """Yield a list that collects the texts drawn on surfaces of this size [pixels] while the context is open."""
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
    """Return the pairs of texts that overlap by more than the space between lines. Pairs of bead numbers are left out,
    because moving beads can overlap.
    """
    found = []
    for one, other in combinations(texts, 2):
        common, digits = one.rect.clip(other.rect), one.text.isdigit() and other.text.isdigit()
        if not digits and common.width > 2 and common.height > 0.3 * min(one.rect.height, other.rect.height):
            found.append((one.text, other.text))
    return found


def contrast(one: Sequence[int], other: Sequence[int]) -> float:
    """Return the contrast ratio of two colours, as defined by the Web Content Accessibility Guidelines (WCAG)."""
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def film_texts(
    scene: Scene, motions: Sequence[Motion], size: tuple[int, int], rows: Sequence[int]
) -> list[list[DrawnText]]:
    """Return the texts in the film frames of the samples `rows`. In each list, the texts of the background come first."""
    surface = pygame.Surface(size, 0, 32)
    with drawn_texts(size) as background:
        picture = Picture(scene, motions, size)
    frames = []
    for row in rows:
        with drawn_texts(size) as moving:
            picture.paint(surface, row)
        frames.append([*background, *moving])
    return frames
