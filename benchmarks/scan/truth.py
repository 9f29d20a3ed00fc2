"""Reference solutions of the chains of the scan.

A reference solution consists of fine simulations that another method confirms, or comes from the reference method in
extended precision.

Most chains are easy, but the reference method takes seconds. If two fine simulations with different steps agree, and
`conserving` confirms their end, they are the reference solution. `conserving` shares neither steps nor event location
with them. The reference method solves one chain of twenty. The reference method also solves every chain for which the
fine simulations fail or disagree.

The reference method does not accept user-defined laws. The method `scipy` solves chains with such laws. This method
calls the functions, whereas other methods read a table. If the reference method gives up, contacts open and close
often. The finest simulations of two methods then show how precisely the motion is determined. If these give up as well,
the spread of simulations with `conserving` shows how precisely the end is known. Larger steps give a wider spread.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, Contact, Coupler, OwnLaw
from softcradle.physics.chain import Joint
from softcradle.physics.methods import refusal_of
from softcradle.physics.scales import contact_scales
from softcradle.physics.simulation import solve
from softcradle.physics.trajectory import Trajectory

from benchmarks.scan.extended_precision import Event, ReferenceGaveUpError, reference_end
from benchmarks.scan.families import Motion

Array = NDArray[np.float64]

TOLERANCE = 1e-12  # Tolerance of the reference in extended precision.
SCIPY = 1e-9, 1e-10  # Tolerances of the two simulations with the method `scipy`.
# Largest number of steps of a simulation with `scipy`. Such a simulation takes about ten seconds.
MOST_STEPS_OF_SCIPY = 100_000
# Largest product of the number of steps of the reference method and the square of the number of beads. It takes some
# seconds.
STEPS_AND_SQUARE = 60_000
# Lower and upper limit of the number of steps of the reference method that follows from STEPS_AND_SQUARE.
LEAST_STEPS, MOST_STEPS_OF_REFERENCE = 200, 3000
SHAKE = 1e-10  # Relative change of the forces from one simulation with `conserving` to the next.
# Number of steps per longest contact time in the two simulations with `conserving` that confirm fine simulations.
CONFIRMING = (1000, 1300)
# Number of steps per longest contact time in the simulations whose spread is the reference solution. The numbers differ
# because similar steps have similar errors.
SPREADING = (300, 600, 1000, 1700, 3000)
MOST_STEPS = 300_000  # Approximate limit of the number of steps of a simulation with `conserving`.
FINE = {"radau": 1e-11, "accurate": 3e-12}  # Tolerances of the two fine simulations.
# Largest difference of two fine simulations that confirm each other, as a fraction of the closing speed.
AGREEMENT = 1e-10
# Largest allowed distance of `conserving` from the fine simulations, in units of the difference of its two simulations.
CONFIRMED = 20.0
# Lower limit of the distance of `conserving` from the fine simulations that is allowed, as a fraction of the closing
# speed.
CONFIRMED_AT_LEAST = 1e-5
# Methods and tolerances of simulations that show how precisely a motion is determined. The finest tolerance is first.
# Each simulation is repeated with perturbed forces.
DETERMINING, FINEST = ("accurate", "radau"), (1e-13, 1e-12, 1e-11, 1e-10)
ROUND_OFF = 1e-14  # Relative change of the perturbed forces: some units in the last place.
MOST_FINE_STEPS = 1_000_000  # Largest number of steps of a simulation with perturbed forces. It takes some seconds.
# Number of finished simulations that a method needs for its spread. With this number, larger tolerances are not tried.
LEAST_FINE_RUNS = 3
# Sources of a reference solution.
FINE_RUNS, REFERENCE, FINE_SPREAD, SPREAD, BY_SCIPY = SOURCES = (
    "fine runs", "reference", "spread of fine runs", "spread", "scipy",
)  # fmt: skip
BY_REFERENCE = 20  # The reference solves each chain whose seed is a multiple of this number.
BEDS = (
    "bed-struck",
    "bed-pressed",
)  # These entries are families of short chains. The reference method solves each chain in a fraction of a second.
# Number of steps per longest contact time in the simulation with `conserving` that confirms the positions of fine
# simulations.
CONFIRMING_PATH = 300
# Largest allowed distance of the positions of `conserving` from the positions of fine simulations, as a fraction of the
# closing speed times the duration. A wrong motion of a bead causes a far larger error. These steps have a far smaller
# error.
PATH_CONFIRMED = 1e-3
# Fraction of the closing speed. If the overlap of a contact changes more slowly than this, the time at which the
# contact closes or opens is hardly determined.
SLOW_EVENT = 1e-3
MOST_EVENTS = 30  # Largest number of events of a chain that are judged. Later closings and openings add no information.


@dataclass(frozen=True)
class Path:
    """Final positions and contact times of a motion.

    Attributes:
        position: (n+1,) final positions [m].
        doubt: uncertainty of the positions [m].
        end: time of the end [s].
        events: the first closings and openings of contacts.
    """

    position: Array
    doubt: float
    end: float
    events: tuple[Event, ...]

    def at(self, time: float, velocity: Array) -> Array:
        """Return the positions (n+1,) at `time` [s].

        The positions follow from free flight with `velocity` (n+1,) [m/s] between this time and the end.
        """
        return self.position + (time - self.end) * velocity


@dataclass(frozen=True)
class Truth:
    """Reference solution with its source.

    A reference solution contains the final velocities (n+1,) [m/s], their uncertainties (n+1,) [m/s], and the path if
    it is known.
    """

    velocity: Array
    doubt: Array
    source: str
    path: Path | None = None

    def as_json(self) -> dict[str, Any]:
        """Return the reference solution as values that JSON can hold."""
        found = {"velocity": self.velocity.tolist(), "doubt": self.doubt.tolist(), "source": self.source}
        if self.path is None:
            return found
        path = {"position": self.path.position.tolist(), "doubt": self.path.doubt, "end": self.path.end}
        return found | {"path": path | {"events": [list(event) for event in self.path.events]}}

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Truth:
        """Return the Truth from values that `as_json` has written."""
        path = data.get("path")
        if path is not None:
            events = tuple(Event(int(i), bool(closes), *rest) for i, closes, *rest in path["events"])
            path = Path(np.array(path["position"]), path["doubt"], path["end"], events)
        return cls(np.array(data["velocity"]), np.array(data["doubt"]), data["source"], path)


def truth_of(motion: Motion) -> Truth:
    """Return the best reference solution that can be computed."""
    chain, beads = motion.chain, motion.chain.contacts + 1
    if chain.own_laws:
        return _by_scipy(motion) or _spread(motion)
    adaptive = not any(refusal_of(method, chain) for method in FINE)
    fine = _fine(motion) if adaptive and motion.seed % BY_REFERENCE and motion.family not in BEDS else None
    if fine is not None:
        return fine
    most_steps = max(LEAST_STEPS, min(STEPS_AND_SQUARE // beads**2, MOST_STEPS_OF_REFERENCE))
    try:
        found = reference_end(chain, motion.velocity, motion.duration, TOLERANCE, most_steps)
    except ReferenceGaveUpError:
        return (_fine_spread(motion) if adaptive else _by_scipy(motion)) or _spread(motion)
    path = Path(found.position, found.position_error, found.time, tuple(found.events[:MOST_EVENTS]))
    return Truth(found.velocity, np.full(beads, found.error), REFERENCE, path if not chain.couplers else None)


def _by_scipy(motion: Motion) -> Truth | None:
    """Return the final state of the finer of two simulations with `scipy`. The difference of the two simulations is the
    uncertainty.
    """
    ends = []
    for tolerance in SCIPY:
        run = solve(motion.chain, motion.velocity, motion.duration, "scipy", None, 2, tolerance, MOST_STEPS_OF_SCIPY)
        if run.status.gave_up:
            return None
        ends.append(run.final_velocity)
    return Truth(ends[1], np.abs(ends[0] - ends[1]) + SCIPY[1] * motion.speed, BY_SCIPY)


def _fine(motion: Motion) -> Truth | None:
    """Return the final state of two fine simulations.

    Return None if they disagree or if `conserving` does not confirm them.
    """
    runs = _fine_runs(motion)
    if any(found.warnings for found in runs):
        return None
    ends, last = [found.final_velocity for found in runs], float(runs[-1].time[-1])
    apart = np.abs(ends[0] - ends[1])
    coarse = _conserving(motion, CONFIRMING, last)
    allowed = max(CONFIRMED * float(np.ptp(coarse, axis=0).max()), CONFIRMED_AT_LEAST * motion.speed)
    if apart.max() > AGREEMENT * motion.speed or np.abs(coarse - ends[1]).max() > allowed:
        return None
    return Truth(ends[1], apart + min(FINE.values()) * motion.speed, FINE_RUNS, _path(motion, *runs))


def _fine_runs(motion: Motion) -> list[Trajectory]:
    return [
        solve(motion.chain, motion.velocity, motion.duration, method, samples=2, tolerance=tolerance)
        for method, tolerance in FINE.items()
    ]


def with_path(motion: Motion, truth: Truth) -> Truth:
    """Return the reference solution with the path of fine simulations.

    The path is added if the simulations end with the velocities of the solution and `conserving` confirms their
    positions.
    """
    if truth.source != FINE_RUNS:
        return truth
    runs = _fine_runs(motion)
    apart = max(np.abs(found.final_velocity - truth.velocity).max() for found in runs)
    return truth if apart > AGREEMENT * motion.speed else replace(truth, path=_path(motion, *runs))


def _path(motion: Motion, other: Trajectory, finest: Trajectory) -> Path | None:
    """Return the path of the finest of two fine simulations, or None if `conserving` ends at other positions."""
    end, velocity = float(finest.time[-1]), finest.final_velocity
    length = motion.speed * end
    step = max(float(np.median(contact_scales(motion.chain, motion.velocity)[1])) / CONFIRMING_PATH, end / MOST_STEPS)
    coarse = solve(motion.chain, motion.velocity, end, "conserving", step, samples=2)
    if np.abs(coarse.position[-1] - finest.position[-1]).max() > PATH_CONFIRMED * length:
        return None
    late = float(other.time[-1]) - end
    doubt = np.abs(other.position[-1] - late * velocity - finest.position[-1]).max() + min(FINE.values()) * length
    return Path(finest.position[-1], float(doubt), end, _events(motion, other, finest))


def _events(motion: Motion, other: Trajectory, finest: Trajectory) -> tuple[Event, ...]:
    """Return the first contact times of a simulation that another simulation confirms.

    The rates of the overlaps at these times are included.
    """
    times = sorted(_switches(finest), key=lambda switch: switch[2])[:MOST_EVENTS]
    if motion.chain.couplers or not times:
        return ()
    at = np.clip([time for *_, time in times], 0.0, finest.time[-1])
    at = np.where((at > 0.0) & (at < 1e-30), 0.0, at)
    tolerance = min(FINE.values())
    sampled = solve(motion.chain, motion.velocity, float(finest.time[-1]), "accurate", None, at, tolerance)
    found = []
    for (contact, closes, time), rates in zip(times, sampled.rate, strict=True):
        event = Event(contact, closes, time, abs(float(rates[contact])))
        if off_by(event, other, motion.speed) <= AGREEMENT * motion.speed * time:
            found.append(event)
    return tuple(found)


def _switches(found: Trajectory) -> list[tuple[int, bool, float]]:
    """Return (contact, closes, time [s]) of all closings and openings of contacts."""
    return [
        (i, closes, time)
        for i, intervals in enumerate(found.contact_intervals)
        for interval in intervals
        for closes, time in zip((True, False), interval, strict=True)
        if math.isfinite(time)
    ]


def off_by(event: Event, found: Trajectory, speed: float) -> float:
    """Return the error of the time of an event in a simulation, expressed as a distance [m].

    The distance is the difference of the times, multiplied by the rate of the overlap. The error is 0 if this rate is
    too small to determine the time. The error is infinite if the contact does not close or open in the simulation.
    """
    if event.speed < SLOW_EVENT * speed:
        return 0.0
    times = [interval[0 if event.closes else 1] for interval in found.contact_intervals[event.contact]]
    return event.speed * min((abs(time - event.time) for time in times), default=math.inf)


def _fine_spread(motion: Motion) -> Truth | None:
    """Return the median and the spread of fine simulations, if enough of them finish.

    The spread shows how precisely the motion is determined. The simulations of the method with the smaller spread are
    used. If the results of the other method are further away than their own spread, the simulations of both methods are
    used.
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
    """Return the (runs, n+1) final velocities of the finest simulations of a method that finish."""
    ends: list[Array] = []
    for tolerance in FINEST:
        if len(ends) >= LEAST_FINE_RUNS:
            break
        for part in (0.0, ROUND_OFF):
            chain = _perturbed(motion.chain, part)
            found = solve(chain, motion.velocity, motion.duration, method, None, 2, tolerance, MOST_FINE_STEPS)
            if not found.status.gave_up:
                ends.append(found.final_velocity)
    return np.array(ends)


