"""Speed of the window: the time to the first frame, the frames of a busy screen, and the cost of a paused screen.

The time to the first frame is measured with and without cached kernels. A frame includes events, physics, drawing and
display. The window has 1280x720 pixels and shows a collision of 50 beads with plots. The display of the machine is used
if there is one. Otherwise SDL's dummy driver is used, whose display costs no time.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter, thread_time
from typing import Any

import numpy as np

from benchmarks.reports import Report

FRAME = 1.0 / 60.0  # Duration of a frame [s].
SECONDS = 10.0  # Time for which frames are measured [s].
STARTS = 3  # Number of starts. The fastest start counts.
FRAMES_TO_RESTART = 600  # Number of frames after which the collision is over.
SCENE = """
title = "One on forty-nine"
[[lanes]]
beads = [1, 49]
contact = {law = "power_law", f0 = 1.0, alpha = "1/10"}
velocity = 1.0
approach = 0.5
[view]
slow = 2.0
"""
FIRST_FRAME = """
from softcradle.sandbox.window.app import App
app = App(lab=True)
app.frame(1 / 60)
print("shown", flush=True)
"""

PAUSED = """
import threading, time
from softcradle.sandbox.window.app import App
app, marks = App(start="one-on-four", lab=True), []
app.warmup.complete.wait()
def mark():
    marks.append((time.process_time(), time.perf_counter()))
for seconds, do in ((5.0, mark), (15.0, mark), (15.5, app.quit)):
    threading.Timer(seconds, do).start()
app.run()
(work, began), (worked, ended) = marks
print(100.0 * (worked - work) / (ended - began))
"""


def reports() -> Iterator[Report]:
    """Yield the table with the times of start, pause and frames."""
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY") or sys.platform in ("win32", "darwin")):
        os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    os.environ["PYGAME_HIDE_SUPPORT_PROMPT"] = "1"
    found: dict[str, Any] = {"start": starts(), "paused": paused(), "frame": frames(SECONDS)}
    frame = found["frame"]
    rows = [[name.replace("_", " "), f"{value:.2f}"] for name, value in found["start"].items()]
    rows += [["paused, per cent of a core", f"{found['paused']:.2f}"]]
    rows += [[name.replace("_", " "), f"{value:.2f}"] for name, value in frame.items() if name.endswith("_ms")]
    note = f"{frame['frames']} frames, driver {frame['driver']}, {frame['late']} later than a sixtieth of a second"
    yield Report("The window, 50 beads at 1280x720", ["", ""], rows, [note], found)


def starts() -> dict[str, float]:
    """Return the seconds from the start of the process to the first frame.

    The times are measured with and without cached kernels and thumbnails.
    """
    cached = min(_start(dict(os.environ)) for _ in range(STARTS))
    with tempfile.TemporaryDirectory() as folder:
        empty = {**os.environ, "NUMBA_CACHE_DIR": folder, "SOFTCRADLE_CACHE": f"{folder}/thumbnails"}
        return {"cached_seconds": cached, "uncached_seconds": _start(empty)}


def _start(environment: dict[str, str]) -> float:
    began = perf_counter()
    with subprocess.Popen([sys.executable, "-c", FIRST_FRAME], stdout=subprocess.PIPE, env=environment) as process:
        assert process.stdout is not None
        process.stdout.readline()
        seconds = perf_counter() - began
        process.kill()
    return seconds


def paused() -> float:
    """Return the percentage of a core that the loop of the window uses for an open, paused scene during 10 s."""
    done = subprocess.run([sys.executable, "-c", PAUSED], stdout=subprocess.PIPE, check=True, text=True)
    return float(done.stdout.split()[-1])


def frames(seconds: float) -> dict[str, Any]:
    """Return the durations of frames [ms] in `seconds` of play. The scene is restarted when the collision is over."""
    import pygame

    app = _opened_app()
    session = app.page.session
    wall, processor, physics = [], [], []
    for k in range(round(seconds / FRAME)):
        if k % FRAMES_TO_RESTART == FRAMES_TO_RESTART - 1:
            app.act("restart")
        began, worked = perf_counter(), thread_time()
        app.frame(FRAME)
        wall.append(1e3 * (perf_counter() - began))
        processor.append(1e3 * (thread_time() - worked))
        physics.append(2.0 * session.pacer.milliseconds)  # A picture takes two frames of the model.
    driver = pygame.display.get_driver()
    app.close()
    return {
        "driver": driver,
        "frames": len(wall),
        "median_ms": float(np.median(wall)),
        "p95_ms": float(np.percentile(wall, 95)),
        "p99_ms": float(np.percentile(wall, 99)),
        "worst_ms": max(wall),
        "processor_p99_ms": float(np.percentile(processor, 99)),
        "late": int(np.sum(np.array(wall) > 1e3 * FRAME)),
        "physics_median_ms": float(np.median(physics)),
    }


def _opened_app() -> Any:
    """Return the application with all kernels loaded. The application plays the scene SCENE."""
    from softcradle.sandbox.window.app import App

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fifty.toml"
        path.write_text(SCENE)
        app = App(start=str(path), lab=True)
    app.warmup.complete.wait()
    app.frame(FRAME)
    app.act("play_pause")
    return app
