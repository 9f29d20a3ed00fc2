"""Runner of the adaptive kernels: radau, dop853, accurate."""

from __future__ import annotations

from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive import step as kernel
from softcradle.physics.adaptive.integrate import integrate
from softcradle.physics.adaptive.self_check import confirmed, is_sensitive
from softcradle.physics.adaptive.step_control import PACES
from softcradle.physics.chain import Chain
from softcradle.physics.fixed_step.step_loop import OUT_OF_STEPS
from softcradle.physics.problem import MOST_STEPS, NO_TIMES, Problem, Record, empty_samples, run_to_end
from softcradle.physics.scales import speed_scale
from softcradle.physics.state import State

Array = NDArray[np.float64]

MOST_ENERGY = 100.0  # times the tolerance: an energy error that is reported
FIRST_SWITCHES, MOST_SWITCHES = 1024, 4_000_000  # rows in the book of contact switches: at first, and at the most
ROUND_OFF = 1e-13  # of the fastest bead: beads that close slower do not close
KIND = {"radau": kernel.RADAU, "dop853": kernel.DOP853, "accurate": kernel.ACCURATE}
_LOADED: set[str] = set()  # methods whose kernels are in memory


def run(problem: Problem) -> Record:
    """Run an adaptive method; where something rubs, phase after phase."""
    if problem.chain.dissipative:
        from softcradle.physics.friction import piecewise as dry_adaptive

        return dry_adaptive.run(problem, run)
    if not _LOADED:  # so that the cost measured is that of the motion
        _pass(problem, problem.state.time, NO_TIMES, False)
        _LOADED.add(problem.method)
    record = run_to_end(problem, _pass)
    if problem.most_steps is None and is_sensitive(problem, record):
        record = confirmed(problem, record, _scale(problem.chain, problem.state), _pass)
    record.warnings += _energy_warnings(problem, record)
    return record


def _energy_warnings(problem: Problem, record: Record) -> tuple[str, ...]:
    """A sentence where the energy of a chain left to itself has not come back to many times the tolerance."""
    chain, start = problem.chain, problem.state
    moved = np.isinf(chain.mass) & (start.velocity(chain) != 0.0)
    if start.external(chain) is not None or moved.any():
        return ()
    before, after = _energy(chain, start), _energy(chain, record.end)
    if abs(after - before) <= MOST_ENERGY * problem.tolerance * before:
        return ()
    return (
        f"energy is off by {abs(after / before - 1.0):.1g} of itself, more than {problem.method} promises at tolerance "
        f"{problem.tolerance:g}: compare with method 'conserving', or with another tolerance",
    )


def _energy(chain: Chain, state: State) -> float:
    """Kinetic and contact energy [J], walls left out."""
    mass, speed = np.array(chain.mass), state.velocity(chain)
    kinetic = 0.5 * float((np.where(np.isfinite(mass), mass, 0.0) * speed**2).sum())
    return kinetic + float(_stored(chain, state).sum())


def _stored(chain: Chain, state: State) -> Array:
    """(n,) energy [J] in each contact."""
    preload, stiffness, exponent = chain.parameters.law.T
    depth = np.maximum(state.overlap, 0.0)
    energy: Array = preload * depth + stiffness * depth ** (1.0 + exponent) / (1.0 + exponent)
    return energy


def _pass(problem: Problem, end: float, times: Array, stop: bool, size: int = FIRST_SWITCHES) -> Record:
    """One run of the kernel; again with a larger book of switches where the first was too small."""
    chain, state, most_steps = problem.chain, problem.state.copy(), problem.most_steps or MOST_STEPS
    counter = np.zeros(kernel.COUNTERS, dtype=np.int64)
    overlap, rate, anchor, force = empty_samples(times.size, chain.contacts)
    given, moving, trial = _given(chain, state, problem.method), _moving(state), _trial(chain.contacts)
    book = kernel.Book(np.zeros(size, dtype=np.int64), np.zeros(size), np.zeros(chain.contacts, dtype=np.int8), counter)
    began = perf_counter()
    status, time = integrate(
        state.time, end, stop, most_steps, _scale(chain, state), problem.tolerance,
        given, moving, trial, kernel.Samples(times, overlap, rate, anchor, force), book,
    )  # fmt: skip
    seconds = perf_counter() - began
    used = int(counter[kernel.SWITCH])
    if used > size and size < MOST_SWITCHES:
        return _pass(problem, end, times, stop, min(4 * used, MOST_SWITCHES))
    state.time = time
    kept = min(used, size)
    rows = int(counter[kernel.SAMPLE])  # fewer than wished where the run gave up
    samples = times[:rows], overlap[:rows], rate[:rows], anchor[:rows], force[:rows]
    gave_up = _gave_up(problem.method, most_steps, time) if status == OUT_OF_STEPS else ""
    sentences = _warnings(problem, gave_up, counter, kept)
    return Record(
        *samples, book.contact[:kept], book.time[:kept], state, int(counter[kernel.STEP]),
        int(counter[kernel.EVALUATION]), sentences, seconds, gave_up=gave_up,
    )  # fmt: skip


