"""Contact law as a curve of (overlap, force) for implicit steps, and the collocation nodes of these steps.

Each contact is in one mode during a whole step, so the motion within a step is smooth. The caller ends a step when a
mode ends:

    OPEN      f = 0 for any d                   LOADED    f = F + K d**a; with preload or a = 1 continued to d < 0,
    TOUCHING  d = 0, f any number                         else 0 there

For a user-defined contact law the curve is its table. Its row of `law` holds the power law with which the table begins
at d = 0; the F, K and a of this row decide if the contact counts as soft and if the curve is continued. A contact with
several segments is on one of them: its row of `law` holds the numbers of this segment, and its overlap counts from the
origin of it.
"""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics.numerics.elementary import power
from softcradle.physics.numerics.graph_kernels import has_segments
from softcradle.physics.numerics.jit import inlined, jit, piece
from softcradle.physics.numerics.knots import drive_at
from softcradle.physics.numerics.records import FORCE_FROM, FROM
from softcradle.physics.numerics.swing import string_pull
from softcradle.physics.numerics.table_kernels import has_table, table_inverse, table_slope, table_value

ROOT6 = math.sqrt(6.0)
# Nodes of the three-stage Radau IIA method (Hairer & Wanner, Solving Ordinary Differential Equations II, IV.5).
NODES = np.array([(4.0 - ROOT6) / 10.0, (4.0 + ROOT6) / 10.0, 1.0])
MOST_CARE = 1e4  # Upper limit of the weight that a soft contact with many oscillations has in the error norm.
SMALLEST = 1e-290  # Overlap [m] below which a contact counts as having overlap 0; its curve is vertical there.
# Fraction of the preload. If a force differs less from the preload, the difference is mostly round-off.
LOST = 1e-6
# Fraction of the overlap. For a smaller relative change, four terms of the binomial series give a power to full
# precision.
SHORT_MOVE = 5e-4
# Ratio of the overlap to `weight` f below which the force decides the motion, see `move_along`.
DECIDES = 0.1
# Derivative of d + `weight` f by d below which the overlap decides the motion; 1 without a force.
NEARLY_FREE = 2.0
# Further columns of `law`, after preload, stiffness and exponent, if contacts have several segments.
LAW_BEFORE, LAW_STOP, LAW_SIDE = 3, 4, 5


@inlined
def signed_force(preload, stiffness, exponent, continued, y):
    """Return ``F + K y**a``. For y < 0 the power is continued as an odd function if `continued`, else the force is 0."""
    if y > 0.0:
        return preload + stiffness * power(y, exponent)
    # no continuation: the force of an open contact is 0
    if not continued:
        return 0.0
    if y == 0.0:
        return preload
    return preload - stiffness * power(-y, exponent)


@inlined
def slope_at(preload, stiffness, exponent, overlap, force):
    """Return df/dd on the curve: inf if the curve is vertical, 0 if the contact is open."""
    if exponent == 1.0:
        return stiffness
    # at overlap 0 a power law with a < 1 is vertical, and one with a > 1 is flat
    if abs(overlap) < SMALLEST:
        return math.inf if exponent < 1.0 else 0.0
    if overlap < 0.0 and preload == 0.0:
        return 0.0
    # d f/dd = a (f - F) / d; the power is computed anew if f - F has lost its digits
    own = force - preload
    if abs(own) < LOST * preload:
        own = math.copysign(stiffness * power(abs(overlap), exponent), overlap)
    return exponent * own / overlap


@inlined
def care(exponent, swing, faster):
    """Return the weight of a contact in the error norm: 1 + min(h²ω², 1) min(ω/ω_slowest, MOST_CARE) for a < 1, else 1.

    `swing` is h²ω², the squared product of the step and the local angular frequency. `faster` is (ω/ω_slowest)². A soft
    contact deep inside a cluster oscillates about its quasi-static overlap, and the faster it is, the more often it
    does so. A step as long as a period damps this oscillation each time. The loss appears at the end as an error of a
    velocity, which openings amplify.
    """
    return 1.0 + min(swing, 1.0) * min(math.sqrt(faster), MOST_CARE) if exponent < 1.0 else 1.0


