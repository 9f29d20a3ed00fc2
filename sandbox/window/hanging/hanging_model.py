"""The two hanging cradles on one clock, with every frame kept: scrubbed, stepped, and played on from an earlier frame."""

from __future__ import annotations

import csv
import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import pymunk
from softcradle.sandbox.output_files import output_file
from softcradle.sandbox.window.hanging.hanging_cradle import (
    BALLS,
    LAWS,
    METHODS,
    Cradle,
    Vector,
    make_cradle,
    start_places,
)

FRAME = 1.0 / 60.0  # s, of the model between two frames that are kept
RATES = (60, 120, 240, 480, 960)  # steps a second; each divides into frames
RATE = 480  # steps a second at first: at a swing's lowest point a pin joint loses energy in proportion to the step
MOST_PULL = 60.0  # N, of the pointer on a ball
LEAST_ENERGY = 1e-9  # J: a cradle with less hangs still
MOST_FRAMES = 18000  # that are kept: five minutes

# Springs at few steps a second gain energy: the page shows how much, and what to take.
warnings.filterwarnings("ignore", "SoftContact with step", RuntimeWarning, re.escape(__name__))


@dataclass(frozen=True)
class Moment:
    """A frame of both cradles: raw states, from which they go on, what is shown, and what has happened up to it.

    Attributes:
        first, greatest: energy of each cradle [J] when the pointer last did work on it, and the greatest since.
        tangled: for each cradle the left one of the first two balls that have passed each other, or None.
    """

    time: float
    states: tuple[tuple[tuple[Vector, Vector], ...], ...]
    places: tuple[tuple[Vector, ...], ...]
    energies: tuple[float, ...]
    stretches: tuple[float, ...]
    first: tuple[float, ...]
    greatest: tuple[float, ...]
    tangled: tuple[int | None, ...]

    def share(self, cradle: int, energy: float) -> float:
        """An energy [J] relative to the first; 1 where there was none."""
        return energy / self.first[cradle] if self.first[cradle] > LEAST_ENERGY else 1.0