def _largest_spread(ends: Array) -> float:
    """Return the largest difference [m/s] between final velocities (runs, n+1)."""
    return float(np.ptp(ends, axis=0).max())


def _spread(motion: Motion) -> Truth:
    """Return the mean and the spread of several simulations.

    The simulations use `conserving` with five steps and slightly different forces. The finest simulation is included.
    """
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
    """Return the (runs, n+1) final velocities of simulations with `conserving`.

    Each simulation has another step and slightly different forces. `last` [s] is the approximate end of the motion.
    """
    longest = float(np.median(contact_scales(motion.chain, motion.velocity)[1]))
    runs = []
    for k, parts in enumerate(parts_of_contact):
        step = max(longest / parts, last / MOST_STEPS)
        chain = _perturbed(motion.chain, k * SHAKE)
        runs.append(solve(chain, motion.velocity, motion.duration, "conserving", step, samples=2).final_velocity)
    return np.array(runs)


def _perturbed(chain: Chain, part: float) -> Chain:
    factors = np.resize([1.0 + part, 1.0 - part], chain.contacts)
    return replace(chain, contact=tuple(map(_times, chain.contact, factors.tolist())))


def _times(contact: Joint, factor: float) -> Joint:
    """Return the contact with `factor` times its force."""
    if isinstance(contact, OwnLaw):
        return OwnLaw(lambda overlap: factor * contact.force(overlap))
    if isinstance(contact, Coupler):
        push, pull = (gear and cast("Contact", _times(gear, factor)) for gear in (contact.push, contact.pull))
        return replace(contact, push=push, pull=pull)
    return replace(contact, preload=contact.preload * factor, stiffness=contact.stiffness * factor)