@inlined
def larger(a, b):
    """Return the larger error, or NaN if either is NaN. (``max`` can drop a NaN.)"""
    return b if b > a or math.isnan(b) else a


@jit
def depth_at(preload, stiffness, exponent, energy):
    """Return an upper bound of the overlap [m] at which a contact stores `energy` [J].

    It is the smaller of two overlaps: one at which only the preload stores this energy, and one at which only the power
    law does.
    """
    # E >= F d and E >= K d**(1+a) / (1+a) each bound the overlap
    depth = energy / preload if preload > 0.0 else math.inf
    if stiffness > 0.0:
        depth = min(depth, power((1.0 + exponent) * energy / stiffness, 1.0 / (1.0 + exponent)))
    return depth


@inlined
def by_table(graph, i, overlap):
    """Return True if the force of contact i at `overlap` comes from a table.

    Below the first accurate overlap of a table, the power law with which it begins is used instead.
    """
    return has_table(graph, i) and abs(overlap) >= graph.segment[graph.first[i], FROM]


@inlined
def pressed_force(law, graph, i, overlap):
    """Return the force [N] of contact i, a power law or a table, at an overlap > 0."""
    if by_table(graph, i, overlap):
        return table_value(graph, graph.force, graph.first[i], overlap)
    return law[i, 0] + law[i, 1] * power(overlap, law[i, 2])


@inlined
def is_continued(law, graph, i):
    """Return True if the curve is continued beyond d = 0 within a step, so that the opening of a loaded contact is an event."""
    return law[i, 0] != 0.0 or law[i, 2] == 1.0 or (has_segments(graph, i) and law[i, 2] > 1.0)


@inlined
def is_smooth(law, graph, i):
    """Return True if the force begins with slope 0. A loaded contact then opens within a step, without an event."""
    return law[i, 2] > 1.0 and not is_continued(law, graph, i)


@inlined
def curve_force(law, graph, i, overlap):
    """Return the force of contact i in mode LOADED at any overlap; see `signed_force` and `signed_table`."""
    continued = is_continued(law, graph, i)
    if graph.kind.size:
        if overlap != 0.0 and by_table(graph, i, overlap):
            return signed_table(law, graph, i, overlap)
        # A segment: the power law begins `before` its origin, and a stop without loss acts from the origin on.
        if has_segments(graph, i):
            side, x = law[i, LAW_SIDE], law[i, LAW_SIDE] * overlap
            own = signed_force(law[i, 0], law[i, 1], law[i, 2], continued, x + law[i, LAW_BEFORE])
            return side * (own + law[i, LAW_STOP] * x)
    return signed_force(law[i, 0], law[i, 1], law[i, 2], continued, overlap)


@inlined
def curve_slope(law, graph, i, overlap, force):
    """Return df/dd of contact i in mode LOADED at a point of its curve, inf if the curve is vertical there; see `slope_at`."""
    if graph.kind.size:
        if abs(overlap) >= SMALLEST and by_table(graph, i, overlap):
            continued = overlap > 0.0 or is_continued(law, graph, i)
            return table_slope(graph, graph.first[i], abs(overlap)) if continued else 0.0
        if has_segments(graph, i) and law[i, 2] >= 1.0:
            return segment_slope(law, i, overlap)
    return slope_at(law[i, 0], law[i, 1], law[i, 2], overlap, force)


@inlined
def segment_slope(law, i, overlap):
    """Return the derivative of the force of a segment by the overlap if a >= 1."""
    y = abs(law[i, LAW_SIDE] * overlap + law[i, LAW_BEFORE])
    if law[i, 2] == 1.0:
        return law[i, 1] + law[i, LAW_STOP]
    return law[i, LAW_STOP] + (law[i, 2] * law[i, 1] * power(y, law[i, 2] - 1.0) if y > SMALLEST else 0.0)


