"""Time for the first use on a new machine, with an empty kernel cache.

The measured tasks are a table, a film, a window that plays, and a SoftChain.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter

from benchmarks.reports import Report, at_most

TABLE_AIM, FILM_AIM, WINDOW_AIM = 1.5, 2.0, 1.5  # Wanted times for a table, a film and a window [s].
STEP_AIM, FRAME_AIM = 50.0, 16.7  # Wanted times for a step and a frame [ms].
FRAMES = 300  # Number of frames of the window, while kernels are compiled in the background.

CHAIN = """
from time import perf_counter
import pymunk
from softcradle import SoftChain, hertz
space, balls = pymunk.Space(), [pymunk.Body(1.0, 1.0) for _ in range(5)]
for k, ball in enumerate(balls):
    ball.position = k, 0.0
balls[0].velocity = 1.0, 0.0
space.add(*balls, *SoftChain(balls, hertz(1e5), 1.0))
began = perf_counter()
space.step(1.0 / 240.0)
print(1e3 * (perf_counter() - began))
"""
WINDOW = """
from time import perf_counter, sleep
import numpy as np
from softcradle.sandbox.window.app import App
app = App(start="one-on-four", lab=True)
app.frame(1.0 / 60.0)
print(perf_counter(), flush=True)
app.page.clock.play_pause()
times = []
for _ in range({frames}):
    began = perf_counter()
    app.frame(1.0 / 60.0)
    times.append(perf_counter() - began)
    sleep(max(0.0, 1.0 / 60.0 - times[-1]))
assert app.page.session.time > 0.0
print(1e3 * np.quantile(times, 0.99), 1e3 * max(times))
app.close()
"""


def started(*arguments: str) -> tuple[float, str]:
    """Return the seconds that a Python process takes with an empty cache, and its output."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        screen = {"SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy", "SOFTCRADLE_CONFIG": folder}
        environment = {**os.environ, **screen, "NUMBA_CACHE_DIR": str(Path(folder) / "kernels")}
        began = perf_counter()
        done = subprocess.run(
            [sys.executable, *arguments], env=environment, capture_output=True, text=True, check=True, cwd=Path.cwd()
        )
        seconds = perf_counter() - began
        # End the background process. The process would continue although nobody reads its result.
        for lock in Path(folder).glob("kernels/*/*/*.compiling"):
            os.kill(int(lock.read_text().split()[0]), 15)
    return seconds, done.stdout


def reports() -> Iterator[Report]:
    """Yield the table of measured times."""
    table, _ = started("-m", "softcradle", "run", "one-on-four")
    with tempfile.TemporaryDirectory() as folder:
        film, _ = started(
            "-m", "softcradle", "render", "one-on-four", "--fps", "1", "-o", str(Path(folder) / "film.mp4")
        )
    began = perf_counter()
    _, said = started("-c", WINDOW.format(frames=FRAMES))
    shown, (percentile, worst) = float(said.split()[0]) - began, map(float, said.split()[1:])
    _, first_step = started("-c", CHAIN)
    rows = [
        ["table of `run one-on-four`, s", at_most(table, TABLE_AIM)],
        ["film of one frame a second of it, s", at_most(film, FILM_AIM)],
        ["window that plays it, s to the first frame", at_most(shown, WINDOW_AIM)],
        ["99th percentile of its frames while kernels are compiled behind, ms", at_most(percentile, FRAME_AIM)],
        ["its longest frame, ms", at_most(worst, FRAME_AIM)],
        ["first step of a SoftChain of five, ms", at_most(float(first_step), STEP_AIM)],
    ]
    yield Report("First use, with an empty cache of kernels", ["", "measured"], rows)
