"""What the rest of a Space will do to some bodies in the step under way, as far as it can be told beforehand.

Gravity, damping, forces and strings: without them the contacts of a SoftChain would push bodies as if they were free,
and what a string takes back of such a push is energy lost.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pymunk
from numpy.typing import NDArray

Array = NDArray[np.float64]

TAUT = 1e-6  # of its length: a string nearer to its end than this is taut
STIFFNESS = 1.0 - 1e-4  # part of an impulse that a string takes: a body that could not move at all has no finite forces


@dataclass
class Surroundings:
    """Bodies in a step, between drift and kick.

    Attributes:
        position: (n, 2) centres of gravity [m].
        velocity: (n, 2) velocities [m/s].
        expected: (n, 2) velocities at the end of the step if no contact pushes [m/s].
        mobility: (n, 2, 2) change of velocity at the end of the step by an impulse on the centre [1/kg].
    """

    position: Array
    velocity: Array
    expected: Array
    mobility: Array

    @classmethod
    def of(cls, space: pymunk.Space, bodies: tuple[pymunk.Body, ...], step: float) -> Surroundings:
        """Look at `bodies` in a callback of a step of `space`."""
        position, velocity = centres(bodies)
        inverse_mass = np.array([1.0 / body.mass if body.body_type == body.DYNAMIC else 0.0 for body in bodies])
        force = np.array([body.force for body in bodies])
        moved = (inverse_mass > 0.0)[:, None]
        damping = space.damping**step
        kicked = damping * velocity + step * (np.array(space.gravity) + inverse_mass[:, None] * force)
        found = cls(
            position, velocity, np.where(moved, kicked, velocity), damping * inverse_mass[:, None, None] * np.eye(2)
        )
        for i, body in enumerate(bodies):
            if inverse_mass[i]:
                for line in _strings(body, position[i]):
                    line.hold(found.expected[i], found.mobility[i])
        return found


@dataclass
class _String:
    """A string from a body's centre to something that does not give way; it keeps the speed along itself at `speed`."""

    direction: Array
    speed: float

    def hold(self, expected: Array, mobility: Array) -> None:
        """Take out what the string does not allow, in place."""
        pulled = mobility @ self.direction
        yielding = float(self.direction @ pulled)
        if yielding > 0.0:
            expected -= pulled * ((self.direction @ expected - self.speed) / yielding)
            mobility -= STIFFNESS * np.outer(pulled, pulled) / yielding


def centres(bodies: tuple[pymunk.Body, ...]) -> tuple[Array, Array]:
    """(n, 2) centres of gravity and (n, 2) their velocities."""
    position = np.array([body.local_to_world(body.center_of_gravity) for body in bodies])
    return position, np.array([body.velocity for body in bodies])


def _strings(body: pymunk.Body, centre: Array) -> list[_String]:
    """Pin and taut slide joints of `body`."""
    joints = [joint for joint in body.constraints if isinstance(joint, (pymunk.PinJoint, pymunk.SlideJoint))]
    return [line for line in (_string(joint, body, centre) for joint in joints) if line is not None]


def _string(joint: pymunk.PinJoint | pymunk.SlideJoint, body: pymunk.Body, centre: Array) -> _String | None:
    other, anchor = (joint.b, joint.anchor_b) if joint.a is body else (joint.a, joint.anchor_a)
    if other.body_type == body.DYNAMIC:
        return None
    end = other.local_to_world(anchor)
    line = centre - np.array(end)
    length = float(np.hypot(*line))
    if length == 0.0 or (isinstance(joint, pymunk.SlideJoint) and length < joint.max * (1.0 - TAUT)):
        return None
    direction = line / length
    return _String(direction, float(direction @ np.array(other.velocity_at_world_point(end))))
