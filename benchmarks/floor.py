"""The floor of explicit steps: the powers that they must take. Cost against length, memory, ensembles on all cores."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from time import perf_counter, thread_time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, State, advance, power_law
from softcradle.physics.ensemble import cores
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.simd_power import powers

from benchmarks.report import Report, against
from benchmarks.steps import ALPHA, PRESSED, pressed

Array = NDArray[np.float64]

ROUNDS = 60
STEP = 1e-6
LENGTHS = (4, 16, 64, 256, 1000, 10_000, 100_000, 1_000_000)
WORK = 100_000  # contacts times steps in a measurement: shorter than a turn of the scheduler
MANY = (500, 2000)  # chains and contacts of the ensemble: a million contacts


@jit
def loop(base, exponent, result):
    """Powers one by one, as the C library takes them."""
    for i in range(result.size):
        result[i] = base[i] ** exponent[i]


def numpy_powers(base: Array, exponent: Array, result: Array) -> None:
    """NumPy's own."""
    np.power(base, exponent, out=result)


POWERS: dict[str, Callable[[Array, Array, Array], Any]] = {
    "compiled loop": loop,
    "NumPy": numpy_powers,
    "ours": powers,
}


def bare(contacts: int, rounds: int = ROUNDS) -> dict[str, float]:
    """Nanoseconds a power, each way, over as many numbers as contacts; all ways take their turn in every round."""
    base = PRESSED * np.random.default_rng(1).uniform(0.5, 1.0, contacts)
    exponent, result = np.full(contacts, ALPHA), np.empty(contacts)
    times = max(1, WORK // contacts)
    spent: dict[str, list[float]] = {name: [] for name in POWERS}
    for _ in range(rounds + 1):
        for name, function in POWERS.items():
            began = thread_time()
            for _ in range(times):
                function(base, exponent, result)
            spent[name].append(thread_time() - began)
    return {name: min(found[1:]) / (times * contacts) * 1e9 for name, found in spent.items()}


def stepped(contacts: int, rounds: int = ROUNDS) -> dict[str, float]:
    """Nanoseconds a contact and step of `verlet` by `advance`, every contact pressed; steps a second; bytes a contact."""
    chain, state = pressed(contacts)
    steps = max(1, WORK // contacts)
    spent = []
    for _ in range(rounds + 1):
        began = thread_time()
        advance(chain, state, steps * STEP, method="verlet", step=STEP)
        spent.append(thread_time() - began)
    each = min(spent[1:]) / steps
    return {"nanoseconds": each / contacts * 1e9, "steps_a_second": 1.0 / each, "bytes": memory(chain, state)}


def memory(chain: Chain, state: State) -> float:
    """Bytes a contact in the arrays that steps work on: law, masses, state, scratch."""
    kept = _arrays((*chain.parameters, state.overlap, state.rate, state.force, state.work))
    return sum(array.nbytes for array in kept) / chain.contacts


def _arrays(part: Any) -> list[Array]:
    if isinstance(part, np.ndarray):
        return [part]
    inner = part.values() if isinstance(part, dict) else part if isinstance(part, (tuple, list)) else ()
    return [array for each in inner for array in _arrays(each)]


def together(chains: int, contacts: int, threads: int, steps: int = 100, rounds: int = 5) -> float:
    """Contact-steps a second of many chains by `advance` in `threads` threads."""
    states = []
    for _ in range(chains):
        chain = Chain([np.inf, *np.ones(contacts - 1), np.inf], power_law(1.0, ALPHA))
        state = State.at_start(chain, np.zeros(contacts + 1))
        state.overlap[:] = PRESSED
        states.append((chain, state))

    def move(pair: tuple[Chain, State]) -> None:
        advance(*pair, steps * STEP, method="verlet", step=STEP)

    spent = []
    with ThreadPoolExecutor(threads) as pool:
        for _ in range(rounds + 1):
            began = perf_counter()
            list(pool.map(move, states, chunksize=max(1, chains // (8 * threads))))
            spent.append(perf_counter() - began)
    return chains * contacts * steps / min(spent[1:])


def rows(lengths: tuple[int, ...] = LENGTHS, rounds: int = ROUNDS) -> Iterator[dict[str, Any]]:
    """Cost by length: bare powers and steps, measured side by side."""
    for contacts in lengths:
        ways = bare(contacts, rounds)
        step = stepped(contacts, rounds)
        yield {
            "contacts": contacts,
            "powers": ways,
            **step,
            "over_best_power": step["nanoseconds"] / min(ways.values()),
        }


def reports() -> Iterator[Report]:
    """Cost against length, and the ensemble."""
    found = list(rows())
    table = []
    for row in found:
        ways = row["powers"]
        share = ways["ours"] / min(ways["compiled loop"], ways["NumPy"])
        table.append(
            [
                str(row["contacts"]),
                *(f"{ways[name]:.2f}" for name in POWERS),
                against(share, 2.0 if row["contacts"] >= 64 else None),
                f"{row['nanoseconds']:.2f}",
                f"{row['over_best_power']:.1f}",
                f"{row['steps_a_second']:.3g}",
                f"{row['bytes']:.0f}",
            ]
        )
    columns = ["contacts", *(f"{name} [ns]" for name in POWERS), "over best other (aim)", "verlet [ns]"]
    columns += ["over best power", "steps/s", "bytes"]
    note = f"per contact and step, every contact pressed, alpha = 1/10; processor time of one thread, least of {ROUNDS} rounds"
    yield Report("The floor: powers, and steps of verlet that take them", columns, table, [note], found)
    rates = {threads: together(*MANY, threads) for threads in sorted({1, cores()})}
    data = [{"threads": threads, "contact_steps_a_second": rate} for threads, rate in rates.items()]
    lines = [[str(threads), f"{rate:.3g}"] for threads, rate in rates.items()]
    title = f"{MANY[0]} chains of {MANY[1]} contacts at once, verlet"
    yield Report(title, ["threads", "contact-steps a second (aim 1e8 on 2 cores)"], lines, [], data)
