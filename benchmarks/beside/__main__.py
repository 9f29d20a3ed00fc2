"""Comparison of a cradle between two walls in softcradle, pymunk and web engines.

    python -m benchmarks.beside > docs/measured/beside.md

Five balls of 1 kg and 1 m touch. The first ball arrives with 1 m/s from a distance of a metre. There is a metre of room
to the walls on both sides. Steel balls are hard and lose no energy (in softcradle: Hertz). Soft balls push with f0 *
overlap**0.1. In engines without such a contact, this force is applied before each step. The command needs node, and
`npm install` in this folder.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pymunk
from softcradle.sandbox.story.numbers import MINUS

from softcradle import Chain, SoftChain, hertz, power_law, simulate

TIMES = "\u00d7"
HERE = Path(__file__).parent
RADIUS, GAP, SPEED, BALLS = 0.5, 1.0, 1.0, 5
# Strength f0 and exponent alpha of the soft balls, and Hertz stiffness of the steel balls. With it, two steel balls
# overlap by 7 % of a diameter.
SOFT, STEEL = (1.0, 0.1), 500.0
STEP = 1 / 60
MOST, LONGEST = 1000, 4000.0  # Number of collisions, and the longest time for them [s].
FIRST = {"steel": 1.7, "soft": 3.5}  # Time [s] after the first collision and before a ball hits a wall.
# Gap [m] from which on two balls count as touching. This gap is larger than the movement in a step. A gap that falls
# below it, after it was twice as large, is counted as a collision.
TOUCHING = 0.02
PLACES = [k - BALLS / 2 + 0.5 - (GAP if k == 0 else 0.0) for k in range(BALLS)]
WALLS = [PLACES[0] - RADIUS - GAP, PLACES[-1] + RADIUS + GAP]  # Positions of the surfaces of the walls.


def setup(kind: str, step: float) -> dict:
    """Return the initial state for an engine. The walls are half a metre thick."""
    return {
        "places": PLACES, "speeds": [SPEED] + [0.0] * (BALLS - 1), "radius": RADIUS, "step": step, "law": SOFT,
        "walls": [WALLS[0] - 0.5, WALLS[1] + 0.5], "rigid": kind == "steel", "most": MOST, "first": FIRST[kind],
        "longest": LONGEST, "touching": TOUCHING,
    }  # fmt: skip


def by_softcradle(kind: str, step: float) -> dict:
    """Simulate with the method conserving and walls of infinite mass."""
    contact = hertz(STEEL) if kind == "steel" else power_law(*SOFT)
    chain = Chain([math.inf, *[1.0] * BALLS, math.inf], contact, gap=[GAP, GAP, *[0.0] * (BALLS - 2), GAP])
    start = [0.0, SPEED, *[0.0] * BALLS]
    settings = {"samples": 2, "method": "conserving", "step": step}
    early = simulate(chain, start, duration=FIRST[kind], **settings)
    found = simulate(chain, start, duration=LONGEST, **settings)
    closings = sorted(begin for spans in found.contact_intervals[1:-1] for begin, _ in spans)[:MOST]
    found = simulate(chain, start, duration=closings[-1], **settings)
    energy = 0.5 * (found.final_velocity[1:-1] ** 2).sum() + chain.stored_energy(found.overlap[-1]).sum()
    return {
        "first": early.final_velocity[1:-1].tolist(), "collisions": len(closings), "time": closings[-1], "energy": float(energy),
        "ordered": bool((found.overlap < 2 * RADIUS).all()), "velocities": found.final_velocity[1:-1].tolist(),
    }  # fmt: skip


def by_pymunk(kind: str, step: float, chain: bool) -> dict:
    """Simulate with pymunk.

    The balls are hard, or forces are applied before each step. With `chain`, the contacts are those of softcradle.
    """
    space = pymunk.Space()
    balls = [pymunk.Body(1.0, math.inf) for _ in range(BALLS)]
    ends = [pymunk.Body(body_type=pymunk.Body.STATIC) for _ in WALLS]
    for end, face, side in zip(ends, WALLS, (-1, 1), strict=True):
        end.position = face + side * RADIUS, 0.0
    space.add(*balls)
    for ball, place in zip(balls, PLACES, strict=True):
        ball.position = place, 0.0
        if kind == "steel" and not chain:
            circle = pymunk.Circle(ball, RADIUS)
            circle.elasticity, circle.friction = 1.0, 0.0
            space.add(circle)
    balls[0].velocity = SPEED, 0.0
    links = None
    if chain:
        contact = hertz(STEEL) if kind == "steel" else power_law(*SOFT)
        links = SoftChain([ends[0], *balls, ends[1]], contact, 2 * RADIUS)
        space.add(*ends, *links)
    elif kind == "steel":
        for end in ends:
            box = pymunk.Poly.create_box(end, (2 * RADIUS, 10))
            box.elasticity, box.friction = 1.0, 0.0
            space.add(end, box)
    return _stepped(space, balls, links, kind, step)


def _stepped(space: pymunk.Space, balls: list[pymunk.Body], links: SoftChain | None, kind: str, step: float) -> dict:
    collisions, ordered, early, time, open_gaps = 0, True, None, 0.0, np.zeros(BALLS - 1, dtype=bool)
    while collisions < MOST and time < LONGEST:
        if links is None and kind == "soft":
            for ball, force in zip(balls, _soft_forces(_places(balls)), strict=True):
                ball.force = force, 0.0
        space.step(step)
        time += step
        gaps = np.diff(_places(balls)) - 2 * RADIUS
        ordered = ordered and bool((gaps > -2 * RADIUS).all())
        collisions += int((open_gaps & (gaps < TOUCHING)).sum())
        open_gaps = (open_gaps | (gaps > 2 * TOUCHING)) & (gaps >= TOUCHING)
        if early is None and time >= FIRST[kind]:
            early = [ball.velocity.x for ball in balls]
    speeds = [ball.velocity.x for ball in balls]
    kinetic = sum(0.5 * v * v for v in speeds)
    stored = links.energy if links is not None else _stored(_places(balls)) if kind == "soft" else 0.0
    return {
        "first": early,
        "collisions": collisions,
        "time": time,
        "ordered": ordered,
        "energy": kinetic + stored,
        "velocities": speeds,
    }


def _places(balls: list[pymunk.Body]) -> np.ndarray:
    return np.array([ball.position.x for ball in balls])


def _overlaps(x: np.ndarray) -> np.ndarray:
    """Return the overlaps with the left wall, between the balls, and with the right wall."""
    return np.maximum(
        np.concatenate(([WALLS[0] + RADIUS - x[0]], 2 * RADIUS - np.diff(x), [x[-1] - WALLS[1] + RADIUS])), 0.0
    )


def _soft_forces(x: np.ndarray) -> list[float]:
    overlap = _overlaps(x)
    pushes = np.where(overlap > 0.0, SOFT[0] * overlap ** SOFT[1], 0.0)
    return (pushes[:-1] - pushes[1:]).tolist()


def _stored(x: np.ndarray) -> float:
    return float((SOFT[0] * _overlaps(x) ** (1 + SOFT[1])).sum() / (1 + SOFT[1]))


def row(name: str, found: dict) -> str:
    """Return one row of the table as text."""
    energy = found["energy"] / (0.5 * SPEED**2)
    change = f"{energy - 1:+.0e}".replace("-", MINUS) if abs(energy - 1) < 0.005 else f"{TIMES} {energy:.3g}"
    order, seen = "kept" if found["ordered"] else "lost", f"{found['collisions']} in {found['time']:.0f} s"
    return f"| {name} | {_speeds(found['first'])} | {seen} | {change} | {order} | {_speeds(found['velocities'])} |"


def _speeds(values: list[float]) -> str:
    return ", ".join(f"{v:.2f}".replace("-", MINUS) for v in values)


def main() -> None:
    kinds = (("steel", STEP), ("soft", STEP))
    done = subprocess.run(
        ["node", "engines.mjs"],
        cwd=HERE,
        input=json.dumps([setup(*kind) for kind in kinds]),
        capture_output=True,
        text=True,
        check=True,
    )
    packages = json.loads((HERE / "package.json").read_text(encoding="utf-8"))["dependencies"]
    print(
        f"Versions: softcradle {version('softcradle')}, pymunk {version('pymunk')}, "
        + ", ".join(f"{k} {v}" for k, v in packages.items())
        + "\n"
    )
    for (kind, step), engines in zip(kinds, json.loads(done.stdout), strict=True):
        results = {
            "softcradle": by_softcradle(kind, step),
            "pymunk with `SoftChain`": by_pymunk(kind, step, True),
            "pymunk": by_pymunk(kind, step, False),
        }
        print(f"## Five {kind} balls, steps of 1/{1 / step:.0f} s\n")
        print("| | velocities after the first collision (m/s) | collisions | energy | order | velocities then (m/s) |")
        print(f"|{'---|' * 6}")
        for name, found in {**results, **engines}.items():
            print(row(name, found))
        print()


if __name__ == "__main__":
    sys.exit(main())
