"""`simulate` and `advance`: compute the whole Trajectory of a chain from its start, or the state a moment later."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from functools import cache
from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.advice.auto_method import choose
from softcradle.physics.advice.stability_limits import coarse_warnings, explicit_warnings, returning_warnings
from softcradle.physics.advice.unusual_numbers import unusual_warnings
from softcradle.physics.chain import Chain, bead_forces
from softcradle.physics.checked_input import magnitude, number_array, require_kind, shown, whole_number
from softcradle.physics.messages import N_, InputError, Message
from softcradle.physics.methods import AUTO, Family, Method, find_method, refusal_of, refusal_of_fineness
from softcradle.physics.problem import MOST_STEPS, Problem, Record, Runner
from softcradle.physics.scales import default_step, require_computable, swinging_speed
from softcradle.physics.state import NO_SWITCHES, State
from softcradle.physics.status import CodedWarning, WarningCode
from softcradle.physics.trajectory import Interval, Trajectory

Array = NDArray[np.float64]

TWO_WALLS = Message("two_walls", "a chain with two walls may never come apart: give a duration")
PUSHED_ON_A_BED = Message(
    "pushed_on_bed", "beads on a bed may never come apart from a wall that moves: give a duration"
)
DRIVEN = Message("driven", "a driven chain may never come apart: give a duration")
HUNG = Message("hung", "beads on strings swing forever: give a duration")
PULLED = Message("pulled", "a chain whose couplers pull never comes apart: give a duration")
NO_AUTO = Message("no_auto", "advance takes the name of a method; 'auto' is for simulate, which knows the whole motion")
LEAST_TOLERANCE = 1e-16  # Smallest tolerance. A smaller error is not distinguishable from round-off.
# Smallest sample time [s] other than 0. Products of smaller times underflow, so their overlaps would be 0.
LEAST_TIME = 1e-100
# Largest number of samples times beads. This number of samples takes about 3 GB, and suffices for 1001 samples of the
# longest lane of a scene.
MOST_SAMPLED = 100_100_000
FALLBACK_METHOD = "conserving"  # Method that finishes a frame after an adaptive method has given up
FALLBACK_STEPS = 100  # Number of steps of FALLBACK_METHOD in the rest of the frame


def simulate(
    chain: Chain,
    velocity: ArrayLike,
    duration: float | None = None,
    method: str = "accurate",
    step: float | None = None,
    samples: int | ArrayLike = 201,
    tolerance: float = 1e-8,
) -> Trajectory:
    """Simulate the motion of `chain` from its start with the given bead velocities, Eq. (3).

    Parameters
    ----------
    chain : Chain
    velocity : array_like, shape (n+1,)
        Start velocities [m/s].
    duration : float, optional
        Time to run [s]. None means that the run ends when every contact is open and none can close again, or when
        all beads rest. On a bed, it is sufficient that no contact closes before the beads have slid to rest. Some
        chains need a duration: chains with a permanent force, chains on strings, and chains on a bed towards which
        a wall moves.
    method : str, optional
        A name from METHODS, or "auto". With "auto", the method and its step or tolerance are chosen for an error of
        `tolerance` on this chain. The choice is the same on every machine, and the Trajectory contains its reason.
        Explicit methods (euler, verlet, yoshida4, pymunk) use f = 0 at overlap 0. With them, a contact with preload
        that should rest at overlap 0 chatters.
    step : float, optional
        Step [s] of a fixed-step method. None means a thousandth of the shortest contact time.
    samples : int or array_like, optional
        Number of evenly spaced samples from start to end, or their times (T,) [s], ascending.
    tolerance : float, optional
        Wanted error of velocities, relative to the closing speed, for adaptive methods and "auto".

    Returns
    -------
    Trajectory
        Samples of the motion, with cost, status and warnings.

    Raises
    ------
    ValueError
        If a value is out of range, or if duration is None for a chain that may never separate. Examples are chains
        with two walls, with a drive, or on a bed with a moving wall.

    Examples
    --------
    >>> from softcradle import one_on, power_law, simulate
    >>> simulate(one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0]).final_velocity.round(2)
    array([-0.57,  0.17,  0.45,  0.47,  0.47])
    """
    trajectory = solve(chain, velocity, duration, method, step, samples, tolerance)
    for warning in trajectory.warnings:
        warnings.warn(warning.sentence, RuntimeWarning, stacklevel=2)
    return trajectory


def solve(
    chain: Chain,
    velocity: ArrayLike,
    duration: float | None = None,
    method: str = "accurate",
    step: float | None = None,
    samples: int | ArrayLike = 201,
    tolerance: float = 1e-8,
    most_steps: int | None = None,
) -> Trajectory:
    """Simulate as :func:`simulate` does, but store warnings only on the Trajectory.

    Python warnings are not thread-safe, so threads should call this function. After `most_steps` steps the method gives
    up, and the end of the motion is not confirmed. None means no limit.
    """
    if method == AUTO:
        require_kind("chain", chain, Chain)
        _refuse(refusal_of(AUTO, chain))
        _refuse(refusal_of_fineness(AUTO, step, None))
        # This call raises ValueError for values out of range.
        _problem(chain, velocity, duration, find_method("accurate"), None, samples, tolerance)
        # Choose a method for this chain, and run it.
        auto = choose(chain, velocity, duration, tolerance)
        found = solve(chain, velocity, duration, auto.method, auto.step or None, samples, auto.tolerance or tolerance)
        return replace(found, choice=auto.reason)
    chosen = find_method(method)
    problem = _problem(chain, velocity, duration, chosen, step, samples, tolerance)
    if most_steps is not None:
        problem = replace(problem, most_steps=most_steps)
    runner = runner_of(method)  # The first call may import a library. The import time does not count as computing time.
    began = perf_counter()
    record = runner.run(problem)
    record.seconds = record.seconds or perf_counter() - began
    # Append the warnings that depend on the chain, the method and the step. The warnings of the runner come first.
    record.warnings += unusual_warnings(chain, velocity, problem.tolerance)
    if not chosen.set_valued:
        record.warnings += explicit_warnings(problem, record)
    elif step is not None:  # The default step is never too long.
        record.warnings += coarse_warnings(problem)
    if problem.step and not any(warning.code is WarningCode.CHATTER for warning in record.warnings):
        record.warnings += returning_warnings(problem, record)
    return _trajectory(problem, record)


def advance(
    chain: Chain,
    state: State,
    duration: float,
    method: str = "verlet",
    step: float | None = None,
    tolerance: float = 1e-8,
    most_steps: int = MOST_STEPS,
) -> None:
    """Move `state` forward by `duration` [s] in place, for live use. Fixed-step kernels do not allocate memory.

    Arguments are as in :func:`simulate`. ``state.push`` (n+1,) [N] acts on the beads for the whole duration, in
    addition to the drive of the chain. If the duration is not a whole number of steps, the last step is shorter. If
    contacts chatter, an adaptive method may not reach the end within `most_steps` steps. The method `conserving` then
    continues to the end. A Python warning, ``state.status`` and ``state.warnings`` report this.
    ``state.velocity_error`` [m/s] is the estimated error of the velocities since the start. The guaranteed error is ten
    times the `tolerance`, relative to the closing speed. A warning is issued if the estimate is larger.
    """
    move(chain, state, duration, method, step, tolerance, most_steps)
    for warning in state.warnings:
        warnings.warn(warning.sentence, RuntimeWarning, stacklevel=2)


def move(
    chain: Chain, state: State, duration: float, method: str, step: float | None, tolerance: float, most_steps: int
) -> None:
    """Move `state` as :func:`advance` does, but store warnings only in ``state.warnings``."""
    require_kind("chain", chain, Chain)
    require_kind("state", state, State)
    if len(state.overlap) != chain.contacts:
        raise InputError(
            "state_contacts",
            "the state has {given} contacts, the chain {needed}",
            given=len(state.overlap),
            needed=chain.contacts,
        )
    _require(method != AUTO, NO_AUTO)
    chosen = find_method(method)
    _refuse(refusal_of(method, chain))
    if state.push is not None:
        state.push = bead_forces("push", state.push, chain.contacts + 1)
    duration = magnitude("duration", duration, zero=True)
    if whole_number("most_steps", most_steps) < 1:
        raise InputError("most_steps", "most_steps must be at least 1, not {given}", given=shown(most_steps))
    length = _step(chain, state, chosen, step)
    fineness = checked_tolerance(tolerance) if chosen.adaptive else 0.0
    problem = Problem(chain, state, method, duration, length, fineness, most_steps=most_steps)
    end = problem.end
    state.warnings, state.switched = (), NO_SWITCHES
    # The impulse of time-dependent forces is an integral that does not depend on the motion.
    before = chain.impulse(state.time)
    # Other methods do not estimate their error.
    if chosen.family is not Family.ADAPTIVE:
        state.velocity_error = math.nan
    state.status = runner_of(method).advance(problem)
    # The frame must reach its end. The method `conserving` continues, and the error is then unknown.
    if state.status.gave_up:
        state.warnings = (_gave_up(method, state.time, most_steps),)
        state.velocity_error = math.nan
        _finish_frame(chain, state, end)
    state.taken[3] += chain.impulse(state.time) - before


@cache
def runner_of(method: str) -> Runner:
    """Return the runner of `method`.

    A runner is imported on first use, because it loads numba, pymunk or SciPy.
    """
    match find_method(method).family:
        case Family.FIXED_STEP:
            from softcradle.physics.fixed_step import runner as fixed_step

            return fixed_step
        case Family.ADAPTIVE:
            from softcradle.physics import confirm

            return confirm
        case Family.PYMUNK:
            from softcradle.physics.pymunk_contacts import runner as pymunk_space

            return pymunk_space
        case Family.REFERENCE:
            from softcradle.physics.reference import runner as reference

            return reference


def _finish_frame(chain: Chain, state: State, end: float) -> None:
    rest = end - state.time
    if rest > 0.0:
        runner_of(FALLBACK_METHOD).advance(Problem(chain, state, FALLBACK_METHOD, rest, rest / FALLBACK_STEPS))
    state.time = end


def _gave_up(method: str, time: float, most_steps: int) -> CodedWarning:
    what = f"{method} gave up at t = {time:.6g} s: {most_steps} steps did not reach the end"
    sentence = f"{what}; {FALLBACK_METHOD} moved on from there"
    return CodedWarning(WarningCode.GAVE_UP, sentence, {"time": time, "steps": most_steps})


def _require(condition: bool | np.bool_, message: str) -> None:
    if not condition:
        raise InputError(message)


def _refuse(reason: str) -> None:
    if reason:
        raise InputError(reason)


def checked_tolerance(tolerance: float) -> float:
    """Return the tolerance as a float. Raise ValueError if no method can satisfy it."""
    found = magnitude("tolerance", tolerance)
    if found < LEAST_TOLERANCE:
        raise InputError(
            "tolerance",
            "{what} must be at least {least:g}, not {given:g}",
            what="tolerance",
            least=LEAST_TOLERANCE,
            given=found,
        )
    return found


def endless(chain: Chain, velocity: ArrayLike) -> str:
    """Return the reason why a run of the chain may never end without a duration.

    Return an empty string if the run ends.
    """
    if chain.walls > 1:
        return TWO_WALLS
    if chain.swing:
        return HUNG
    if chain.lasts:
        return DRIVEN
    if chain.walls and pushes_on_a_bed(chain.mass, chain.on_bed, velocity):
        return PUSHED_ON_A_BED
    return PULLED if chain.pulls else ""


def pushes_on_a_bed(mass: ArrayLike, on_bed: ArrayLike, velocity: ArrayLike) -> NDArray[np.bool_]:
    """Return True (...) if a wall moves towards beads of `mass` (..., n+1) on a bed.

    The beads may then stay in contact with the wall forever.
    """
    walls, speeds = np.isinf(np.asarray(mass)), np.asarray(velocity)
    ahead = (walls & (speeds > 0.0))[..., :-1].any(axis=-1) | (walls & (speeds < 0.0))[..., 1:].any(axis=-1)
    return ahead & np.asarray(on_bed)


def _step(
    chain: Chain, state: State, method: Method, step: float | None, duration: float | None = None, whole: bool = False
) -> float:
    """Return the step [s] of a fixed-step method, or 0 for an adaptive method.

    `whole` is True if `state` is the start of the chain.
    """
    if step is not None:
        length = magnitude("step", step)
        _refuse(refusal_of_fineness(method.name, step, None))
        return length
    if method.adaptive:
        return 0.0
    speeds = state.velocity(chain)
    if chain.swing and not whole:  # At a turning point of the swinging, the velocities do not show the closing speed.
        speeds = np.array((0.0, swinging_speed(chain, speeds, state.overlap)))
    return default_step(chain, speeds, duration, whole and method.set_valued)


def _problem(
    chain: Chain,
    velocity: ArrayLike,
    duration: float | None,
    method: Method,
    step: float | None,
    samples: int | ArrayLike,
    tolerance: float,
) -> Problem:
    state = State.at_start(chain, velocity)
    _refuse(refusal_of(method.name, chain))
    # A run without a duration must have an end.
    if duration is None:
        _refuse(endless(chain, velocity))
    else:
        duration = magnitude("duration", duration, zero=True)
    require_computable(chain, velocity, duration)
    tolerance = checked_tolerance(tolerance)
    return Problem(
        chain=chain,
        state=state,
        method=method.name,
        duration=duration,
        step=_step(chain, state, method, step, duration, whole=True),
        tolerance=tolerance if method.adaptive else 0.0,
        samples=_samples(samples, duration, chain, method.adaptive),
    )


def _samples(samples: int | ArrayLike, duration: float | None, chain: Chain, graded: bool) -> int | Array:
    most = MOST_SAMPLED // (chain.contacts + 1)
    if isinstance(samples, int) or np.ndim(samples) == 0:
        count = whole_number("samples", samples)
        if not 2 <= count <= most:
            raise InputError(
                "samples",
                "samples must be from 2 (start and end) to {most} of these beads, not {given}",
                most=most,
                given=shown(samples),
            )
        return count
    # Copy a list of sample times.
    times = number_array("samples", samples).copy()
    listed = Message("sample_times", "sample times must be a list of 1 to {most} times", most=most)
    _require(times.ndim == 1 and 0 < times.size <= most, listed)
    ascending = Message("sample_order", "sample times must be >= 0 and ascending")
    _require((np.diff(times) >= 0.0).all() and times[0] >= 0.0, ascending)
    # Raise ValueError if a time is too large for the computation.
    magnitude(N_("sample times"), max(times[-1], 1.0))
    # Adaptive steps resolve the start of a motion down to the first sample.
    least = float(times[times > 0.0].min(initial=np.inf))
    underflow = Message(
        "early_sample",
        "sample times must be 0 or at least {least:g} s, not {given:g}: overlaps before underflow",
        least=LEAST_TIME,
        given=least,
    )
    _require(not graded or least >= LEAST_TIME, underflow)
    if duration is not None and times[-1] > duration:
        raise InputError("late_sample", "sample times must lie within the duration {duration}", duration=duration)
    return times


def _trajectory(problem: Problem, record: Record) -> Trajectory:
    time, overlap, rate, anchor, force, taken = record.samples
    if problem.chain.timed:
        taken[:, 3] = problem.chain.impulse(time)
    return Trajectory(
        chain=problem.chain,
        time=time,
        overlap=overlap,
        rate=rate,
        anchor=anchor,
        force=force,
        final_velocity=record.velocity,
        contact_intervals=_intervals(problem.chain.contacts, record),
        method=problem.method,
        step=problem.step,
        tolerance=problem.tolerance,
        speed_scale=float(problem.scale) if problem.tolerance else 0.0,
        steps=record.steps,
        evaluations=record.evaluations,
        seconds=record.seconds,
        status=record.status,
        warnings=record.warnings,
        velocity_error=record.velocity_error,
        absorbed_by_contacts=taken[:, 0],
        absorbed_by_bed=taken[:, 1],
        given=taken[:, 2:],
    )


def _intervals(contacts: int, record: Record) -> tuple[tuple[Interval, ...], ...]:
    """Combine the switches of each contact into intervals (closed, opened).

    The second time is infinite if the contact never opens.
    """
    found: list[list[Interval]] = [[] for _ in range(contacts)]
    for contact, time in zip(record.switch_contact.tolist(), record.switch_time.tolist(), strict=True):
        own = found[contact]
        # Every second switch of a contact closes an interval.
        if own and own[-1][1] == math.inf:
            own[-1] = own[-1][0], time
        else:
            own.append((time, math.inf))
    return tuple(map(tuple, found))
