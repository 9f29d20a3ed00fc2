"""Warnings about collisions in a Space: a time step that is too long, and bodies that pass through each other."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any
from weakref import WeakKeyDictionary

import pymunk
from softcradle.physics.pymunk_contacts.post_step import call_after_step

# Factor of growth of the collision speed or of the step after which the step is checked again.
FASTER = 1.1
# Part of the touching distance within which the recommended stiffness absorbs the energy of the collision. The rest is
# a margin. The margin is needed because pymunk's positions lag by half a step, and because other forces may press the
# bodies together.
HELD = 0.7


@dataclass
class BlowWatch:
    """Record of the collisions in one Space, and of the warnings about them.

    Attributes
    ----------
    fastest : float
        Speed of the fastest collision of a SoftContact so far [m/s].
    too_long, passed : set of str
        Contact laws for which a warning has been given: that the step is too long, and that bodies have passed each
        other.
    """

    fastest: float = 0.0
    too_long: set[str] = field(default_factory=set)
    passed: set[str] = field(default_factory=set)


_watches: WeakKeyDictionary[pymunk.Space, BlowWatch] = WeakKeyDictionary()


def watch_of(space: pymunk.Space) -> BlowWatch:
    """Return the BlowWatch of a Space."""
    return _watches.setdefault(space, BlowWatch())


def warn_after_step(constraint: pymunk.Constraint, sentence: str) -> None:
    """Warn at the end of the current step, with the line that called ``space.step`` as its source."""
    call_after_step(constraint, lambda: warnings.warn(sentence, RuntimeWarning, stacklevel=5))


def kinetic_energy(bodies: Iterable[pymunk.Body]) -> float:
    """Return the kinetic energy [J] that the contacts between `bodies` can absorb.

    The velocities are relative to a body that contacts cannot move. If there are several such bodies, the one with the
    largest result is used. Without such a body, the velocities are relative to the centre of mass.
    """
    found = list(bodies)
    moving = [body for body in found if body.body_type == pymunk.Body.DYNAMIC]
    frames = [body.velocity for body in found if body.body_type != pymunk.Body.DYNAMIC]
    if not frames:
        # Without a fixed body, the velocity of the common centre of mass does not change.
        momentum = sum((body.mass * body.velocity for body in moving), pymunk.Vec2d(0.0, 0.0))
        frames = [momentum / sum(body.mass for body in moving)]
    turning = sum(0.5 * body.moment * body.angular_velocity**2 for body in moving if body.angular_velocity)
    return turning + max(
        sum(0.5 * body.mass * (body.velocity - frame).length ** 2 for body in moving) for frame in frames
    )


def passing_sentence(what: str, law: Any, energy: float, touching: float) -> str:
    """Return the warning that two bodies have passed through each other. The warning recommends a stiffness that would
    have stopped the bodies.

    Parameters
    ----------
    what : str
        Name of the two bodies.
    law : Contact or OwnLaw
        Law of the contact between them.
    energy : float
        Energy of the collision [J].
    touching : float
        Touching distance [m].
    """
    # Compare the energy of the collision with the energy that the contact stores up to the fraction HELD of its depth.
    held = law.energy(HELD * touching)
    times = energy / held if held > 0.0 else math.inf
    begin = f"{what} passed through each other"
    if times <= 1.0:
        return f"{begin} within one step, though the contact between them is stiff enough: take shorter steps"
    # For a power law, name the parameters to set. For any other law, name only the factor.
    name = getattr(law, "name", None) or str(law)
    way_out = f"a force {times:.3g} times as large"
    if getattr(law, "stiffness", 0.0) and not law.preload:
        way_out = f"a stiffness of {_rounded_up(times * law.stiffness):g}"
    elif getattr(law, "stiffness", None) is not None:
        preload, stiffness = (_rounded_up(times * value) for value in (law.preload, law.stiffness))
        way_out = f"preload={preload:g}, stiffness={stiffness:g}"
    return (
        f"{begin}: the blow pressed them in by the whole touching distance of {touching:.4g} m. They would hold with {way_out}. "
        f"The contact: {name}"
    )


def _rounded_up(value: float) -> float:
    """Return `value` rounded up to two digits."""
    if value == 0.0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / unit) * unit
