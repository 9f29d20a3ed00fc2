"""Names of keys and contact laws in other programs and textbooks, and their replacements in scene files.

Tests: tests/scenes/test_file_mistakes.py
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from softcradle.physics.messages import Message

# Standard acceleration of gravity [m/s^2], used if the value of `gravity` is not a number.
STANDARD_GRAVITY = 9.81
# Largest number of forces that a hint lists one by one. A formula describes longer lists.
MOST_FORCES = 6

# Keys of other programs, and the keys of scene files with the same meaning.
SAME_KEYS = {
    "k": "stiffness",
    "spring_constant": "stiffness",
    "t_end": "duration",
    "end_time": "duration",
    "total_time": "duration",
    "dt": "step",
    "time_step": "step",
    "timestep": "step",
    "rtol": "tolerance",
    "solver": "method",
    "m": "mass",
    "masses": "mass",
    "v": "velocity",
    "v0": "velocity",
    "velocities": "velocity",
    "speed": "velocity",
    "n": "beads",
    "balls": "beads",
    "contacts": "contact",
    "mu": "friction",
    "string": "strings",
    "string_length": "strings",
    "pendulum_length": "strings",
    "name": "title",
    "description": "text",
    "slow_motion": "slow",
}
RESTITUTION = ("restitution", "coefficient_of_restitution", "cor", "e", "bounce", "bounciness", "elasticity")
GRAVITY = ("gravity", "g")
DAMPING = ("damping", "damper", "dashpot", "viscosity", "c")
SIZE = ("radius", "diameter", "width", "size", "bead_length")

SAME_LAWS = {
    "spring": "hooke",
    "linear": "hooke",
    "linear_spring": "hooke",
    "hookean": "hooke",
    "sphere": "hertz",
    "spheres": "hertz",
    "hertzian": "hertz",
    "constant": "step_force",
    "constant_force": "step_force",
    "powerlaw": "power_law",
    "power-law": "power_law",
}


class Remedy(NamedTuple):
    """Advice on an unknown key: a sentence and, if there is one, the valid key with the same meaning."""

    sentence: str
    meant: str | None = None


def remedy_of(key: str, table: Mapping[str, Any], allowed: Sequence[str]) -> Remedy | None:
    """Return advice on the unknown `key` of `table`, or None if its meaning cannot be guessed."""
    name = key.lower()
    if name in RESTITUTION:
        return Remedy(Message("restitution", "give the contact {loss}", loss=_loss(table[key])))
    if name in GRAVITY and "drive" in allowed:
        drive = _drive(table[key], table)
        return Remedy(
            Message("drive_for_gravity", "use drive, the steady force on each bead in N: {drive}", drive=drive)
        )
    if name in DAMPING:
        return Remedy(
            Message("damping", "a contact loses energy by its loss, and loss = 1 - e**2 for a restitution of e")
        )
    if name in SIZE and "slow" not in allowed:
        return Remedy(
            Message("size", "the length of a bead is only drawn: give length below [view], or the distances as gap")
        )
    meant = SAME_KEYS.get(name)
    if meant in allowed:
        return Remedy(Message("same_key", "the key is {key!r}", key=meant), None if meant in table else meant)
    return None


def _number(value: Any) -> float | None:
    """Return `value` as a finite number. Text such as "0.8" is also accepted. Otherwise return None."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if math.isfinite(number) else None


def _loss(value: Any) -> str:
    """Return advice about the loss of a contact whose coefficient of restitution is `value`."""
    restitution = _number(value)
    if restitution is None or not 0.0 <= restitution <= 1.0:
        return Message("loss_rule", "loss = 1 - e**2 with the restitution e")
    if restitution == 0.0:
        return Message(
            "loss_below_one",
            "loss = 1 - e**2, which must be below 1: a restitution of 0 cannot be computed, 0.01 can (loss = 0.9999)",
        )
    return Message("loss_here", "loss = 1 - e**2, here {key}", key=f"loss = {1.0 - restitution**2:.6g}")


def _drive(value: Any, table: Mapping[str, Any]) -> str:
    """Return advice about the key `drive`. The advice contains the weights of the beads in `table`."""
    gravity = _number(value)
    known = STANDARD_GRAVITY if gravity is None else gravity
    rule = f"drive = mass * {known:g}"
    mass, velocity = table.get("mass", 1.0), table.get("velocity")
    count = len(mass) if isinstance(mass, list | tuple) else table.get("beads", 0)
    if isinstance(count, list | tuple):
        count = sum(count) if all(type(part) is int for part in count) else 0
    if not count and isinstance(velocity, list | tuple):
        count = len(velocity)
    masses = [_number(one) for one in mass] if isinstance(mass, list | tuple) else [_number(mass)]
    if type(count) is not int or not 2 <= count <= MOST_FORCES or None in masses:
        return rule
    forces = [f"{one * known:.6g}" for one in masses if one is not None]
    drive = ", ".join(forces * count if len(forces) == 1 else forces)
    return Message("drive_here", "{rule}, here {drive}", rule=rule, drive=f"drive = [{drive}]")