@inlined
def curve_overlap(law, graph, i, excess, part):
    """Return the overlap of contact i in mode LOADED at which its force exceeds the preload by ``excess / part`` > 0."""
    if has_table(graph, i) and excess / part >= graph.segment[graph.first[i], FORCE_FROM]:
        return table_inverse(graph, graph.force, graph.first[i], law[i, 0] + excess / part)
    return power(excess / (part * law[i, 1]), 1.0 / law[i, 2])


@inlined
def curve_depth(law, graph, i, energy):
    """Return the overlap at which contact i stores `energy`; see `depth_at`."""
    if has_table(graph, i):
        return table_inverse(graph, graph.energy, graph.first[i], energy)
    return depth_at(law[i, 0], law[i, 1], law[i, 2], energy)


@inlined
def local_exponent(law, graph, i, overlap, force):
    """Return d f'/(f - F) of contact i at an overlap > 0. For a power law this is the exponent a."""
    if force != law[i, 0] and by_table(graph, i, overlap):
        return overlap * table_slope(graph, graph.first[i], overlap) / (force - law[i, 0])
    return law[i, 2]


@jit
def signed_table(law, graph, i, overlap):
    """Return the force of a table at an overlap other than 0. For d < 0 it is continued like `signed_force`."""
    if overlap > 0.0:
        return table_value(graph, graph.force, graph.first[i], overlap)
    if not is_continued(law, graph, i):
        return 0.0
    return 2.0 * law[i, 0] - table_value(graph, graph.force, graph.first[i], -overlap)


@inlined
def short_growth(x, a):
    """Return (1 + x)**a - 1 for abs(x) < SHORT_MOVE, by four terms of the binomial series."""
    return a * x * (1.0 + (a - 1.0) * x * (1.0 / 2.0 + (a - 2.0) * x * (1.0 / 6.0 + (a - 3.0) * x * (1.0 / 24.0))))


@inlined
def move_along(law, graph, i, weight, overlap, force, by_overlap, by_force):
    """Return overlap and force after one Newton move along the curve, in the variable in which it cannot overshoot.

    `weight` = h² L_ii is the change of the overlap per unit of force in a step. With a >= 1 the curve is flat at d = 0,
    and the overlap is the variable. With a < 1 it is steep there, and the variable depends on the move:

        short move         the overlap; a series gives the new force
        outward, d small   the force, while d is small compared with `weight` f: the force decides the motion
        inward, from far   neither: the solution has an upper bound, see `bounded_point`
        to or past d = 0   the force
        otherwise          the overlap
    """
    preload, exponent = law[i, 0], law[i, 2]
    if exponent >= 1.0:
        return move_in_overlap(law, graph, i, overlap, by_overlap)
    # Short move. Not with a preload: the series would lose the last digits of the small rest of the force.
    if preload == 0.0 and by_overlap != 0.0 and abs(by_overlap) < SHORT_MOVE * overlap and not has_table(graph, i):
        return overlap + by_overlap, force + force * short_growth(by_overlap / overlap, exponent)
    # Outward while d is small.
    excess = force + by_force - preload
    if by_overlap > 0.0 and 0.0 < overlap < DECIDES * weight * excess:
        reach = curve_overlap(law, graph, i, excess, 1.0)
        if reach < DECIDES * weight * excess:
            return reach, preload + excess
    # Inward from far away.
    if by_overlap < 0.0 and overlap > 0.0 and preload > 0.0:
        end, pushes = bounded_point(law, graph, i, weight, overlap, force, by_overlap)
        if end > 0.0:
            return end, pushes
    # To d = 0 or past it. If `by_overlap` is 0, the curve is vertical and the force is the only variable.
    continued = is_continued(law, graph, i)
    towards_zero = (by_overlap < 0.0) == (overlap > 0.0) and (overlap > 0.0 or continued)
    if overlap == 0.0 or by_overlap == 0.0 or towards_zero:
        return move_in_force(law, graph, i, overlap, by_overlap, excess)
    return move_in_overlap(law, graph, i, overlap, by_overlap)


