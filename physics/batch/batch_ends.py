"""`ensemble_ends`: how very many short chains of one shape end, as arrays; no chain costs Python anything."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.batch.batch_runs import (
    Accuracy,
    BatchRun,
    integrate_part,
    march_part,
    needs_another_run,
    parts_of,
)
from softcradle.physics.batch.batch_scales import (
    closing_scales,
    contact_times,
    default_steps,
    start_of,
    velocities_of,
)
from softcradle.physics.batch.chain_batch import ChainBatch
from softcradle.physics.batch.run_each import integrate_each, march_each
from softcradle.physics.checked_input import LARGEST, number_array, require_kind, shown, whole_number
from softcradle.physics.compile_log import log_compilation
from softcradle.physics.ensemble_runs import cores, in_threads
from softcradle.physics.kernel_tiers import KernelTiers
from softcradle.physics.methods import Family, Method, find_method, refusal_of
from softcradle.physics.numerics.records import EVALUATION, STEP
from softcradle.physics.simulation import DRIVEN, LEAST_TOLERANCE, TWO_WALLS, solve

Array = NDArray[np.float64]


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
        How it ended, as in ``Trajectory.status``: 0 done, 1 separated, 2 and 3 gave up, 4 undetermined.
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

    They are those of `simulate` to the last digit. Chains run one after the other in compiled code, on all cores; those whose
    motion takes more than one run, because they rattle or errors have grown, are run by `simulate`. There are no warnings: look
    at `status` and `velocity_error`, and run a doubtful chain, ``batch.chain(k)``, by `simulate`.

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
    if workers is not None and whole_number("workers", workers) < 1:
        raise ValueError(f"workers must be at least 1, not {shown(workers)}")
    _require_end(batch, duration)
    speeds = _velocities(batch, velocity)
    start = start_of(batch, speeds)
    durations = np.full(batch.chains, np.inf) if duration is None else _each("duration", duration, batch.chains, True)
    times = contact_times(batch, start.velocity)
    log_compilation()
    threads = workers or cores()
    if chosen.adaptive:
        if step is not None:
            raise ValueError(f"method {method!r} chooses its own steps: give a tolerance instead of a step")
        if not LEAST_TOLERANCE <= tolerance <= LARGEST:
            raise ValueError(f"tolerance must be from {LEAST_TOLERANCE:g} to {LARGEST:g}, not {shown(tolerance)}")
        run = BatchRun.of(batch, start, np.zeros(batch.chains), durations, duration is None)
        accuracy = Accuracy.of(batch, method, float(tolerance), closing_scales(batch, start, durations))
        move: Any = partial(integrate_part, KERNELS["adaptive"].of(integrate_each, np.inf), accuracy, run)
    else:
        steps = default_steps(batch, start.velocity, times) if step is None else _each("step", step, batch.chains)
        run = BatchRun.of(batch, start, steps, durations, duration is None)
        tiers = KERNELS["march-dissipative" if batch.dissipative.any() else "march"]
        move = partial(march_part, tiers.of(march_each, np.inf), method, run)
    parts = list(parts_of(batch, threads))
    for k, _ in in_threads(move, parts, threads):
        if progress is not None:
            progress(parts[k].chains.size)
    moving = run.moving
    ends = EnsembleEnds(
        velocities_of(batch, moving.rate, moving.anchor), np.full(batch.mass.shape, np.nan), moving.time, moving.status,
        moving.counter[:, STEP].copy(), moving.counter[:, EVALUATION].copy(),
    )  # fmt: skip
    if chosen.adaptive:
        error, growth = accuracy.errors()
        ends.velocity_error[:] = error[:, None]
        again = np.flatnonzero(needs_another_run(batch, start.velocity, moving, error, growth))
        _run_again(batch, speeds, again, durations, method, float(tolerance), ends, threads)
    return ends


def _run_again(
    batch: ChainBatch, velocity: Array, which: NDArray[np.int64], durations: Array, method: str, tolerance: float,
    ends: EnsembleEnds, threads: int,
) -> None:  # fmt: skip
    """Run the chains `which` one by one, and put their ends into `ends`."""

    def one(k: int) -> None:
        limit = float(durations[k]) if np.isfinite(durations[k]) else None
        found = solve(batch.chain(k), velocity[k], limit, method, samples=2, tolerance=tolerance)
        ends.final_velocity[k], ends.velocity_error[k] = found.final_velocity, found.velocity_error
        ends.time[k], ends.status[k] = found.time[-1], found.status
        ends.steps[k], ends.evaluations[k] = found.steps, found.evaluations

    for _ in in_threads(one, which.tolist(), threads):
        pass


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


def _require_end(batch: ChainBatch, duration: ArrayLike | None) -> None:
    """Raise ValueError where a chain may never come apart and there is no duration."""
    if duration is not None:
        return
    if (np.isinf(batch.mass).sum(axis=1) > 1).any():
        raise ValueError(TWO_WALLS)
    if batch.driven.any():
        raise ValueError(DRIVEN)


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


def _call_kernels(method: str, friction: float) -> None:
    """Call the kernels once."""
    ensemble_ends(ChainBatch(np.ones((2, 3)), 0.0, 1.0, 0.1, friction=friction), [1.0, 0.0, 0.0], 1e-3, method)


KERNELS = {
    name: KernelTiers(f"batch-{name}", __name__, partial(_call_kernels, method, friction))
    for name, method, friction in (
        ("march", "conserving", 0.0),
        ("march-dissipative", "conserving", 0.1),
        ("adaptive", "accurate", 0.0),
    )
}
TIERS = {kernels.name: kernels for kernels in KERNELS.values()}
