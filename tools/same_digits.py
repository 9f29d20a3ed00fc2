"""Compare seven motions frame by frame and bitwise, computed in several environments.

    python -m tools.same_digits [--frames 1000] [--tiers "plain Python" Node ...]

The environments, called tiers, are plain Python, machine code, other processors and browsers. Each tier runs in a
separate process. The exit code is 1 if any bit of any frame differs.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, State, advance, power_law
from softcradle.physics.scales import default_step

from softcradle import scenes
from tools.wasm_runner import RUNNERS, WasmKernels, installed

FRAME = 1.0 / 60.0  # Duration of a frame of the viewer [s].
SLOW = 2.0  # Slow-motion factor of motions that are not scenes.
WITHOUT_FMA = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4", "NPY_DISABLE_CPU_FEATURES": "AVX512F AVX512_SKX"}
TIERS: dict[str, dict[str, str]] = {
    "machine code": {"SOFTCRADLE_COMPILE": "first"},
    "plain Python": {"NUMBA_DISABLE_JIT": "1"},
    "generic processor": {"SOFTCRADLE_COMPILE": "first", "NUMBA_CPU_NAME": "generic"},
    "C library without fused products": {"NUMBA_DISABLE_JIT": "1", **WITHOUT_FMA},
    **{name: {"NUMBA_DISABLE_JIT": "1"} for name in RUNNERS},
}

TIERS_HERE = [tier for tier in TIERS if tier not in RUNNERS or installed(tier)]

# A motion consists of a chain, initial velocities, forces and a slow-motion factor.
Motion = tuple[Chain, list[float], list[float] | None, float]


def motions() -> dict[str, Motion]:
    """Return the motions: four scenes, friction, loss, and forces on the ends of a chain."""
    soft, strike = power_law(1.0, 0.1), [1.0, 0.0, 0.0, 0.0, 0.0]
    found: dict[str, Motion] = {
        "1/14": (Chain([1.0] * 6, power_law(1.0, 1.0 / 14.0)), [*strike, 0.0], None, SLOW),
        "friction": (Chain([1.0] * 5, soft, friction=0.02), strike, None, SLOW),
        "loss": (Chain([1.0] * 5, power_law(1.0, 0.1, loss=0.2)), strike, None, SLOW),
        "pushed": (Chain([1.0] * 5, soft), strike, [0.3, 0.0, 0.0, 0.0, -0.1], SLOW),
    }
    for name in ("one-on-four", "draft-gear-one-on-three", "hertz-cradle"):
        scene = scenes.load(name)
        lane = scene.lanes[0]
        found[name] = lane.chain(), list(lane.velocity), None, scene.view.slow
    return found


def frames(motion: Motion, count: int, move: Any) -> NDArray[np.float64]:
    """Return time, overlaps, rates, anchor, forces and absorbed energies after each frame.

    The function `move` computes a frame.
    """
    chain, velocity, push, slow = motion
    state, step, rows = State.at_start(chain, velocity), default_step(chain, velocity), []
    state.push = None if push is None else np.array(push)
    for _ in range(count):
        move(chain, state, FRAME / slow, step)
        rows.append(
            np.concatenate(([state.time], state.overlap, state.rate, state.anchor, state.force, state.absorbed))
        )
    return np.array(rows)


def by_engine(chain: Chain, state: State, duration: float, step: float) -> None:
    """Compute one frame with the kernels of this process."""
    advance(chain, state, duration, "conserving", step=step)


def write_frames(tier: str, count: int, out: Path) -> None:
    """Compute the frames of all motions in this process, and write them to a file. The process belongs to `tier`."""
    if tier in RUNNERS:
        with RUNNERS[tier]() as run:
            found = {name: frames(motion, count, WasmKernels(run).advance) for name, motion in motions().items()}
    else:
        found = {name: frames(motion, count, by_engine) for name, motion in motions().items()}
    np.savez(out, **found)


def compare(tiers: list[str], count: int) -> bool:
    """Print which frames differ from the frames of the first tier. Return True if no frame differs."""
    found: dict[str, Any] = {}
    same = True
    with tempfile.TemporaryDirectory() as folder:
        for tier in tiers:
            out, began = Path(folder, "frames.npz"), perf_counter()
            command = [
                sys.executable,
                "-m",
                "tools.same_digits",
                "--frames",
                str(count),
                "--tiers",
                tier,
                "--write",
                str(out),
            ]
            subprocess.run(command, env=os.environ | TIERS[tier], check=True)
            with np.load(out) as file:
                found[tier] = dict(file)
            print(f"{tier}: {count} frames of {len(found[tier])} motions in {perf_counter() - began:.1f} s")
            for name, rows in found[tier].items():
                other = found[tiers[0]][name]
                differs = np.flatnonzero((rows.view(np.int64) != other.view(np.int64)).any(axis=1))
                if differs.size:
                    same = False
                    print(f"    {name}: frame {differs[0]} on, by {np.abs(rows - other).max():.1e} at most")
    print("every bit is the same" if same else "digits differ")
    return same


def main() -> int:
    """Run the command and return its exit code."""
    parser = argparse.ArgumentParser(prog="python -m tools.same_digits", description=__doc__)
    parser.add_argument("--frames", type=int, default=1000)
    parser.add_argument("--tiers", nargs="+", choices=list(TIERS), default=TIERS_HERE)
    parser.add_argument("--write", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.write:
        write_frames(options.tiers[0], options.frames, options.write)
        return 0
    return 0 if compare(options.tiers, options.frames) else 1


if __name__ == "__main__":
    sys.exit(main())
