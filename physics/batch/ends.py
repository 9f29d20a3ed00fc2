"""`ensemble_ends`: simulate very many short chains of one shape, and return the ends of their motions as arrays.

No Python code runs for single chains.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.adaptive import usual_budget
from softcradle.physics.adaptive.adaptive_loop import integrate
from softcradle.physics.adaptive.error_estimate import MOST_GROWN, error_growth, estimated_error, rounding_of
from softcradle.physics.adaptive.step_records import ALLOWED, empty_scratch, empty_steps, empty_trial
from softcradle.physics.batch.chain_batch import ChainBatch
from softcradle.physics.batch.run_each import (
    NO_PAUSE,
    BatchData,
    BatchMotion,
    integrate_arguments,
    integrate_each,
    march_arguments,
    march_each,
)
from softcradle.physics.checked_input import LARGEST, SMALLEST, number_array, require_kind, shown
from softcradle.physics.confirm import LONG_RUN, SOFTEST
from softcradle.physics.contact import stored_energy
from softcradle.physics.ensemble_runs import in_threads, parts, threads_of
from softcradle.physics.fixed_step import runner as fixed_step
from softcradle.physics.fixed_step.step_loop import march
from softcradle.physics.kernel_tiers import KernelTiers, entry_of
from softcradle.physics.messages import InputError
from softcradle.physics.methods import Family, Method, find_method, refusal_of
from softcradle.physics.numerics.plain_kernels import plain
from softcradle.physics.numerics.records import (
    COUNTERS,
    DONE,
    EVALUATION,
    NO_FLAGS,
    NO_GRAPHS,
    NO_KNOTS,
    NO_STRINGS,
    SEPARATED,
    STEP,
)
from softcradle.physics.scales import (
    DEFAULT_STEPS_A_CONTACT,
    DEFAULT_STEPS_A_STOP,
    LEAST_DEPTH,
    LEAST_SCALE,
    MOST_DEPTH,
    NO_APPROACH,
    SPEED_ROUND_OFF,
    require_computable,
    struck_depth,
    velocity_room,
)
from softcradle.physics.simulation import DRIVEN, PUSHED_ON_A_BED, TWO_WALLS, checked_tolerance, pushes_on_a_bed, solve
from softcradle.physics.state import from_anchor

Array = NDArray[np.float64]
Which = NDArray[np.int64]

LEAST_AT_ONCE = 16  # Smallest number of chains that one call of a kernel simulates.
# Constant part of the largest number of steps of a chain. The usual budget for each contact is added to it. If a chain
# needs more steps, its contacts chatter, and `simulate` runs it.
FIRST_STEPS = 2000


@dataclass(frozen=True, eq=False)
class EnsembleEnds:
    """Ends of the motions of C chains with n+1 beads each, one row per chain.

    Attributes
    ----------
    final_velocity : ndarray, shape (C, n+1)
        Velocities of the beads [m/s] at the end.
    velocity_error : ndarray, shape (C, n+1)
        Estimated errors of these velocities [m/s]; NaN for fixed-step methods, which do not estimate errors.
    time : ndarray, shape (C,)
        Time of the end of the run [s].
    status : ndarray, shape (C,)
        Status as in ``Trajectory.status``: 0 done, 1 separated, 2 and 3 gave up, 4 undetermined, 7 step budget spent.
    steps : ndarray, shape (C,)
        Number of steps.
    evaluations : ndarray, shape (C,)
        Number of evaluations of all contact forces during these steps.
    """

    final_velocity: Array
    velocity_error: Array
    time: Array
    status: NDArray[np.int64]
    steps: NDArray[np.int64]
    evaluations: NDArray[np.int64]


def ensemble_ends(
    batch: ChainBatch,
    velocity: ArrayLike,
    duration: ArrayLike | None = None,
    method: str = "accurate",
    step: ArrayLike | None = None,
    tolerance: float = 1e-8,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> EnsembleEnds:
    """Simulate very many short chains of one shape, and return the ends of their motions as arrays.

    The results are bitwise equal to the results of `simulate`. Compiled code runs most chains one after the other, on
    all cores. `simulate` runs the chains with a drive or with overlaps at the start. `simulate` also runs the chains
    that need more than one run, because their contacts chatter or because their errors have grown. The function does
    not issue warnings. Check `status` and `velocity_error`, and run doubtful chains ``batch.chain(k)`` with `simulate`.

    Parameters
    ----------
    batch : ChainBatch
        The C chains of n+1 beads.
    velocity : array_like, shape (C, n+1) or (n+1,)
        Start velocities [m/s].
    duration : float or array_like, shape (C,), optional
        Duration [s] as for `simulate`, one for all chains or one for each.
    method : str, optional
        One of euler, verlet, yoshida4, conserving, radau, dop853 and accurate.
    step : float or array_like, shape (C,), optional
        Time step [s] of a fixed-step method, one for all chains or one for each; None means the default of each chain.
    tolerance : float, optional
        Wanted error of velocities, relative to the closing speed, for adaptive methods.
    workers : int, optional
        Number of threads; None means one for each core that this process may use.
    progress : callable, optional
        Called from the calling thread with the number of chains that were finished since the last call.

    Returns
    -------
    EnsembleEnds
        Final velocities, statuses and errors.

    Raises
    ------
    ValueError
        If shapes do not fit, or if `simulate` would raise it for one of the chains.

    Examples
    --------
    >>> import numpy as np
    >>> from softcradle import ChainBatch, ensemble_ends
    >>> batch = ChainBatch(np.ones((3, 3)), 0.0, 1.0, np.array([[1.0], [0.5], [0.1]]))
    >>> ensemble_ends(batch, [1, 0, 0]).final_velocity[:, 0].round(3)
    array([-0.13 , -0.238, -0.333])
    """
    require_kind("batch", batch, ChainBatch)
    chosen = _method(method, batch)
    threads = threads_of(workers)
    speeds = _velocities(batch, velocity)
    _require_end(batch, speeds, duration)
    durations = np.full(batch.chains, np.inf) if duration is None else _each("duration", duration, batch.chains, True)
    if chosen.adaptive:
        if step is not None:
            raise ValueError(f"method {method!r} chooses its own steps: give a tolerance instead of a step")
        tolerance = checked_tolerance(tolerance)
    steps = None if step is None else _each("step", step, batch.chains)
    run = _Run.of(batch, speeds, durations, duration is None)
    ends = EnsembleEnds(
        np.empty(speeds.shape), np.full(speeds.shape, np.nan), run.moving.time, run.moving.status,
        run.moving.counter[:, STEP], run.moving.counter[:, EVALUATION],
    )  # fmt: skip

    def alone(k: int) -> None:
        """Run chain `k` with `solve`."""
        limit = None if np.isinf(durations[k]) else float(durations[k])
        own_step = None if steps is None else float(steps[k])
        found = solve(batch.chain(k), speeds[k], limit, method, own_step, samples=2, tolerance=float(tolerance))
        ends.final_velocity[k], ends.velocity_error[k] = found.final_velocity, found.velocity_error
        ends.time[k], ends.status[k] = found.time[-1], found.status
        ends.steps[k], ends.evaluations[k] = found.steps, found.evaluations

    tell = progress or (lambda count: None)
    # Chains with a drive or with overlaps at the start need the full preparation of `solve`.
    special = batch.driven | (batch.gap < 0.0).any(axis=1)
    for _ in in_threads(alone, np.flatnonzero(special).tolist(), threads):
        tell(1)
    # All other chains run in compiled code. The threads share them in blocks.
    ordinary = np.flatnonzero(~special)
    times = _contact_times(batch, run.velocity, special)
    if chosen.adaptive:
        accuracy = _Accuracy.of(batch, method, float(tolerance), run.velocity)
        found = accuracy.grown, accuracy.turns, accuracy.control
        kernels: Any = TIERS["batch-adaptive"].of(integrate_each, np.inf), integrate, integrate_arguments
        move = _mover(*kernels, partial(_of_integrate, accuracy, run), ordinary, found)
    else:
        run.data.step[:] = _default_steps(batch, run.velocity, times) if steps is None else steps
        kernels = TIERS["batch-march"].of(march_each, np.inf), march, march_arguments
        move = _mover(*kernels, partial(_of_march, method, run), ordinary)
    blocks = [ordinary[part.start : part.stop] for part in parts(0, ordinary.size, threads, LEAST_AT_ONCE)]
    for k, _ in in_threads(move, blocks, threads):
        tell(blocks[k].size)
    ends.final_velocity[ordinary] = _velocities_of(batch, run.moving.rate, run.moving.anchor)[ordinary]
    # If the result of a single run is not trustworthy, further runs of `solve` confirm it.
    if chosen.adaptive:
        error, growth = accuracy.errors(run.velocity, ends.final_velocity, ends.steps)
        ends.velocity_error[ordinary] = error[ordinary, None]
        again = ~special & _needs_another_run(batch, run, error, growth)
        for _ in in_threads(alone, np.flatnonzero(again).tolist(), threads):
            pass
    return ends


@dataclass(frozen=True)
class _Run:
    """Arrays of a run of a batch, and the flag `stop`. With this flag, the run of a chain ends when its beads have
    separated.

    Chains that are not marked in `special` start as in `State.at_start`. `velocity` (C, n+1) contains the bead
    velocities, computed from the overlap rates.
    """

    data: BatchData
    moving: BatchMotion
    stop: bool
    velocity: Array

    @classmethod
    def of(cls, batch: ChainBatch, speeds: Array, ends: Array, stop: bool) -> _Run:
        """Return the arrays for a run from the bead velocities `speeds` (C, n+1) to the end times `ends` (C,) [s]."""
        count, n = batch.gap.shape
        chains = np.arange(count)
        position = np.concatenate((np.zeros((count, 1)), np.cumsum(batch.gap, axis=1)), axis=1)
        anchor = np.stack([position[chains, batch.anchor], speeds[chains, batch.anchor]], axis=1)
        rate = speeds[:, :-1] - speeds[:, 1:]
        data = BatchData(
            batch.law_rows, batch.loss.copy(), batch.inverse_mass, batch.bed, batch.anchor, batch.lossy, batch.on_bed,
            np.zeros(count), ends,
        )  # fmt: skip
        moving = BatchMotion(
            0.0 - batch.gap, rate, anchor, np.zeros((count, n)), np.zeros((count, n), dtype=np.int8),
            np.zeros((count, COUNTERS), dtype=np.int64), np.zeros(count, dtype=np.int64), np.zeros(count),
        )  # fmt: skip
        return cls(data, moving, stop, _velocities_of(batch, rate, anchor))


def _of_march(method: str, run: _Run) -> tuple[Any, ...]:
    """Return the arguments of `march_each` that all chains share, with new scratch memory. The kernel is that of fixed
    steps.
    """
    scratch = fixed_step.Scratch.of(method, run.moving.overlap.shape[1])
    kept, columns = (tuple(scratch.checkpoints), scratch.plan), (scratch.log.contact, scratch.log.time)
    memory = (tuple(scratch.samples), columns, kept, tuple(scratch.pause), np.zeros(4), (scratch.beads, scratch.work))
    return (
        fixed_step.DRIFTS_AND_KICKS[method], run.stop, fixed_step.MOST_FIXED_STEPS, tuple(run.data), tuple(run.moving), memory,
        (NO_FLAGS, NO_GRAPHS, NO_KNOTS, NO_STRINGS),
    )  # fmt: skip


@dataclass(frozen=True)
class _Accuracy:
    """Wanted accuracy of an adaptive method, and the data for its error estimate."""

    method: str
    tolerance: float
    mass: Array  # (C, n+1) masses [kg]
    scale: Array  # (C,) speed [m/s] to which the tolerance is relative
    budget: int  # Largest number of steps, including rejected ones. `simulate` runs a chain again if it needs more.
    grown: Array  # (C, n) error amplification by the last bounce of each contact
    turns: Array  # (C, n) number of turning points in the oscillation of each contact
    control: Array  # (C, 2) error amplification by earlier bounces, and sum of the squared errors of all steps

    @classmethod
    def of(cls, batch: ChainBatch, method: str, tolerance: float, velocity: Array) -> _Accuracy:
        """Return the wanted accuracy for start velocities `velocity` (C, n+1).

        The accuracy is relative to the largest possible closing speed, see `closing_scale`.
        """
        ahead = np.maximum.accumulate(velocity, axis=1)[:, :-1]
        approach = np.maximum((ahead - np.minimum.accumulate(velocity[:, ::-1], axis=1)[:, -2::-1]).max(axis=1), 0.0)
        approach[approach <= NO_APPROACH * np.abs(velocity).max(axis=1)] = 0.0
        spread = np.ptp(velocity, axis=1)
        scale = np.maximum(approach, max(LEAST_SCALE, SPEED_ROUND_OFF / tolerance) * spread)
        scale[scale == 0.0] = np.where(spread == 0.0, 1.0, spread)[scale == 0.0]
        first = FIRST_STEPS + usual_budget.STEPS_A_CONTACT * batch.contacts
        budget = min(first, LONG_RUN, usual_budget.usual_budget(batch.contacts, tolerance))
        grown, turns, control = (np.zeros((batch.chains, count)) for count in (batch.contacts, batch.contacts, 2))
        return cls(method, tolerance, batch.mass, scale, budget, grown, turns, control)

    def errors(self, start: Array, end: Array, steps: NDArray[np.int64]) -> tuple[Array, Array]:
        """Return the (C,) estimated error [m/s] of each chain after `steps` (C,) steps, and its error amplification.

        `start` and `end` (C, n+1) are the velocities of the beads [m/s] before and after the run.
        """
        growth = error_growth(self.control[:, 0], self.grown, self.turns)
        rounding = np.maximum(rounding_of(self.mass, start), rounding_of(self.mass, end))
        return estimated_error(growth, self.control[:, 1], steps + self.grown.shape[1], rounding), growth


def _of_integrate(accuracy: _Accuracy, run: _Run) -> tuple[Any, ...]:
    """Return the arguments of `integrate_each` that all chains share, with new scratch memory. The kernel is adaptive.

    The kernel does not confirm its results by further runs.
    """
    n = run.moving.overlap.shape[1]
    effective = np.zeros((n, 3)), np.zeros(n + 1), np.zeros(n + 1), np.zeros(4)
    block, records = _in_one_block(empty_trial(n), empty_trial(n), empty_scratch(n))
    memory = effective, np.zeros(4 * n + 1, dtype=np.int8), block, (*records, tuple(empty_steps(0, n, False)))
    nothing = np.zeros(0, dtype=np.int64), np.zeros(0), NO_GRAPHS, NO_KNOTS, NO_STRINGS, NO_PAUSE
    return (
        (ALLOWED[accuracy.method], accuracy.tolerance, accuracy.scale), run.stop, accuracy.budget, tuple(run.data),
        tuple(run.moving), memory, nothing,
    )  # fmt: skip


def _mover(
    kernel: Any, of_one: Any, arguments_of: Any, common: Callable[[], tuple[Any, ...]], chains: Which, *found: Any
) -> Callable[[Which], None]:
    """Return a function that simulates some of the `chains` with `kernel`.

    The kernel calls the compiled function `of_one` for each chain, with the result of `arguments_of`. The arguments
    from `common` are created for each call. Finding the address of `of_one` is slow, so it is found only once.
    """
    entry = entry_of(of_one, plain(arguments_of)(int(chains[0]), *common())) if chains.size else None

    def move(which: Which) -> None:
        kernel(entry, which, *common(), *found)

    return move


def _in_one_block(*records: Any) -> tuple[Array, list[tuple[Array, ...]]]:
    """Allocate one memory block for all arrays of `records`. Return the block, and the records as views into it."""
    block, first, found = np.zeros(sum(array.size for record in records for array in record)), 0, []
    for record in records:
        views = []
        for array in record:
            views.append(block[first : first + array.size].reshape(array.shape))
            first += array.size
        found.append(tuple(views))
    return block, found


def _needs_another_run(batch: ChainBatch, run: _Run, error: Array, growth: Array) -> NDArray[np.bool_]:
    """Return a boolean array (C,): True for chains whose single run is not sufficient.

    Reasons are a run that gave up, errors that have grown, and very soft contacts. Another reason is an estimated error
    above the limit that the energy of the chain allows.
    """
    soft = (batch.preload == 0.0) & (batch.exponent < SOFTEST)
    stored = stored_energy(batch.preload, batch.stiffness, batch.exponent, 0.0 - batch.gap).sum(axis=1)
    _, room = velocity_room(batch.mass, batch.on_bed, run.velocity, stored, batch.drive, run.moving.time)
    room[np.isinf(batch.mass)] = np.inf
    gave_up = (run.moving.status != DONE) & (run.moving.status != SEPARATED)
    return gave_up | (growth > MOST_GROWN) | soft.any(axis=1) | (error > room.min(axis=1))


def _velocities_of(batch: ChainBatch, rate: Array, anchor: Array) -> Array:
    """Return the (C, n+1) bead velocities, computed from the overlap rates and the velocities of the anchor beads."""
    found = np.empty(batch.mass.shape)
    for bead in np.unique(batch.anchor).tolist():
        rows = batch.anchor == bead
        found[rows] = from_anchor(rate[rows], anchor[rows, 1], bead)
    return found


def _contact_times(batch: ChainBatch, velocity: Array, special: NDArray[np.bool_]) -> Array:
    """Return the (C, n) contact times [s].

    Raise ValueError if the overlaps of a chain would be too small or too large for floating-point numbers. Chains
    marked in `special` are not checked.
    """
    speed = _speed(velocity)
    reduced = batch.inverse_mass[:, :-1] + batch.inverse_mass[:, 1:]
    with np.errstate(over="ignore", under="ignore"):
        depth = struck_depth(batch.preload, batch.stiffness, batch.exponent, 0.5 * (speed * speed)[:, None] / reduced)
    computable = (speed >= SMALLEST) & ((depth >= LEAST_DEPTH) & (depth <= MOST_DEPTH)).all(axis=1)
    for k in np.flatnonzero(~(computable | special)).tolist():
        require_computable(batch.chain(k), velocity[k])
    return 2.0 * depth / speed[:, None]


def _default_steps(batch: ChainBatch, velocity: Array, times: Array) -> Array:
    """Return the (C,) steps [s] of `default_step` for chains with contact times `times` (C, n) [s]."""
    steps: Array = times.min(axis=1) / DEFAULT_STEPS_A_CONTACT
    with np.errstate(divide="ignore"):
        return np.minimum(steps, _speed(velocity) / batch.bed.max(axis=1) / DEFAULT_STEPS_A_STOP)


def _speed(velocity: Array) -> Array:
    """Return the (C,) largest speeds [m/s] at which two beads approach or separate. The speed is 1 if nothing moves."""
    speed: Array = np.ptp(velocity, axis=1)
    return np.where(speed == 0.0, 1.0, speed)


def _method(name: str, batch: ChainBatch) -> Method:
    """Return the method called `name`. Raise ValueError if it cannot simulate batches of this kind."""
    if name == "auto":
        raise ValueError(
            "ensemble_ends takes the name of a method; 'auto' is for simulate, which chooses for one chain"
        )
    chosen = find_method(name)
    if chosen.family not in (Family.FIXED_STEP, Family.ADAPTIVE):
        raise ValueError(f"ensemble_ends takes methods of fixed steps and adaptive ones, not {name!r}: take ensemble")
    if batch.dissipative.any() and not chosen.dissipative:
        raise InputError(refusal_of(name, batch.chain(int(np.argmax(batch.dissipative)))))
    return chosen


def _require_end(batch: ChainBatch, velocity: Array, duration: ArrayLike | None) -> None:
    """Raise ValueError if the duration is None and a chain may never separate."""
    if duration is not None:
        return
    if (np.isinf(batch.mass).sum(axis=1) > 1).any():
        raise InputError(TWO_WALLS)
    if batch.driven.any():
        raise InputError(DRIVEN)
    if pushes_on_a_bed(batch.mass, batch.on_bed, velocity).any():
        raise InputError(PUSHED_ON_A_BED)


def _velocities(batch: ChainBatch, velocity: ArrayLike) -> Array:
    speeds = number_array("velocity", velocity)
    if speeds.shape not in (batch.mass.shape, batch.mass.shape[1:]):
        count, beads = batch.mass.shape
        raise ValueError(f"{count} chains of {beads} beads need velocities of shape {batch.mass.shape} or ({beads},)")
    if not (np.abs(speeds) <= LARGEST).all():
        raise ValueError(f"every velocity must be a finite number of at most {LARGEST:g} m/s")
    return np.broadcast_to(speeds, batch.mass.shape).copy()


def _each(name: str, value: ArrayLike, count: int, zero: bool = False) -> Array:
    found = number_array(name, value)
    if found.shape not in ((), (count,)):
        raise ValueError(f"{count} chains need {count} {name}s or one for all, not {shown(value)}")
    if not (((found > 0.0) | (zero & (found == 0.0))) & (found <= LARGEST)).all():
        raise ValueError(f"every {name} must be a finite number {'>=' if zero else '>'} 0, not {shown(value)}")
    return np.broadcast_to(found, (count,)).copy()


def _call_kernels(method: str) -> None:
    ensemble_ends(ChainBatch(np.ones((2, 3)), 0.0, 1.0, 0.1), [1.0, 0.0, 0.0], 1e-3, method)


TIERS = {
    name: KernelTiers(name, __name__, partial(_call_kernels, method))
    for name, method in (("batch-march", "conserving"), ("batch-adaptive", "accurate"))
}
