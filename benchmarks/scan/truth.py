"""The truth of a chain of the scan: fine runs where unlike methods confirm them, else the reference, else a spread.

Most chains are easy, and the reference takes seconds: where two fine runs of unlike steps agree and `conserving`, which shares
neither steps nor event location with them, ends where they do, theirs is the truth. One chain in twenty, and every chain that
they do not agree on or do not carry, is solved by the reference in extended precision. It takes no laws of one's own: these are
solved by method `scipy`, which asks the functions where the others read a table. Where the reference gives up, the motion bounces
often: the finest runs by two methods that come to its end tell how far it is determined, and where these give up too, the spread
of runs of `conserving`, which is the wider the coarser they are, tells how well its end is known.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, Contact, Coupler, OwnLaw
from softcradle.physics.chain import Joint
from softcradle.physics.methods import refusal_of
from softcradle.physics.scales import contact_scales
from softcradle.physics.simulation import solve

from benchmarks.scan.extended_precision import ReferenceGaveUpError, reference_end
from benchmarks.scan.families import Motion

Array = NDArray[np.float64]

TOLERANCE = 1e-12  # of the reference in extended precision
SCIPY = 1e-9, 1e-10  # tolerances of the two runs of method `scipy`,
MOST_STEPS_OF_SCIPY = 100_000  # and of each, some ten seconds, before it gives up
STEPS_AND_SQUARE = 60_000  # steps of the reference times the square of beads, some seconds, before it gives up
LEAST_STEPS, MOST_STEPS_OF_REFERENCE = 200, 3000  # of it in any case
SHAKE = 1e-10  # relative change of the forces from one run of `conserving` to the next
CONFIRMING = (1000, 1300)  # steps in the longest contact time of the two runs of `conserving` that confirm fine ones
SPREADING = (300, 600, 1000, 1700, 3000)  # and of those whose spread is the truth: like steps err alike
MOST_STEPS = 300_000  # of a run of `conserving`, about
FINE = {"radau": 1e-11, "accurate": 3e-12}  # tolerances of the two fine runs
AGREEMENT = 1e-10  # closing speeds: fine runs further apart do not confirm each other
CONFIRMED = 20.0  # times what two steps of `conserving` differ by, and
CONFIRMED_AT_LEAST = 1e-5  # closing speeds: as near has `conserving` to be to the fine runs
# methods and tolerances, the finest first, of runs that tell how far a motion is determined; each once more with shaken forces
DETERMINING, FINEST = ("accurate", "radau"), (1e-13, 1e-12, 1e-11, 1e-10)
ROUND_OFF = 1e-14  # relative change of forces by which these are shaken: some units in the last place
MOST_FINE_STEPS = 1_000_000  # of each, some seconds
LEAST_FINE_RUNS = 3  # of a method that come to their end, or they tell nothing; with as many no coarser ones are tried
# what a truth is known by
FINE_RUNS, REFERENCE, FINE_SPREAD, SPREAD, BY_SCIPY = SOURCES = (
    "fine runs", "reference", "spread of fine runs", "spread", "scipy",
)  # fmt: skip
BY_REFERENCE = 20  # every so many-th chain is solved by the reference in any case


@dataclass(frozen=True)
class Truth:
    """Final velocities (n+1,) [m/s], how well they are known (n+1,) [m/s], and by what."""

    velocity: Array
    doubt: Array
    source: str

    def as_json(self) -> dict[str, Any]:
        """As JSON takes it."""
        return {"velocity": self.velocity.tolist(), "doubt": self.doubt.tolist(), "source": self.source}

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Truth:
        """What `as_json` gave."""
        return cls(np.array(data["velocity"]), np.array(data["doubt"]), data["source"])


def truth_of(motion: Motion) -> Truth:
    """The truth, as well as it can be had."""
    chain, beads = motion.chain, motion.chain.contacts + 1
    if chain.own_laws:
        return _by_scipy(motion) or _spread(motion)
    adaptive = not any(refusal_of(method, chain) for method in FINE)
    fine = _fine(motion) if adaptive and motion.seed % BY_REFERENCE else None
    if fine is not None:
        return fine
    most_steps = max(LEAST_STEPS, min(STEPS_AND_SQUARE // beads**2, MOST_STEPS_OF_REFERENCE))
    try:
        found = reference_end(chain, motion.velocity, motion.duration, TOLERANCE, most_steps)
    except ReferenceGaveUpError:
        return (_fine_spread(motion) if adaptive else _by_scipy(motion)) or _spread(motion)
    return Truth(found.velocity, np.full(beads, found.error), REFERENCE)


def _by_scipy(motion: Motion) -> Truth | None:
    """The end of the finer of two runs of method `scipy`, and what they differ by."""
    ends = []
    for tolerance in SCIPY:
        run = solve(motion.chain, motion.velocity, motion.duration, "scipy", None, 2, tolerance, MOST_STEPS_OF_SCIPY)
        if run.status.gave_up:
            return None
        ends.append(run.final_velocity)
    return Truth(ends[1], np.abs(ends[0] - ends[1]) + SCIPY[1] * motion.speed, BY_SCIPY)


def _fine(motion: Motion) -> Truth | None:
    """The end of two fine runs, if they agree and `conserving` confirms them."""
    ends, last = [], 0.0
    for method, tolerance in FINE.items():
        found = solve(motion.chain, motion.velocity, motion.duration, method, samples=2, tolerance=tolerance)
        if found.warnings:
            return None
        ends.append(found.final_velocity)
        last = float(found.time[-1])
    apart = np.abs(ends[0] - ends[1])
    coarse = _conserving(motion, CONFIRMING, last)
    allowed = max(CONFIRMED * float(np.ptp(coarse, axis=0).max()), CONFIRMED_AT_LEAST * motion.speed)
    if apart.max() > AGREEMENT * motion.speed or np.abs(coarse - ends[1]).max() > allowed:
        return None
    return Truth(ends[1], apart + min(FINE.values()) * motion.speed, FINE_RUNS)


def _fine_spread(motion: Motion) -> Truth | None:
    """Median and spread of fine runs, if enough of them come to their end: how far the motion is determined.

    They are those of the method whose runs differ less, where the other's lie about as far from them as they differ.
    """
    found = [ends for ends in (_fine_ends(motion, method) for method in DETERMINING) if len(ends) >= LEAST_FINE_RUNS]
    if not found:
        return None
    ends = min(found, key=_largest_spread)
    middle = np.median(ends, axis=0)
    if any(np.abs(np.median(other, axis=0) - middle).max() > _largest_spread(other) for other in found):
        ends = np.vstack(found)
    spread = np.ptp(ends, axis=0) + min(FINE.values()) * motion.speed
    return Truth(np.median(ends, axis=0), spread, FINE_SPREAD)


def _fine_ends(motion: Motion, method: str) -> Array:
    """(runs, n+1) ends of the finest runs by a method, of those that come to it."""
    ends: list[Array] = []
    for tolerance in FINEST:
        if len(ends) >= LEAST_FINE_RUNS:
            break
        for part in (0.0, ROUND_OFF):
            chain = _shaken(motion.chain, part)
            found = solve(chain, motion.velocity, motion.duration, method, None, 2, tolerance, MOST_FINE_STEPS)
            if not found.status.gave_up:
                ends.append(found.final_velocity)
    return np.array(ends)


def _largest_spread(ends: Array) -> float:
    """The largest of what ends (runs, n+1) differ by [m/s]."""
    return float(np.ptp(ends, axis=0).max())


def _spread(motion: Motion) -> Truth:
    """Mean and spread of `conserving` at five steps, with forces that differ in the last digits, and of the finest run."""
    method, tolerance = list(FINE.items())[-1]
    if refusal_of(method, motion.chain):
        assert motion.duration is not None
        runs = _conserving(motion, SPREADING, motion.duration)
    else:
        finest = solve(motion.chain, motion.velocity, motion.duration, method, samples=2, tolerance=tolerance)
        runs = np.vstack((_conserving(motion, SPREADING, float(finest.time[-1])), finest.final_velocity))
    apart = float(np.ptp(runs, axis=0).max())
    return Truth(np.mean(runs, axis=0), np.full(runs.shape[1], 2.0 * apart), SPREAD)


def _conserving(motion: Motion, parts_of_contact: tuple[int, ...], last: float) -> Array:
    """(runs, n+1) ends by `conserving`, each with another step and with forces that differ in the last digits.

    `last` [s]: about when the motion ends.
    """
    longest = float(np.median(contact_scales(motion.chain, motion.velocity)[1]))
    runs = []
    for k, parts in enumerate(parts_of_contact):
        step = max(longest / parts, last / MOST_STEPS)
        chain = _shaken(motion.chain, k * SHAKE)
        runs.append(solve(chain, motion.velocity, motion.duration, "conserving", step, samples=2).final_velocity)
    return np.array(runs)


def _shaken(chain: Chain, part: float) -> Chain:
    factors = np.resize([1.0 + part, 1.0 - part], chain.contacts)
    return replace(chain, contact=tuple(map(_times, chain.contact, factors.tolist())))


def _times(contact: Joint, factor: float) -> Joint:
    """The contact with `factor` times its force."""
    if isinstance(contact, OwnLaw):
        return OwnLaw(lambda overlap: factor * contact.force(overlap))
    if isinstance(contact, Coupler):
        push, pull = (gear and cast("Contact", _times(gear, factor)) for gear in (contact.push, contact.pull))
        return replace(contact, push=push, pull=pull)
    return replace(contact, preload=contact.preload * factor, stiffness=contact.stiffness * factor)
