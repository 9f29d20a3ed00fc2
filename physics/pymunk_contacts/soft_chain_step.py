"""One discrete-gradient step for a chain of bodies that a pymunk Space moves, first by a drift and then by a kick.

Let X and V be the position and velocity of the body, and x = X + (h/2) V. Then drift and kick are the trapezoidal pair
of `conserving`:

    X1 = X0 + h V0,  V1 = V0 + h a    is    x1 = x0 + (h/2) (V0 + V1),  V1 = V0 + h a

so the overlaps d are those of x. They are stored separately, with more digits than differences of positions have. If
the bodies were moved by others, the overlaps are adjusted. `lag` is the part of the overlap of the bodies that the
contact must ignore: if a velocity jumps, x = X + (h/2) V jumps as well, although nothing has moved. It is reset when
the contact is open.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.contact_solve import DIAGONAL, END, FREE, HOLD, SOLVER_ROWS, loses, solve_contacts
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.law_kernels import EPSILON, energy
from softcradle.physics.numerics.records import ChainData, Dissipation, Motion, Strings
from softcradle.physics.numerics.switches import copy_into
from softcradle.physics.numerics.touching import TOUCHES, settle_touching

# Round-off of coordinates, relative to their size: what accumulates in a position over millions of steps.
PLACE_TOLERANCE = 4096.0 * EPSILON
RATE_TOLERANCE = 1024.0 * EPSILON  # Round-off of velocities, relative to their size.
DRIFT_TOLERANCE = 8.0 * EPSILON  # Round-off of a single drift X + h V, relative to its terms.

# Rows (n,) of the work array of `solve_chain_step`, after those of the solver; COUPLING takes two rows.
GIVEN, COUPLING = SOLVER_ROWS, SOLVER_ROWS + 1
CHAIN_ROWS = SOLVER_ROWS + 3


@jit
def overlap_at(i, touching, time, position, velocity):
    """Return the overlap [m] of bodies i and i+1 after they have moved at their velocities for `time` [s]."""
    x = position[i + 1, 0] - position[i, 0] + time * (velocity[i + 1, 0] - velocity[i, 0])
    y = position[i + 1, 1] - position[i, 1] + time * (velocity[i + 1, 1] - velocity[i, 1])
    return touching[i] - math.sqrt(x * x + y * y)


@jit
def closing_rate(i, direction, velocity):
    """Return the rate [m/s] at which bodies i and i+1 approach along the line between them."""
    return direction[i, 0] * (velocity[i, 0] - velocity[i + 1, 0]) + direction[i, 1] * (
        velocity[i, 1] - velocity[i + 1, 1]
    )


@jit
def extent(i, values):
    """Return the sum of the absolute values in rows i and i+1, the scale of the round-off of their difference."""
    return abs(values[i, 0]) + abs(values[i, 1]) + abs(values[i + 1, 0]) + abs(values[i + 1, 1])


@jit
def start_chain_step(h, touching, position, velocity, place, speed, overlap, rate, lag, outside, force):
    """Prepare the first step. The overlaps are those before the drift, as the user has placed the bodies."""
    # positions before the drift
    for b in range(position.shape[0]):
        for axis in range(2):
            place[b, axis] = position[b, axis] - h * velocity[b, axis]
            speed[b, axis] = velocity[b, axis]
    for i in range(overlap.size):
        # overlaps that are 0 up to round-off count as touching
        overlap[i] = overlap_at(i, touching, 0.0, place, speed)
        if abs(overlap[i]) <= DRIFT_TOLERANCE * (touching[i] + extent(i, position)):
            overlap[i] = 0.0
        lag[i] = overlap_at(i, touching, 0.5 * h, place, speed) - overlap[i]
        rate[i], outside[i], force[i] = 0.0, 0.0, 0.0


@jit
def begin_chain_step(h, h_before, touching, position, velocity, place, speed, direction, overlap, rate, lag, outside):
    """Adjust overlaps and rates to changes from outside since the last step; call it after the drift of the new step.

    `velocity` becomes the velocity of the drift: a change of velocity after the drift belongs to the end of the step.
    """
    # bodies: find velocities that were changed after the drift
    for b in range(position.shape[0]):
        # Compare the drift with the present velocity and with the velocity at the end of the last step. If only the
        # latter matches, the velocity was changed after the drift.
        drifted, as_before = True, True
        for axis in range(2):
            slack = DRIFT_TOLERANCE * (abs(position[b, axis]) + abs(h * velocity[b, axis]) + abs(h * speed[b, axis]))
            drifted &= abs(position[b, axis] - place[b, axis] - h * velocity[b, axis]) <= slack
            as_before &= abs(position[b, axis] - place[b, axis] - h * speed[b, axis]) <= slack
        if as_before and not drifted:
            velocity[b, 0], velocity[b, 1] = speed[b, 0], speed[b, 1]
    for i in range(overlap.size):
        # direction of the contact, and its rate if others have changed the velocities
        x, y = position[i + 1, 0] - position[i, 0], position[i + 1, 1] - position[i, 1]
        length = math.sqrt(x * x + y * y)  # math.hypot would round differently in plain Python
        direction[i, 0] = x / length if length > 0.0 else 0.0
        direction[i, 1] = y / length if length > 0.0 else 0.0
        closing = closing_rate(i, direction, velocity)
        if abs(closing - rate[i]) > RATE_TOLERANCE * extent(i, velocity):
            rate[i] = closing
        # the overlap at the end of the last step, with the new velocities, and as the positions give it now
        slack = PLACE_TOLERANCE * (touching[i] + extent(i, position))
        last = overlap_at(i, touching, 0.5 * h_before, place, speed)
        jumped = overlap_at(i, touching, 0.5 * h, place, velocity)
        now = overlap_at(i, touching, -0.5 * h, position, velocity)
        outside[i] *= h / h_before
        if abs(jumped - last) > slack:  # velocities or the step have changed, but no body was moved
            lag[i] += jumped - last
        if abs(now - jumped) > slack:  # bodies were moved
            overlap[i] += now - jumped
        # an open contact takes its overlap from the positions
        if overlap[i] < 0.0 and now < 0.0 and abs(now - overlap[i]) > slack:
            overlap[i], lag[i] = now, 0.0


@jit
def along(i, direction, j, mobility):
    """Return the change of the rate of contact i per impulse of contact j on a body with this `mobility`."""
    x = mobility[0, 0] * direction[j, 0] + mobility[0, 1] * direction[j, 1]
    y = mobility[1, 0] * direction[j, 0] + mobility[1, 1] * direction[j, 1]
    return direction[i, 0] * x + direction[i, 1] * y


@jit
def solve_chain_step(h, law, graph, loss, absorbed, bodies, lag, outside, overlap, rate, force, memory):
    """Write the mean forces of the step into `force`, and advance overlaps and rates.

    Return False if the solver did not converge.

    `bodies` holds four arrays: (n+1, 2, 2) change of the velocities per impulse, (n+1, 2) velocities at the end of the
    step without contacts, (n+1, 2) velocities of the drift, and (n, 2) directions of the contacts. `outside` (n,) is
    the change of the rates in the last step that these do not explain. `graph` has no rows. `loss` is (n,), or (0,) if
    nothing is lost. The dissipated energy is added to `absorbed` (1,). `memory` is scratch, (BEAD_ROWS, n+1) and
    (CHAIN_ROWS, n).
    """
    mobility, expected, velocity, direction = bodies
    beads, work = memory
    n = overlap.size
    diagonal, free, end, given = work[DIAGONAL], work[FREE], work[END], work[GIVEN]
    coupling = work[COUPLING : COUPLING + 2].reshape(2 * n)
    # matrix L of this row of bodies, and the motion without contact forces
    for i in range(n):
        diagonal[i] = along(i, direction, i, mobility[i]) + along(i, direction, i, mobility[i + 1])
        coupling[i] = along(i - 1, direction, i, mobility[i]) if i > 0 else 0.0
        given[i] = closing_rate(i, direction, expected) - closing_rate(i, direction, velocity) + outside[i]
        if loss.size and abs(overlap[i]) < TOUCHES * h * h * diagonal[i] * law[i, 0]:
            overlap[i] = 0.0
        free[i] = h * rate[i] + 0.5 * h * given[i]
        end[i] = overlap[i] if overlap[i] > 0.0 else overlap[i] + free[i]
    coupling[n] = 0.0
    none = coupling[:0]
    chain = ChainData(law, coupling, none, none, 0, graph, none, Dissipation(loss, none), Strings(none, 0.0))
    motion = Motion(overlap, rate, none, force, none, none, none)
    # mean forces and overlaps at the end of the step, as in `conserving`
    used = solve_contacts(h, chain, motion, beads, work)
    for i in range(n):
        held = False
        # energy that the contact dissipates: work of its force less the increase of the stored energy
        if loss.size and loses(loss[i], overlap[i], rate[i]):
            fall = energy(law[i, 0], law[i, 1], law[i, 2], overlap[i])
            fall -= energy(law[i, 0], law[i, 1], law[i, 2], end[i])
            absorbed[0] += force[i] * (end[i] - overlap[i]) + fall
            held = end[i] == work[HOLD, i]
        # rate at the end of the step, by the formula with the smaller round-off error
        own = diagonal[i] * force[i]
        if held:
            rate[i] = 0.0
        # for very small overlaps, their difference gives the rate more accurately
        elif max(abs(overlap[i]), abs(end[i])) < h * h * own:
            rate[i] = 2.0 * (end[i] - overlap[i]) / h - rate[i]
        else:
            own -= coupling[i] * force[i - 1] if i > 0 else 0.0
            own -= coupling[i + 1] * force[i + 1] if i < n - 1 else 0.0
            rate[i] += given[i] - h * own
        free[i], overlap[i] = overlap[i], end[i]
    # losses of bounces within the step change the rates, but not the overlaps
    if loss.size:
        copy_into(given, rate)
        settle_touching(h, free, diagonal, coupling, chain, motion, absorbed)
        for i in range(n):
            lag[i] += 0.5 * h * (rate[i] - given[i])
    return used >= 0


@jit
def end_chain_step(h, touching, position, velocity, place, speed, direction, overlap, rate, lag, outside):
    """Adjust the rates to unexpected forces of others in the step. These forces moved x, but not the overlaps."""
    for i in range(overlap.size):
        # a rate that the step does not explain
        closing = closing_rate(i, direction, velocity)
        missing = closing - rate[i]
        if abs(missing) > RATE_TOLERANCE * (extent(i, velocity) + extent(i, speed)):
            rate[i] = closing
            outside[i] += missing
            lag[i] += 0.5 * h * missing
        now = overlap_at(i, touching, 0.5 * h, position, velocity)
        if abs(now - overlap[i] - lag[i]) > PLACE_TOLERANCE * (touching[i] + extent(i, position)):
            overlap[i] = now - lag[i]  # the line between the bodies has turned
    # store positions and velocities of the bodies for the next step
    for b in range(position.shape[0]):
        for axis in range(2):
            place[b, axis], speed[b, axis] = position[b, axis], velocity[b, axis]
