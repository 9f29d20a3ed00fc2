"""Cost of verlet steps against the length of the chain, beside the powers that they cannot do without; many chains at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import is_dataclass
from time import perf_counter, thread_time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, State, advance
from softcradle.physics.ensemble_runs import cores
from softcradle.physics.numerics.elementary import power
from softcradle.physics.numerics.jit import jit

from benchmarks.reports import Report, at_most
from benchmarks.steps import ALPHA, OVERLAP, loaded_alike

Array = NDArray[np.float64]

ROUNDS = 60
STEP = 1e-6  # [s]
LENGTHS = (4, 16, 64, 256, 1000, 10_000, 100_000, 1_000_000)  # contacts
CONTACT_STEPS = 100_000  # contacts times steps in a round: shorter than a time slice of the scheduler
ENSEMBLE_CHAINS = 500
ENSEMBLE_CONTACTS = 2000  # of each chain
ENSEMBLE_STEPS = 100  # in a round
ENSEMBLE_ROUNDS = 5
POWER_AIM = 2.0  # our powers take at most so many times as long as the best others, from
POWER_AIM_LENGTH = 64  # contacts on


@jit
def library_powers(base, exponent, result):
    """Powers one by one, by the C library."""
    for i in range(result.size):
        result[i] = base[i] ** exponent[i]


@jit
def our_powers(base, exponent, result):
    """Powers one by one, with the same digits on every machine."""
    for i in range(result.size):
        result[i] = power(base[i], exponent[i])


def numpy_powers(base: Array, exponent: Array, result: Array) -> None:
    """Powers by NumPy."""
    np.power(base, exponent, out=result)


POWERS: dict[str, Callable[[Array, Array, Array], Any]] = {
    "compiled loop": library_powers,
    "NumPy": numpy_powers,
    "ours": our_powers,
}


def measure_powers(contacts: int, rounds: int = ROUNDS) -> dict[str, float]:
    """Nanoseconds of a power by each of POWERS, over as many numbers as contacts; all alternate in every round."""
    base = OVERLAP * np.random.default_rng(1).uniform(0.5, 1.0, contacts)
    exponent, result = np.full(contacts, ALPHA), np.empty(contacts)
    repeats = max(1, CONTACT_STEPS // contacts)
    seconds: dict[str, list[float]] = {name: [] for name in POWERS}
    for _ in range(rounds + 1):
        for name, function in POWERS.items():
            began = thread_time()
            for _ in range(repeats):
                function(base, exponent, result)
            seconds[name].append(thread_time() - began)
    return {name: min(found[1:]) / (repeats * contacts) * 1e9 for name, found in seconds.items()}


def measure_steps(contacts: int, rounds: int = ROUNDS) -> dict[str, float]:
    """Nanoseconds of a contact and step of `verlet` by `advance`, all contacts loaded; steps a second; bytes a contact."""
    chain, state = loaded_alike(contacts)
    steps = max(1, CONTACT_STEPS // contacts)
    seconds = []
    for _ in range(rounds + 1):
        began = thread_time()
        advance(chain, state, steps * STEP, method="verlet", step=STEP)
        seconds.append(thread_time() - began)
    step = min(seconds[1:]) / steps
    return {"nanoseconds": step / contacts * 1e9, "steps_a_second": 1.0 / step, "bytes": _bytes(chain, state)}


def _bytes(chain: Chain, state: State) -> float:
    """Bytes a contact in the arrays that a step reads or writes: law, masses, state, work arrays."""
    arrays = _arrays((chain.law_rows, chain.inverse_mass, state.overlap, state.rate, state.force, state.work))
    return sum(array.nbytes for array in arrays) / chain.contacts


def _arrays(part: Any) -> list[Array]:
    """All arrays in nested records, tuples and dictionaries."""
    if isinstance(part, np.ndarray):
        return [part]
    if is_dataclass(part):
        part = vars(part)
    inner = part.values() if isinstance(part, dict) else part if isinstance(part, (tuple, list)) else ()
    return [array for each in inner for array in _arrays(each)]


def measure_ensemble(threads: int) -> float:
    """Contact-steps a second of many chains by `advance` in `threads` threads."""
    pairs = [loaded_alike(ENSEMBLE_CONTACTS) for _ in range(ENSEMBLE_CHAINS)]

    def move(pair: tuple[Chain, State]) -> None:
        advance(*pair, ENSEMBLE_STEPS * STEP, method="verlet", step=STEP)

    seconds = []
    with ThreadPoolExecutor(threads) as pool:
        for _ in range(ENSEMBLE_ROUNDS + 1):
            began = perf_counter()
            list(pool.map(move, pairs, chunksize=max(1, ENSEMBLE_CHAINS // (8 * threads))))
            seconds.append(perf_counter() - began)
    return ENSEMBLE_CHAINS * ENSEMBLE_CONTACTS * ENSEMBLE_STEPS / min(seconds[1:])


def length_rows(lengths: tuple[int, ...] = LENGTHS, rounds: int = ROUNDS) -> Iterator[dict[str, Any]]:
    """Powers and steps at each length, measured one after the other."""
    for contacts in lengths:
        power = measure_powers(contacts, rounds)
        step = measure_steps(contacts, rounds)
        over_best = step["nanoseconds"] / min(power.values())
        yield {"contacts": contacts, "powers": power, **step, "over_best_power": over_best}


def reports() -> Iterator[Report]:
    """Cost against length, and the ensemble."""
    yield _length_report()
    yield _ensemble_report()


def _length_report() -> Report:
    found = list(length_rows())
    columns = ["contacts", *(f"{name} [ns]" for name in POWERS), "over best other (aim)", "verlet [ns]"]
    columns += ["over best power", "steps/s", "bytes"]
    note = f"per contact and step, all contacts loaded, alpha = 1/10; processor time of one thread, least of {ROUNDS} rounds"
    title = "Powers, and steps of verlet that take them"
    return Report(title, columns, [_length_texts(row) for row in found], [note], found)


def _length_texts(row: dict[str, Any]) -> list[str]:
    power = row["powers"]
    ratio = power["ours"] / min(power["compiled loop"], power["NumPy"])
    return [
        str(row["contacts"]),
        *(f"{power[name]:.2f}" for name in POWERS),
        at_most(ratio, POWER_AIM if row["contacts"] >= POWER_AIM_LENGTH else None),
        f"{row['nanoseconds']:.2f}",
        f"{row['over_best_power']:.1f}",
        f"{row['steps_a_second']:.3g}",
        f"{row['bytes']:.0f}",
    ]


def _ensemble_report() -> Report:
    threads = sorted({1, cores()})
    rates = {count: measure_ensemble(count) for count in threads}
    data = [{"threads": count, "contact_steps_a_second": rate} for count, rate in rates.items()]
    rows = [[str(count), f"{rate:.3g}"] for count, rate in rates.items()]
    title = f"{ENSEMBLE_CHAINS} chains of {ENSEMBLE_CONTACTS} contacts at once, verlet"
    return Report(title, ["threads", "contact-steps a second (aim 1e8 on 2 cores)"], rows, [], data)