class HangingModel:
    """The two cradles.

    Attributes:
        law: name of the soft contacts' law, from LAWS.
        lifted: how many balls are lifted at the start.
        method: what solves the soft contacts, of METHODS.
        rate: steps a second.
        cradles: (soft, rigid).
        frames: every frame, of which number `shown` is on screen.
        dropped: number of frames at the start that are no longer kept.
    """

    def __init__(
        self, law: str = next(iter(LAWS)), lifted: int = 1, method: str = METHODS[0], rate: int = RATE
    ) -> None:
        self.law, self.lifted, self.method, self.rate = law, lifted, method, rate
        self.restart()

    def restart(self) -> None:
        """Lift the balls again."""
        places = start_places(self.lifted)
        self.cradles = make_cradle(LAWS[self.law], places, method=self.method), make_cradle(None, places)
        self.frames: list[Moment] = []
        self.shown = self.dropped = 0
        self._due, self._fresh = 0.0, True  # whether energies are to be compared with those of the next frame
        self._pointer: tuple[pymunk.Space, pymunk.Body, Any] | None = None
        self._keep(0.0)

    def _keep(self, time: float) -> None:
        states = tuple(tuple((_pair(b.position), _pair(b.velocity)) for b in c.balls) for c in self.cradles)
        places = tuple(tuple(cradle.places()) for cradle in self.cradles)
        energies, stretches = (tuple(read(c) for c in self.cradles) for read in (Cradle.energy, Cradle.stretch))
        first = greatest = energies
        tangled = tuple(map(first_tangle, places))
        if self.frames:
            last = self.frames[-1]
            tangled = tuple(now if was is None else was for was, now in zip(last.tangled, tangled, strict=True))
            if not self._fresh and self._pointer is None:
                first, greatest = last.first, tuple(map(max, last.greatest, energies))
        self._fresh = False
        self.frames.append(Moment(time, states, places, energies, stretches, first, greatest, tangled))
        if len(self.frames) > MOST_FRAMES:
            del self.frames[0]
            self.dropped += 1
        self.shown = len(self.frames) - 1

    @property
    def moment(self) -> Moment:
        """The frame that is shown."""
        return self.frames[self.shown]

    @property
    def time(self) -> float:
        """Of the frame that is shown [s]."""
        return self.moment.time

    @property
    def scrubbed(self) -> bool:
        """Whether an earlier frame than the last is shown."""
        return self.shown < len(self.frames) - 1

    def scrub(self, frame: int) -> None:
        """Show a frame."""
        self.shown = min(max(frame, 0), len(self.frames) - 1)

    def step(self, by: int) -> None:
        """Show the frame `by` further on; beyond the last one, go on by a frame."""
        if self.shown + by >= len(self.frames):
            self.advance(FRAME)
        else:
            self.scrub(self.shown + by)

    def _branch(self) -> None:
        """Go on from the frame that is shown: later ones are dropped."""
        if not self.scrubbed:
            return
        del self.frames[self.shown + 1 :]
        self._due = 0.0
        (soft_places, soft_velocities), (places, velocities) = (
            ([place for place, _ in states], [velocity for _, velocity in states]) for states in self.moment.states
        )
        soft = make_cradle(LAWS[self.law], soft_places, soft_velocities, self.method)
        self.cradles = soft, make_cradle(None, places, velocities)

    def advance(self, seconds: float) -> None:
        """Move both by `seconds` of model time, in whole frames; the rest is due next time."""
        self._branch()
        self._due += seconds
        steps = round(self.rate * FRAME)
        while self._due >= FRAME - 1e-12:
            self._due -= FRAME
            for cradle in self.cradles:
                for _ in range(steps):
                    cradle.space.step(FRAME / steps)
            self._keep(self.frames[-1].time + FRAME)

    def with_choice(self, **changed: Any) -> HangingModel:
        """A model that begins anew with another law, number, method or rate."""
        present = {"law": self.law, "lifted": self.lifted, "method": self.method, "rate": self.rate}
        return HangingModel(**{**present, **changed})

    def energy_shares(self, cradle: int, seconds: float) -> list[tuple[float, float]]:
        """(time, share of the energy when the pointer last let go) of the frames in the last `seconds` before the one shown,
        and of those after it, as far as they fit into as many."""
        begin = max(0, self.shown - round(seconds / FRAME))
        part = self.frames[begin : begin + round(seconds / FRAME) + 1]
        return [(one.time, one.share(cradle, one.energies[cradle])) for one in part]

    def hold(self, cradle: int, ball: int, place: Vector) -> None:
        """Pull a ball towards `place` [m] with at most MOST_PULL; the string still holds."""
        self._branch()
        held: Cradle = self.cradles[cradle]
        if self._pointer is None:
            pointer = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
            pointer.position = place
            joint = pymunk.PivotJoint(pointer, held.balls[ball], (0.0, 0.0), (0.0, 0.0))
            joint.max_force, joint.error_bias = MOST_PULL, 0.85**60
            held.space.add(joint)
            self._pointer = held.space, pointer, joint
        self._pointer[1].position = place

    def release(self) -> None:
        """Release the ball; the energies begin anew, for the pointer has done work."""
        if self._pointer is not None:
            space, _, joint = self._pointer
            space.remove(joint)
            self._pointer = None
            self._fresh = True

    def write_csv(self, path: Path) -> None:
        """Write every frame as a table, whole or not at all: time, then centres and energy of each cradle."""
        sides = ("soft", "rigid")
        names = [f"{side}_{axis}{k}" for side in sides for k in range(BALLS) for axis in "xy"]
        with output_file(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["time_s", *(f"{name}_m" for name in names), *(f"{side}_energy_J" for side in sides)])
            for one in self.frames:
                centres = [number for cradle in one.places for centre in cradle for number in centre]
                writer.writerow([*map(repr, (one.time, *centres, *one.energies))])


def first_tangle(places: Sequence[Vector]) -> int | None:
    """The left one of the first two balls of a cradle that are in the wrong order, or None."""
    return next((k for k, (left, right) in enumerate(pairwise(places)) if right[0] < left[0]), None)


def _pair(vector: pymunk.Vec2d) -> Vector:
    return float(vector.x), float(vector.y)