@inlined
def bounded_point(law, graph, i, weight, overlap, force, by_overlap):
    """Return a point (d, f) that is nearer to the solution than a Newton move from far to its right; d = 0 without one.

    The move solves d + weight (F + K d**a - F) = rest approximately, so neither term of the solution exceeds `rest`.
    """
    excess = force - law[i, 0]
    slope = 1.0 + weight * local_exponent(law, graph, i, overlap, force) * excess / overlap
    rest = overlap + weight * excess + slope * by_overlap
    # Newton's move is good enough if the force decides, or if the bound is not well below the present overlap.
    if not (slope < NEARLY_FREE and rest > 0.0):
        return 0.0, 0.0
    reach = curve_overlap(law, graph, i, rest, weight)
    if not 2.0 * min(rest, reach) < overlap:
        return 0.0, 0.0
    if rest < reach:
        return rest, pressed_force(law, graph, i, rest)
    return reach, law[i, 0] + rest / weight


@inlined
def move_in_force(law, graph, i, overlap, by_overlap, excess):
    """Return overlap and force after a move to the force that exceeds the preload by `excess` [N]."""
    preload, continued = law[i, 0], is_continued(law, graph, i)
    if excess > 0.0 or (continued and excess < 0.0):
        reach = curve_overlap(law, graph, i, abs(excess), 1.0)
        return (reach if excess > 0.0 else -reach), preload + excess
    # the force has fallen below 0 on a curve that is not continued: the contact has opened
    if not continued and excess <= 0.0:
        return min(overlap + by_overlap, -SMALLEST), 0.0
    return 0.0, preload


@inlined
def move_in_overlap(law, graph, i, overlap, by_overlap):
    """Return overlap and force after a move by `by_overlap` [m].

    A table may be flat after a steep beginning. Newton's iteration would oscillate if it could pass d = 0 there.
    """
    moved = overlap + by_overlap
    if has_table(graph, i) and moved * overlap < 0.0 and is_continued(law, graph, i):
        moved = 0.0
    return moved, curve_force(law, graph, i, moved)


@inlined
def flow_into(i, inverse_mass, force):
    """Return (L f)_i [m/s²], the acceleration with which the contact forces (n,) separate the beads of contact i."""
    flow = (inverse_mass[i] + inverse_mass[i + 1]) * force[i]
    if i > 0:
        flow -= inverse_mass[i] * force[i - 1]
    if i < force.size - 1:
        flow -= inverse_mass[i + 1] * force[i + 1]
    return flow


@inlined
def acceleration_of(i, chain, overlap, force, passed):
    """Return w' [m/s²] of contact i at `overlap` [m], `passed` [s] from now: by contact forces, external forces and strings."""
    found = drive_at(chain, i, passed) - flow_into(i, chain.inverse_mass, force)
    if chain.strings.rest.size:
        found += string_pull(chain, i, overlap)
    return found


@piece
def anchor_acceleration(chain, force, passed):
    """Return the acceleration [m/s²] of the anchor bead by the contact forces (n,) and external forces, `passed` [s] from now."""
    inverse_mass, anchor_bead = chain.inverse_mass, chain.anchor_bead
    # The strings of a chain are not included, because their pull depends on the position of the bead.
    net = force[anchor_bead - 1] if anchor_bead > 0 else 0.0
    if anchor_bead < force.size:
        net -= force[anchor_bead]
    return net * inverse_mass[anchor_bead] + drive_at(chain, force.size, passed)
