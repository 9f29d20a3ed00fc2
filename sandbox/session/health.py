"""Health: the numbers of the badge, and the sentence that says when a method is past its limit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from softcradle.physics.methods import find_method
from softcradle.sandbox.session import ledger
from softcradle.sandbox.session.frame_pacing import Pace
from softcradle.sandbox.session.history import SWITCHES
from softcradle.sandbox.session.history_slices import Series
from softcradle.sandbox.session.lane_setup import LaneSetup
from softcradle.sandbox.session.method_choice import contact_time

GOOD, FAIR, BAD = "good", "fair", "bad"
LEVELS = (GOOD, FAIR, BAD)
HOLDS, FAILS = 1e-3, 1e-2  # relative errors: half a pixel of a plot, and what an eye sees in the motion
CHATTERS = 1.0  # switches per plausible switch
FINE, COARSE = (
    8.0,
    2.0,
)  # steps to the shortest contact: below the one velocities suffer, below the other they are chance
ON_TIME = 0.9  # clock ratio
WINDOW = 120  # frames over which chatter is counted: one second at the wall


@dataclass(frozen=True)
class Health:
    """How far a lane can be trusted now.

    Attributes:
        energy_error: energy that nothing explains, relative to the largest there has been; hands, drives, walls and
            edits are booked apart. None where walls move differently: what they do is not known.
        momentum_error: likewise; None where a wall or a bed takes up momentum.
        chatter: contact switches over the last second at the wall, relative to the most that is plausible; above 1 a
            method only seems to hold contacts closed.
        steps_a_contact: steps to the shortest contact at the scene's speed; inf where the method chooses its steps.
        milliseconds: wall time of physics a frame, all lanes together.
        level: 'good', 'fair' or 'bad'.
        sentence: why, and what to do about it.
    """

    energy_error: float | None
    momentum_error: float | None
    chatter: float
    steps_a_contact: float
    milliseconds: float
    level: str
    sentence: str


def health_of(series: Series, setup: LaneSetup, frame_time: float, pace: Pace, trouble: str = "") -> Health:
    """The health of a lane at the end of `series`, its last :data:`WINDOW` frames; `trouble` is what its method could not
    do of late."""
    chain = setup.chain
    books = series.ledger[-1]
    walls = series.velocity[-1][np.isinf(chain.mass)]
    unknown = walls.size and (np.ptp(walls) > 0.0 or (chain.friction and walls.any()))
    energy = None if unknown else float(ledger.energy_error(books))
    momentum = None if walls.size or chain.friction else float(ledger.momentum_error(books))
    step = setup.step_for(frame_time)
    steps = contact_time(chain, setup.speed) / step if step else math.inf
    chatter = _chatter(series, setup)
    level, sentence = _verdict(setup, (energy or 0.0, momentum or 0.0), chatter, steps)
    if trouble and level != BAD:
        level, sentence = BAD, trouble
    if level == GOOD and pace.clock_ratio < ON_TIME:
        level, sentence = FAIR, f"{_share(pace.clock_ratio)} of the speed asked for: a frame takes too long"
    return Health(energy, momentum, chatter, steps, pace.milliseconds, level, sentence)


def _chatter(series: Series, setup: LaneSetup) -> float:
    """Switches over the most that is plausible: every contact closes and opens, and again in every contact time."""
    switches = float(series.ledger[-1, SWITCHES] - series.ledger[0, SWITCHES])
    elapsed = float(series.time[-1] - series.time[0])
    most = 2.0 * setup.chain.contacts * (1.0 + elapsed / contact_time(setup.chain, setup.speed))
    return max(0.0, switches) / most


def _verdict(setup: LaneSetup, errors: tuple[float, float], chatter: float, steps: float) -> tuple[str, str]:
    """Level and sentence of the gravest that holds."""
    method = setup.method
    worst, name = max(zip(errors, ("energy", "momentum"), strict=True))
    remedy = "take a smaller step or more slow motion" if setup.step_given else "take more slow motion"
    findings = (
        (not math.isfinite(sum(errors)), BAD, f"{method} has blown up: restart, and take conserving or a smaller step"),
        (worst > FAILS, BAD, f"{method} is off by {_share(worst)} of the {name}: take conserving or a smaller step"),
        (chatter > CHATTERS, FAIR if find_method(method).set_valued else BAD, _about_chatter(method, chatter)),
        (steps < COARSE, BAD, f"{steps:.1g} steps to a whole contact: what comes out is chance; {remedy}"),
        (worst > HOLDS, FAIR, f"{method} is off by {_share(worst)} of the {name}"),
        (steps < FINE, FAIR, f"only {steps:.0f} steps to the shortest contact: velocities are rough; {remedy}"),
    )
    return next(((level, said) for holds, level, said in findings if holds), (GOOD, f"{method} holds its errors"))


def _about_chatter(method: str, chatter: float) -> str:
    if find_method(method).set_valued:
        return f"contacts bounce {chatter:.0f} times faster than steps resolve: single beads may be off; take more slow motion"
    rests = f"contacts that should rest open and close {chatter:.0f} times faster than beads can"
    return f"{rests}: {method} is past its limit; take conserving"


def _share(value: float) -> str:
    return f"{100.0 * value:.2g} %"
