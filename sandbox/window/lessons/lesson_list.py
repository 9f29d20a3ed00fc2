"""The list of lessons: questions from a file, and the measures that find the right choice in a motion."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from softcradle.sandbox.motion import Array

FILE = Path(__file__).parent / "lessons.toml"
FAST = 0.5  # of the fastest target: a bead that is as fast leaves with it
STILL = 0.05  # of the striker's speed: a slower bead stands still
TOGETHER = 0.1  # of their mean speed: the largest spread of targets that leave together


@dataclass(frozen=True)
class Lesson:
    """A question about a scene.

    Attributes:
        scene: name of the scene.
        question, choices: what is asked.
        measure: name of what finds the right choice, in MEASURES.
        why: the reason of each choice, in a sentence.
    """

    scene: str
    question: str
    choices: tuple[str, ...]
    measure: str
    why: tuple[str, ...]

    def answer(self, velocities: Sequence[tuple[Array, Array]]) -> int:
        """Number of the right choice, from the velocities (n+1,) of each lane at its start and end."""
        return MEASURES[self.measure](velocities)


@lru_cache(maxsize=1)
def lessons() -> tuple[Lesson, ...]:
    """All lessons, in order."""
    tables = tomllib.loads(FILE.read_text(encoding="utf-8"))["lesson"]
    return tuple(Lesson(**{**table, **{key: tuple(table[key]) for key in ("choices", "why")}}) for table in tables)


def _leaving(velocities: Sequence[tuple[Array, Array]]) -> int:
    """0: one target is fast; 1: more than half of them are; 2: fewer are."""
    _, end = velocities[0]
    fast = int((end[1:] > FAST * end.max()).sum())
    return 0 if fast == 1 else (1 if 2 * fast > len(end) - 1 else 2)


def _striker(velocities: Sequence[tuple[Array, Array]]) -> int:
    """0: the first bead stands still; 1: it bounces back; 2: it goes on."""
    start, end = velocities[0]
    if abs(end[0]) < STILL * abs(start[0]):
        return 0
    return 1 if end[0] * start[0] < 0.0 else 2


def _together(velocities: Sequence[tuple[Array, Array]]) -> int:
    """0 or 1: the lane in which targets leave together; 2: both."""
    apart = [float(np.ptp(end[1:])) > TOGETHER * float(abs(end[1:]).mean()) for _, end in velocities]
    return 2 if not any(apart) else apart.index(False)


MEASURES: dict[str, Callable[[Sequence[tuple[Array, Array]]], int]] = {
    "leaving": _leaving,
    "striker": _striker,
    "together": _together,
}
