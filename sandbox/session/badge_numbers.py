"""Health: the numbers of a lane's badge, and the sentence that says when its method is past its limit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile

import numpy as np
from softcradle.physics.methods import find_method
from softcradle.sandbox.languages import N_, _, localized
from softcradle.sandbox.session.frame_pacing import FramePacer
from softcradle.sandbox.session.history_slices import HistorySlice
from softcradle.sandbox.session.lane_setup import LaneSetup
from softcradle.sandbox.session.ledger import SWITCHES, energy_error, momentum_error
from softcradle.sandbox.session.live_method import contact_time

GOOD, FAIR, BAD = "good", "fair", "bad"
LEVELS = (GOOD, FAIR, BAD)
FAIR_ERROR = 1e-3  # relative, the largest that is good: half a pixel of a plot
BAD_ERROR = 1e-2  # relative, the largest that is fair: beyond it an eye sees it in the motion
FAIR_VELOCITY = 1e-2  # of the closing speed, the largest velocity error that is good
BAD_VELOCITY = 0.1  # of the closing speed, the largest that is fair
MOST_CHATTER = 1.0  # switches per plausible switch
FINE_STEPS = 8.0  # to the shortest contact: with fewer, velocities lose digits
COARSE_STEPS = 2.0  # to the shortest contact: with fewer, velocities are arbitrary
ON_TIME = 0.9  # least clock ratio that is good
WINDOW = 120  # frames over which chatter is counted: one second of wall time
BOUNCING = N_(
    "contacts bounce {times:.0f} times faster than steps resolve: single beads may be off; take more slow motion"
)
CHATTERING = N_(
    "contacts that should rest open and close {times:.0f} times faster than beads can: "
    "{method} is past its limit; take conserving"
)


@dataclass(frozen=True)
class Health:
    """How far a lane can be trusted now.

    Attributes:
        energy_error: energy that nothing explains, relative to the largest so far; pointer, drives, walls and edits are
            booked apart. None where walls move differently: their work is not known.
        momentum_error: likewise; None where a wall or a bed takes momentum.
        chatter: contact switches over the last second of wall time, relative to the most that is plausible; above 1 a
            method only seems to hold contacts closed.
        steps_a_contact: steps to the shortest contact at the scene's speed; inf for adaptive methods.
        velocity_error: of an accurate run behind, relative to the closing speed; None where it is not known.
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
    velocity_error: float | None = None


def health_of(
    slices: Sequence[HistorySlice],
    setup: LaneSetup,
    frame_time: float,
    pacer: FramePacer,
    warning: str = "",
    length: float = math.inf,
    velocity_error: float | None = None,
) -> Health:
    """The health of a lane at the end of `slices`, its last :data:`WINDOW` frames.

    `warning` is that of its method; `length` [m] that of a bead: a deeper overlap means that it has passed its neighbour;
    `velocity_error` that of an accurate run behind, where it is known.
    """
    chain = setup.chain
    ledger, walls = slices[-1].ledger[-1], slices[-1].velocity[-1][np.isinf(chain.mass)]
    unknown = walls.size and (np.ptp(walls) > 0.0 or (chain.on_bed and walls.any()))
    energy = None if unknown else float(energy_error(ledger))
    momentum = None if walls.size or chain.on_bed else float(momentum_error(ledger))
    step = setup.step_for(frame_time)
    steps = contact_time(chain, setup.speed) / step if step else math.inf
    chatter = _chatter(slices, setup)
    level, sentence = _verdict(setup, (energy or 0.0, momentum or 0.0), chatter, steps)
    passed = np.flatnonzero(slices[-1].overlap[-1] > length)
    if passed.size and level != BAD:
        bead = int(passed[0])
        text = _(
            "beads {left} and {right} have passed through each other: the contact is too weak for this speed",
            left=bead,
            right=bead + 1,
        )
        level, sentence = BAD, text
    if warning and level != BAD:
        level, sentence = BAD, warning
    if level == GOOD and velocity_error is not None and velocity_error > FAIR_VELOCITY:
        level = BAD if velocity_error > BAD_VELOCITY else FAIR
        text = N_("velocities are off by {error} of the closing speed: take more slow motion")
        sentence = _(text, error=_percent(velocity_error))
    if level == GOOD and pacer.clock_ratio < ON_TIME:
        level = FAIR
        sentence = _("{share} of the set speed: a frame takes too long", share=_percent(pacer.clock_ratio))
    return Health(energy, momentum, chatter, steps, pacer.milliseconds, level, sentence, velocity_error)


def _chatter(slices: Sequence[HistorySlice], setup: LaneSetup) -> float:
    """Switches over the most that is plausible: every contact closes and opens, and again in every contact time."""
    contacts, last = setup.chain.contacts, slices[-1]
    *_, first = takewhile(lambda part: part.chain.contacts == contacts, reversed(slices))
    switches = float(last.ledger[-1, SWITCHES] - first.ledger[0, SWITCHES])
    elapsed = float(last.time[-1] - first.time[0])
    most = 2.0 * contacts * (1.0 + elapsed / contact_time(setup.chain, setup.speed))
    return max(0.0, switches) / most


def _verdict(setup: LaneSetup, errors: tuple[float, float], chatter: float, steps: float) -> tuple[str, str]:
    """Level and sentence of the gravest finding."""
    method = setup.method
    worst, name = max(zip(errors, ("energy", "momentum"), strict=True))
    remedy = setup.finer
    values = {"method": method, "error": _percent(worst), "remedy": setup.remedy}
    off, off_badly = _off(name)
    findings = (
        (
            not math.isfinite(sum(errors)),
            BAD,
            _("{method} has blown up: restart, and {remedy}", method=method, remedy=setup.remedy),
        ),
        (
            worst > BAD_ERROR,
            BAD,
            _(off_badly, **values),
        ),
        (chatter > MOST_CHATTER, *_chattering(method, chatter)),
        (
            steps < COARSE_STEPS,
            BAD,
            _("{steps:.1g} steps to a whole contact: velocities are arbitrary; {remedy}", steps=steps, remedy=remedy),
        ),
        (worst > FAIR_ERROR, FAIR, _(off, **values)),
        (
            steps < FINE_STEPS,
            FAIR,
            _(
                "only {steps:.0f} steps to the shortest contact: velocities are rough; {remedy}",
                steps=steps,
                remedy=remedy,
            ),
        ),
    )
    good = (GOOD, _("{method} holds its errors", method=method))
    return next(((level, sentence) for found, level, sentence in findings if found), good)


def _chattering(method: str, chatter: float) -> tuple[str, str]:
    """Level and sentence where contacts close and open more often than is plausible."""
    if find_method(method).set_valued:
        return FAIR, _(BOUNCING, times=chatter)
    return BAD, _(CHATTERING, times=chatter, method=method)


def _off(name: str) -> tuple[str, str]:
    """What is said of a method that is off by some energy or momentum, a little or badly."""
    if name == "energy":
        return (
            N_("{method} is off by {error} of the energy"),
            N_("{method} is off by {error} of the energy: {remedy}"),
        )
    return (
        N_("{method} is off by {error} of the momentum"),
        N_("{method} is off by {error} of the momentum: {remedy}"),
    )


def _percent(value: float) -> str:
    return localized(f"{100.0 * value:.2g} %")
