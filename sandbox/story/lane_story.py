"""Description of the motion of one lane until a chosen moment. The description contains the first hit, the number of
closed contacts, the last opening of a contact, and the outcome.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from softcradle.sandbox.motion import Motion
from softcradle.sandbox.story.bodies import body_word
from softcradle.sandbox.story.outcome import Outcome, outcome_of

if TYPE_CHECKING:
    from softcradle.physics import Trajectory

# Smallest speed of a hit, as a fraction of the closing speed. If a contact closes more slowly, its beads only begin to
# push.
LEAST_HIT = 0.01


@dataclass(frozen=True)
class Hit:
    """First hit between two beads.

    The attributes are the time [s], the speed [m/s] with which the two beads approached each other, and the number of
    the left bead. `walls` contains True for each of the two beads that is a wall.
    """

    time: float
    speed: float
    contact: int
    walls: tuple[bool, bool] = (False, False)


@dataclass(frozen=True)
class LaneStory:
    """Description of the motion of one lane until a chosen moment.

    Attributes:
        time: the moment [s] at which the description ends.
        contacts: number of contacts.
        closed: number of contacts that are closed at that moment.
        opened: time [s] at which the last contact opened; None if no contact has opened.
        hit: the first hit, or None.
        outcome: the groups of beads.
        stopped: True if friction of the bed has stopped all beads after the outcome.
        body: word for the bodies, a key of :data:`softcradle.sandbox.story.bodies.BODIES`.
    """

    time: float
    contacts: int
    closed: int
    opened: float | None
    hit: Hit | None
    outcome: Outcome
    stopped: bool = False
    body: str = "bead"


def first_hit(closings: Iterable[tuple[float, float, int]], mass: Sequence[float], speed: float) -> Hit | None:
    """Return the first hit among the closings of contacts. Return None if all contacts closed without a hit.

    If a contact was closed slowly by pressing or pulling, it is not a hit. If several hits happen at the same time, the
    fastest one is returned.

    Arguments:
        closings: for each closing, its time [s], the speed of approach before it [m/s], and the number of the contact.
        mass: (n+1,) masses [kg].
        speed: the closing speed at the start [m/s].
    """
    hits = [(time, -approach, contact) for time, approach, contact in closings if approach > LEAST_HIT * speed]
    if not hits:
        return None
    time, approach, contact = min(hits)
    return Hit(time, -approach, contact, (math.isinf(mass[contact]), math.isinf(mass[contact + 1])))


def story_of(trajectory: Trajectory) -> LaneStory:
    """Return the description of a complete trajectory."""
    start, end = trajectory.velocity[0], trajectory.final_velocity
    spans = [(span[0][0], k) for k, span in enumerate(trajectory.contact_intervals) if span]
    openings = [span[-1][1] for span in trajectory.contact_intervals if span]
    closings = [(time, _approach(trajectory, k, time), k) for time, k in spans]
    speed = float(start.max() - start.min()) or float(abs(end).max())
    return LaneStory(
        time=float(trajectory.time[-1]),
        contacts=trajectory.chain.contacts,
        closed=sum(map(math.isinf, openings)),
        opened=max((time for time in openings if math.isfinite(time)), default=None),
        hit=first_hit(closings, trajectory.chain.mass, speed),
        outcome=outcome_of(trajectory.chain.mass, start.tolist(), end.tolist()),
        body=body_word(trajectory.chain),
    )


def motion_outcome(motion: Motion, lasts: bool) -> Outcome:
    """Return the outcome of a motion that is drawn.

    On a friction bed, beads continue to slow down after they have separated. The outcome of these beads therefore uses
    the velocities at the moment of separation. If the scene has a duration (`lasts`), it uses the final velocities.
    """
    row = len(motion.time) - 1
    if motion.chain.on_bed and not lasts:
        pushed = np.flatnonzero((motion.force != 0.0).any(axis=1))
        row = min(row, int(pushed[-1]) + 1) if pushed.size else row
    return outcome_of(motion.chain.mass, motion.velocity[0].tolist(), motion.velocity[row].tolist())


def _approach(trajectory: Trajectory, contact: int, time: float) -> float:
    """Return the speed [m/s] with which the two beads of a contact approached each other before `time` [s]."""
    row = max(int((trajectory.time <= time).sum()) - 1, 0)
    return float(trajectory.rate[row, contact])