def _warnings(problem: Problem, gave_up: str, counter: NDArray[np.int64], kept: int) -> tuple[str, ...]:
    found = [f"{gave_up}; take method 'conserving', or a looser tolerance"] if gave_up else []
    if counter[kernel.RESCUE]:
        found.append(
            f"Newton did not settle in {counter[kernel.RESCUE]} places, where {problem.method} took a small conserving "
            "step: compare with another tolerance"
        )
    if counter[kernel.SWITCH] > kept:
        found.append(f"contacts switched {counter[kernel.SWITCH]} times, only the first {kept} are listed")
    return tuple(found)


def _gave_up(method: str, steps: int, time: float) -> str:
    return f"{method} gave up after {steps} steps at t = {time:.6g} s: the contacts rattle on"


def advance(chain: Chain, state: State, duration: float, method: str, tolerance: float, most_steps: int) -> str:
    """Move `state` on by `duration` in place; the scratch memory stays with the state.

    Returns why it stopped before, in a sentence without an end; empty where it did not.
    """
    if chain.dissipative:
        from softcradle.physics.friction import piecewise as dry_adaptive

        return dry_adaptive.advance(chain, state, duration, method, tolerance, most_steps, run)
    trial, book, samples = state.work.get("adaptive") or state.work.setdefault("adaptive", _live(chain.contacts))
    book.counter[:] = 0
    book.closed[:] = (state.overlap > 0.0) | ((state.overlap == 0.0) & (state.force > 0.0))
    end = state.time + duration
    status, reached = integrate(
        state.time, end, False, most_steps, _scale(chain, state), tolerance,
        _given(chain, state, method), _moving(state), trial, samples, book,
    )  # fmt: skip
    state.time = reached
    return _gave_up(method, most_steps, reached) if status == OUT_OF_STEPS else ""


def _scale(chain: Chain, state: State) -> float:
    """The velocity [m/s] that a tolerance is relative to: the closing speed, or what the contacts have stored of it."""
    inverse_mass = chain.parameters.inverse_mass
    stored = float(np.sqrt(2.0 * _stored(chain, state) * (inverse_mass[:-1] + inverse_mass[1:])).max())
    velocity = state.velocity(chain)
    if np.ptp(velocity) > ROUND_OFF * np.abs(velocity).max() or not stored:
        return max(speed_scale(chain, velocity), stored)
    return stored


def _given(chain: Chain, state: State, method: str) -> kernel.Given:
    """What does not move; forces from outside also as accelerations (n+1,) of the overlaps and of the anchor."""
    law, inverse_mass = chain.parameters
    push = state.external(chain)
    if push is None:
        return kernel.Given(law, inverse_mass, NO_TIMES, NO_TIMES, chain.anchor, KIND[method])
    acceleration = push * inverse_mass
    external = np.append(acceleration[:-1] - acceleration[1:], acceleration[chain.anchor])
    return kernel.Given(law, inverse_mass, push, external, chain.anchor, KIND[method])


def _moving(state: State) -> kernel.Moving:
    marks = np.zeros(state.overlap.size, dtype=np.int8), np.zeros(state.overlap.size, dtype=np.int8)
    return kernel.Moving(state.overlap, state.rate, state.anchor, state.force, *marks)


def _trial(contacts: int) -> kernel.Trial:
    stages = [np.zeros((3, contacts)) for _ in range(6)]
    return kernel.Trial(
        overlap=stages[0],
        rate=stages[1],
        force=stages[2],
        anchor=np.zeros(2),
        along=stages[3],
        across=stages[4],
        z=stages[5],
        block=np.zeros((contacts, 9)),
        past=np.zeros((8, contacts)),
        acceleration=np.zeros((12, contacts)),
        of_anchor=np.zeros(12),
        opening=np.zeros(contacts),
        work=np.zeros((15, contacts + 1)),
        pace=np.zeros(PACES),
    )


def _live(contacts: int) -> tuple[kernel.Trial, kernel.Book, kernel.Samples]:
    """Scratch memory of `advance`: no book of switches, no samples."""
    book = kernel.Book(
        np.zeros(0, dtype=np.int64),
        NO_TIMES,
        np.zeros(contacts, dtype=np.int8),
        np.zeros(kernel.COUNTERS, dtype=np.int64),
    )
    return _trial(contacts), book, kernel.Samples(NO_TIMES, *empty_samples(0, contacts))
