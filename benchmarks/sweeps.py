"""Overhead of a sweep of collisions in which one bead hits four, with tolerance 1e-6.

The sweep runs in this thread and in processes. The size of its chunks in bytes is measured, and the cost of 1e9
collisions is extrapolated.
"""

from __future__ import annotations

import pickle
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

from softcradle.physics import one_on, power_law
from softcradle.physics.ensemble_runs import cores
from softcradle.physics.simulation import solve
from softcradle.sandbox.sweeps import run_sweep, sobol

from benchmarks.reports import Report, at_most
from softcradle import scenes

COUNT = 20_000  # Number of collisions in a round.
TOLERANCE = 1e-6
ALPHAS = (0.099, 0.101)  # Range of exponents. The range is narrow, so all collisions take about the same time.
MEASURES = ("final_velocity",)  # Measures that need only final values, so several points are computed together.
EACH_ALONE = ("final_velocity", "closings")  # Measures that need a separate simulation for each point.
OVERHEAD_AIM = 10.0  # Wanted overhead in % of the computing time of the collisions.
SECONDS_AIM = 8.0  # Wanted time for 1e5 collisions on two cores [s].
MANY = 1e9  # Number of collisions whose cost is extrapolated.
CORES = (2, 64, 1000)


def alphas(count: int) -> list[float]:
    """Return the exponents of the collisions."""
    return sobol({"alpha": (*ALPHAS, "linear")}, count).columns(0, count)["alpha"].tolist()


def measure_work(count: int = COUNT) -> float:
    """Return the processor time [s] of the collisions without a sweep. The time includes the construction of their
    chains.
    """
    values = alphas(count)
    solve(one_on(4, power_law(1.0, values[0])), [1.0, 0, 0, 0, 0], samples=2, tolerance=TOLERANCE)
    began = process_time()
    for alpha in values:
        solve(one_on(4, power_law(1.0, alpha)), [1.0, 0, 0, 0, 0], samples=2, tolerance=TOLERANCE)
    return process_time() - began


def measure_sweep(executor: Any, count: int = COUNT, measures: tuple[str, ...] = MEASURES) -> dict[str, float]:
    """Return the cost of the same collisions as a stored sweep.

    The cost consists of the wall time [s], the processor time of this process [s], and the bytes of the store per
    point.
    """
    scene = scenes.load("one-on-four").model_copy(update={"tolerance": TOLERANCE})
    points = sobol({"lanes.0.contact.alpha": (*ALPHAS, "linear")}, count)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "swept.zarr"
        began, own = perf_counter(), process_time()
        run_sweep.sweep(scene, points, measures, output=path, executor=executor).close()
        seconds, own = perf_counter() - began, process_time() - own
        stored = sum(file.stat().st_size for file in path.rglob("*") if file.is_file())
    return {"seconds": seconds, "processor": own, "stored_bytes": stored / count}


def measure_traffic(count: int = 1000) -> dict[str, float]:
    """Return the number of bytes that a worker receives once and with each chunk, and that it returns for each point."""
    scene = scenes.load("one-on-four").model_copy(update={"tolerance": TOLERANCE})
    points = sobol({"lanes.0.contact.alpha": (*ALPHAS, "linear")}, 10_000_000)
    work = run_sweep.sweep_work(scene, points, MEASURES)
    back = pickle.dumps(work.compute(0, count))
    return {
        "work_bytes": len(pickle.dumps(work)),
        "task_bytes": len(pickle.dumps((0, count, 1.0))),
        "point_bytes": len(back) / count,
    }


def reports(count: int = COUNT) -> Iterator[Report]:
    """Yield the table of costs and the costs that are extrapolated from it."""
    measure_sweep("here", 2)  # The first sweep does not count because it loads packages.
    work, here, alone = measure_work(count), measure_sweep("here", count), measure_sweep("here", count, EACH_ALONE)
    processes, traffic = measure_sweep("processes", count), measure_traffic()
    overhead = 100.0 * (alone["processor"] / work - 1.0)
    rows = [
        ["a collision alone, processor ms", f"{1e3 * work / count:.3f}"],
        ["in a sweep of one process, each alone, processor ms", f"{1e3 * alone['processor'] / count:.3f}"],
        ["overhead of the sweep, %", at_most(overhead, OVERHEAD_AIM)],
        ["in a sweep of one process, side by side, processor ms", f"{1e3 * here['processor'] / count:.3f}"],
        [
            f"1e5 collisions in {cores()} processes, their start included, s",
            at_most(1e5 * processes["seconds"] / count, SECONDS_AIM),
        ],
        ["sent once to a worker, bytes", f"{traffic['work_bytes']}"],
        ["sent with a chunk, bytes", f"{traffic['task_bytes']}"],
        ["sent back for a point, bytes", f"{traffic['point_bytes']:.0f}"],
        ["on disk for a point, bytes", f"{here['stored_bytes']:.0f}"],
    ]
    each = here["processor"] / count
    hours = ", ".join(f"{MANY * each / 3600.0 / number:.3g} h on {number}" for number in CORES)
    size = MANY * here["stored_bytes"] / 1e9
    note = f"1e9 such collisions: {MANY * each / 3600.0:.3g} core hours ({hours} cores), {size:.3g} GB on disk"
    data = {"count": count, "work": work, "here": here, "alone": alone, "processes": processes, "traffic": traffic}
    yield Report(f"A sweep of {count} collisions of one on 4 at 1e-6", ["", ""], rows, [note], data)
