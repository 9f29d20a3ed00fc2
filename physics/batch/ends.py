"""`ensemble_ends`: how very many short chains of one shape end, as arrays; no chain costs Python anything."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.adaptive import usual_budget
from softcradle.physics.adaptive.adaptive_loop import integrate
from softcradle.physics.adaptive.runner import MOST_GROWN, error_growth, rounding_of, stated_error
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
from softcradle.physics.kernel_records import NO_FLAGS
from softcradle.physics.kernel_tiers import KernelTiers, entry_of
from softcradle.physics.methods import Family, Method, find_method, refusal_of
from softcradle.physics.numerics.plain_kernels import plain
from softcradle.physics.numerics.records import COUNTERS, DONE, EVALUATION, NO_JOINTS, NO_KNOTS, SEPARATED, STEP
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

LEAST_AT_ONCE = 16  # chains in a call of a kernel
# steps of a chain, and as many more for each contact as of the usual budget; one that takes more rattles, and `simulate` runs it
FIRST_STEPS = 2000


@dataclass(frozen=True, eq=False)
class EnsembleEnds:
    """How C chains of n+1 beads ended, a row a chain.

    Attributes
    ----------
    final_velocity : ndarray, shape (C, n+1)
        Bead velocities [m/s] at the end.
    velocity_error : ndarray, shape (C, n+1)
        Estimated error of these [m/s]; nan for methods of fixed steps, which state none.
    time : ndarray, shape (C,)
        When the run ended [s].
    status : ndarray, shape (C,)
        How it ended, as in ``Trajectory.status``: 0 done, 1 separated, 2 and 3 gave up, 4 undetermined, 7 step budget spent.
    steps : ndarray, shape (C,)
        Number of steps taken.
    evaluations : ndarray, shape (C,)
        How often all contact forces were evaluated for these steps.
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
    """Let very many short chains of one shape move, each as `simulate` would; their ends as arrays.

    They are those of `simulate` to the last digit. Chains run one after the other in compiled code, on all cores; those that are
    driven or pressed at the start, and those whose motion takes more than one run, because they rattle or errors have grown, are
    run by `simulate`. There are no warnings: look at `status` and `velocity_error`, and run a doubtful chain,
    ``batch.chain(k)``, by `simulate`.

    Parameters
    ----------
    batch : ChainBatch
        The C chains of n+1 beads.
    velocity : array_like, shape (C, n+1) or (n+1,)
        Start velocities [m/s].
    duration : float or array_like, shape (C,), optional
        Time to run [s], as for `simulate`, one for all or C of them.
    method : str, optional
        One of euler, verlet, yoshida4, conserving, radau, dop853 and accurate.
    step : float or array_like, shape (C,), optional
        Step [s] of a fixed-step method, one for all or C of them; None takes the default of each chain.
    tolerance : float, optional
        Wanted error of velocities, relative to the closing speed, for adaptive methods.
    workers : int, optional
        Number of threads; None takes one for each core that this process may use.
    progress : callable, optional
        Called from the calling thread with the number of chains that have been done since the last call.

    Returns
    -------
    EnsembleEnds
        Final velocities, statuses and errors.

    Raises
    ------
    ValueError
        Shapes that do not fit, or what `simulate` raises for one of the chains.

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
        """Run one chain by itself."""
        limit = None if np.isinf(durations[k]) else float(durations[k])
        own_step = None if steps is None else float(steps[k])
        found = solve(batch.chain(k), speeds[k], limit, method, own_step, samples=2, tolerance=float(tolerance))
        ends.final_velocity[k], ends.velocity_error[k] = found.final_velocity, found.velocity_error
        ends.time[k], ends.status[k] = found.time[-1], found.status
        ends.steps[k], ends.evaluations[k] = found.steps, found.evaluations

    tell = progress or (lambda count: None)
    special = batch.driven | (batch.gap < 0.0).any(axis=1)
    for _ in in_threads(alone, np.flatnonzero(special).tolist(), threads):
        tell(1)
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
    if chosen.adaptive:
        error, growth = accuracy.errors(run.velocity, ends.final_velocity, ends.steps)
        ends.velocity_error[ordinary] = error[ordinary, None]
        again = ~special & _needs_another_run(batch, run, error, growth)
        for _ in in_threads(alone, np.flatnonzero(again).tolist(), threads):
            pass
    return ends


@dataclass(frozen=True)
class _Run:
    """The arrays of a run, and whether chains stop when they are apart.

    Chains that are not `special` begin as `State.at_start` has it; `velocity` (C, n+1) is that of the beads as rates give it.
    """

    data: BatchData
    moving: BatchMotion
    stop: bool
    velocity: Array

    @classmethod
    def of(cls, batch: ChainBatch, speeds: Array, ends: Array, stop: bool) -> _Run:
        """From bead velocities `speeds` (C, n+1) to `ends` (C,) [s]."""
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
    """What all chains have in common for `march_each`, with memory of its own: methods of fixed steps."""
    scratch = fixed_step.Scratch.of(method, run.moving.overlap.shape[1])
    kept, columns = (tuple(scratch.checkpoints), scratch.plan), (scratch.log.contact, scratch.log.time)
    memory = (tuple(scratch.samples), columns, kept, tuple(scratch.pause), np.zeros(4), (scratch.beads, scratch.work))
    return (
        fixed_step.DRIFTS_AND_KICKS[method], run.stop, fixed_step.MOST_FIXED_STEPS, tuple(run.data), tuple(run.moving), memory,
        (NO_FLAGS, NO_JOINTS, NO_KNOTS),
    )  # fmt: skip


@dataclass(frozen=True)
class _Accuracy:
    """What an adaptive method is asked for, and what it finds of its errors."""

    method: str
    tolerance: float
    mass: Array  # (C, n+1)
    scale: Array  # (C,) speed [m/s] that the tolerance is relative to
    budget: int  # steps, rejected ones included; a chain that takes more is run again
    grown: Array  # (C, n) growth of errors by the last bounce of each contact
    turns: Array  # (C, n) turns of the oscillation of each contact
    control: Array  # (C, 2) growth by those before, and the sum of squares of the errors of steps

    @classmethod
    def of(cls, batch: ChainBatch, method: str, tolerance: float, velocity: Array) -> _Accuracy:
        """Relative to the fastest closing there can be from `velocity` (C, n+1), see `closing_scale`."""
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
        """(C,) the error [m/s] that each chain states after its `steps` (C,), and the factor by which errors have grown.

        `start` and `end` (C, n+1) are the velocities of the beads [m/s] before and after.
        """
        growth = error_growth(self.control[:, 0], self.grown, self.turns)
        rounding = np.maximum(rounding_of(self.mass, start), rounding_of(self.mass, end))
        return stated_error(growth, self.control[:, 1], steps + self.grown.shape[1], rounding), growth


def _of_integrate(accuracy: _Accuracy, run: _Run) -> tuple[Any, ...]:
    """The same for `integrate_each`, which moves chains as far as an adaptive method goes by itself."""
    n = run.moving.overlap.shape[1]
    effective = np.zeros((n, 3)), np.zeros(n + 1), np.zeros(n + 1), np.zeros(4)
    block, records = _in_one_block(empty_trial(n), empty_trial(n), empty_scratch(n))
    memory = effective, np.zeros(4 * n + 1, dtype=np.int8), block, (*records, tuple(empty_steps(0, n, False)))
    nothing = np.zeros(0, dtype=np.int64), np.zeros(0), NO_JOINTS, NO_KNOTS, NO_PAUSE
    return (
        (ALLOWED[accuracy.method], accuracy.tolerance, accuracy.scale), run.stop, accuracy.budget, tuple(run.data),
        tuple(run.moving), memory, nothing,
    )  # fmt: skip


def _mover(
    kernel: Any, of_one: Any, arguments_of: Any, common: Callable[[], tuple[Any, ...]], chains: Which, *found: Any
) -> Callable[[Which], None]:
    """What moves some of the `chains` by `kernel`, which calls the kernel `of_one` with what `arguments_of` a chain gives.

    What is `common` to all is made anew for each call; the entry of `of_one`, which takes longer to find, once.
    """
    entry = entry_of(of_one, plain(arguments_of)(int(chains[0]), *common())) if chains.size else None

    def move(which: Which) -> None:
        kernel(entry, which, *common(), *found)

    return move


def _in_one_block(*records: Any) -> tuple[Array, list[tuple[Array, ...]]]:
    """Memory of the size of all arrays of `records`, and these as views into it."""
    block, first, found = np.zeros(sum(array.size for record in records for array in record)), 0, []
    for record in records:
        views = []
        for array in record:
            views.append(block[first : first + array.size].reshape(array.shape))
            first += array.size
        found.append(tuple(views))
    return block, found


def _needs_another_run(batch: ChainBatch, run: _Run, error: Array, growth: Array) -> NDArray[np.bool_]:
    """(C,) whether more than one run decides on a chain: it gave up, errors have grown, its contacts are very soft, or its
    energy allows no such error."""
    soft = (batch.preload == 0.0) & (batch.exponent < SOFTEST)
    stored = stored_energy(batch.preload, batch.stiffness, batch.exponent, 0.0 - batch.gap).sum(axis=1)
    _, room = velocity_room(batch.mass, batch.on_bed, run.velocity, stored, batch.drive, run.moving.time)
    room[np.isinf(batch.mass)] = np.inf
    gave_up = (run.moving.status != DONE) & (run.moving.status != SEPARATED)
    return gave_up | (growth > MOST_GROWN) | soft.any(axis=1) | (error > room.min(axis=1))


def _velocities_of(batch: ChainBatch, rate: Array, anchor: Array) -> Array:
    """(C, n+1) bead velocities from the rates and the anchor beads."""
    found = np.empty(batch.mass.shape)
    for bead in np.unique(batch.anchor).tolist():
        rows = batch.anchor == bead
        found[rows] = from_anchor(rate[rows], anchor[rows, 1], bead)
    return found


def _contact_times(batch: ChainBatch, velocity: Array, special: NDArray[np.bool_]) -> Array:
    """(C, n) contact times [s]. ValueError where a chain that is not `special` is pressed so little or so far that floats end."""
    speed = _speed(velocity)
    reduced = batch.inverse_mass[:, :-1] + batch.inverse_mass[:, 1:]
    with np.errstate(over="ignore", under="ignore"):
        depth = struck_depth(batch.preload, batch.stiffness, batch.exponent, 0.5 * (speed * speed)[:, None] / reduced)
    computable = (speed >= SMALLEST) & ((depth >= LEAST_DEPTH) & (depth <= MOST_DEPTH)).all(axis=1)
    for k in np.flatnonzero(~(computable | special)).tolist():
        require_computable(batch.chain(k), velocity[k])
    return 2.0 * depth / speed[:, None]


def _default_steps(batch: ChainBatch, velocity: Array, times: Array) -> Array:
    """(C,) steps [s] of `default_step` for chains whose contacts take `times` (C, n) [s]."""
    steps: Array = times.min(axis=1) / DEFAULT_STEPS_A_CONTACT
    with np.errstate(divide="ignore"):
        return np.minimum(steps, _speed(velocity) / batch.bed.max(axis=1) / DEFAULT_STEPS_A_STOP)


def _speed(velocity: Array) -> Array:
    """(C,) the largest speeds [m/s] at which any two beads approach or part; 1 where nothing moves."""
    speed: Array = np.ptp(velocity, axis=1)
    return np.where(speed == 0.0, 1.0, speed)


def _method(name: str, batch: ChainBatch) -> Method:
    """The method, if it moves such batches."""
    if name == "auto":
        raise ValueError(
            "ensemble_ends takes the name of a method; 'auto' is for simulate, which chooses for one chain"
        )
    chosen = find_method(name)
    if chosen.family not in (Family.FIXED_STEP, Family.ADAPTIVE):
        raise ValueError(f"ensemble_ends takes methods of fixed steps and adaptive ones, not {name!r}: take ensemble")
    if batch.dissipative.any() and not chosen.dissipative:
        raise ValueError(refusal_of(name, batch.chain(int(np.argmax(batch.dissipative)))))
    return chosen


def _require_end(batch: ChainBatch, velocity: Array, duration: ArrayLike | None) -> None:
    """Raise ValueError where a chain may never come apart and there is no duration."""
    if duration is not None:
        return
    if (np.isinf(batch.mass).sum(axis=1) > 1).any():
        raise ValueError(TWO_WALLS)
    if batch.driven.any():
        raise ValueError(DRIVEN)
    if pushes_on_a_bed(batch.mass, batch.on_bed, velocity).any():
        raise ValueError(PUSHED_ON_A_BED)


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
