"""Forces of a Space on some bodies in the step under way, other than their contacts: gravity, damping, forces, strings.

Without them the contacts of a SoftChain would be solved as if the bodies were free, and the part of an impulse that a string
takes back would be energy lost.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pymunk
from numpy.typing import NDArray

Array = NDArray[np.float64]

TAUT = 1e-6  # of the length of a string: nearer to its end than this it is taut
STIFFNESS = 1.0 - 1e-4  # part of an impulse that a string takes; a body without any mobility would have no finite force


@dataclass
class SpaceForces:
    """Bodies in a step, after the drift and before the kick, and how they will respond to impulses of contacts.

    Attributes:
        position: (n, 2) centres of gravity [m].
        velocity: (n, 2) velocities [m/s].
        expected: (n, 2) velocities at the end of the step without contact forces [m/s].
        mobility: (n, 2, 2) change of velocity at the end of the step by an impulse on the centre [1/kg].
    """

    position: Array
    velocity: Array
    expected: Array
    mobility: Array

    @classmethod
    def of(cls, space: pymunk.Space, bodies: tuple[pymunk.Body, ...], step: float) -> SpaceForces:
        """The forces on `bodies`, in a callback of a step of `space`."""
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
    """A string from a body's centre to a kinematic or static body; it holds the speed along itself at `speed` [m/s]."""

    direction: Array
    speed: float

    def hold(self, expected: Array, mobility: Array) -> None:
        """Remove the motion and the mobility along the string, in place."""
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
    """The pin joints and taut slide joints of `body` as strings."""
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
