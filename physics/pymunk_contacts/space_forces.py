"""Forces of a Space on some bodies in the current step, without contact forces: gravity, damping, forces and strings.

A SoftChain needs these forces to solve its contacts. Otherwise it would treat the bodies as free. A string absorbs a
part of each impulse, and this energy would then be lost.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pymunk
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Fraction of the length of a string. If the string is nearer to its full length than this, it counts as taut.
TAUT = 1e-6
# Fraction of an impulse along a string that the string absorbs. With 1 the body could not move, and its contact force
# would be infinite.
STIFFNESS = 1.0 - 1e-4


@dataclass
class SpaceForces:
    """Bodies during a step, and their response to impulses of contacts. pymunk has moved them, but not changed their
    velocities.

    Attributes:
        position: (n, 2) centres of gravity [m].
        velocity: (n, 2) velocities [m/s].
        expected: (n, 2) velocities at the end of the step without contact forces [m/s].
        mobility: (n, 2, 2) change of velocity at the end of the step per impulse on the centre [1/kg].
    """

    position: Array
    velocity: Array
    expected: Array
    mobility: Array

    @classmethod
    def of(cls, space: pymunk.Space, bodies: tuple[pymunk.Body, ...], step: float) -> SpaceForces:
        """Return the forces on `bodies` in the current step. Call it in a callback during a step of `space`."""
        position, velocity = centres(bodies)
        inverse_mass = np.array([1.0 / body.mass if body.body_type == body.DYNAMIC else 0.0 for body in bodies])
        force = np.array([body.force for body in bodies])
        # pymunk applies damping before it adds gravity and forces.
        moved = (inverse_mass > 0.0)[:, None]
        damping = space.damping**step
        kicked = damping * velocity + step * (np.array(space.gravity) + inverse_mass[:, None] * force)
        found = cls(
            position, velocity, np.where(moved, kicked, velocity), damping * inverse_mass[:, None, None] * np.eye(2)
        )
        # A taut string removes velocity and mobility along its direction.
        for i, body in enumerate(bodies):
            if inverse_mass[i]:
                for direction, speed in _strings(space, body, position[i]):
                    _hold(found.expected[i], found.mobility[i], direction, speed)
        return found


def centres(bodies: tuple[pymunk.Body, ...]) -> tuple[Array, Array]:
    """Return the centres of gravity (n, 2) and their velocities (n, 2)."""
    position = np.array([body.local_to_world(body.center_of_gravity) for body in bodies])
    return position, np.array([body.velocity for body in bodies])


def _strings(space: pymunk.Space, body: pymunk.Body, centre: Array) -> Iterator[tuple[Array, float]]:
    """Yield each string from a body to a kinematic or static body.

    A string is given by its direction from the centre of the body, and by the speed [m/s] along this direction. Strings
    are pin joints, and slide joints that are taut, if their force is not limited.
    """
    for joint in body.constraints:
        if not isinstance(joint, (pymunk.PinJoint, pymunk.SlideJoint)):
            continue
        # A joint with a limited force may stretch, so it is not a string.
        if joint.max_force == np.inf and joint in space.constraints:
            other, anchor = (joint.b, joint.anchor_b) if joint.a is body else (joint.a, joint.anchor_a)
            end = other.local_to_world(anchor)
            line = centre - np.array(end)
            length = float(np.hypot(*line))
            slack = isinstance(joint, pymunk.SlideJoint) and length < joint.max * (1.0 - TAUT)
            if other.body_type != body.DYNAMIC and length > 0.0 and not slack:
                direction = line / length
                yield direction, float(direction @ np.array(other.velocity_at_world_point(end)))


def _hold(expected: Array, mobility: Array, direction: Array, speed: float) -> None:
    """Apply the constraint of a string, in place.

    The constraint removes the velocity beyond `speed` along the string, and the mobility along the string.
    """
    # Projection: the impulse of the string changes the velocity along the string to `speed`.
    pulled = mobility @ direction
    yielding = float(direction @ pulled)
    if yielding > 0.0:
        expected -= pulled * ((direction @ expected - speed) / yielding)
        mobility -= STIFFNESS * np.outer(pulled, pulled) / yielding
