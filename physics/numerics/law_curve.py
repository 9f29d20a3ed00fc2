"""The contact law as a curve of (overlap, force) for implicit steps, and the collocation nodes these steps have.

Each contact is in one mode for a whole step, so that the step sees smooth motion; the caller ends steps where modes do:

    OPEN      f = 0, whatever d does            LOADED    f = F + K d**a; with preload or a = 1 continued to d < 0,
    TOUCHING  d = 0, f any number                         else 0 there

A user-defined law is the curve of its table. Its row of `law` holds the power law with which it begins at d = 0; F, K and a of
this decide whether the contact is soft and whether the curve is continued. A contact with several segments is on one of them,
whose numbers are in its row of `law`, and its overlap counts from the origin of this segment.
"""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics.numerics.elementary import power
from softcradle.physics.numerics.graph_kernels import has_segments
from softcradle.physics.numerics.jit import inlined, jit, piece
from softcradle.physics.numerics.knots import drive_at
from softcradle.physics.numerics.records import FORCE_FROM, FROM
from softcradle.physics.numerics.table_kernels import has_table, table_inverse, table_slope, table_value

ROOT6 = math.sqrt(6.0)
NODES = np.array([(4.0 - ROOT6) / 10.0, (4.0 + ROOT6) / 10.0, 1.0])  # of Radau IIA with three stages
MOST_CARE = 1e4  # largest weight of the error of a soft contact that oscillates many times
SMALLEST = 1e-290  # an overlap below is zero: the contact then is vertical, whatever its law
LOST = 1e-6  # of a preload: in a smaller difference of a force from it round-off would be seen
SHORT_MOVE = (
    5e-4  # of an overlap: over so short a way four terms of the binomial series are a power law to the last digit
)
# columns of `law` after preload, stiffness and exponent if contacts have several segments
LAW_BEFORE, LAW_STOP, LAW_SIDE = 3, 4, 5


@inlined
def signed_force(preload, stiffness, exponent, overlap):
    """``F + K d**a``, continued oddly to d < 0 where the law has a preload or a = 1, else 0 there."""
    if overlap > 0.0:
        return preload + stiffness * power(overlap, exponent)
    if preload == 0.0 and exponent != 1.0:
        return 0.0
    if overlap == 0.0:
        return preload
    return preload - stiffness * power(-overlap, exponent)


@inlined
def slope_at(preload, stiffness, exponent, overlap, force):
    """df/dd on the curve; inf where it is vertical, 0 where the contact is open."""
    if exponent == 1.0:
        return stiffness
    if abs(overlap) < SMALLEST:
        return math.inf if exponent < 1.0 else 0.0
    if overlap < 0.0 and preload == 0.0:
        return 0.0
    own = force - preload
    if abs(own) < LOST * preload:
        own = math.copysign(stiffness * power(abs(overlap), exponent), overlap)
    return exponent * own / overlap


@inlined
def care(exponent, swing, faster):
    """Weight of a contact's error: 1 + min(h²ω², 1) min(ω/ω_slowest, MOST_CARE) for a < 1, else 1.

    `swing` is h²ω², (step times local frequency)², `faster` is (ω/ω_slowest)². A soft contact deep in a cluster oscillates
    about its quasi-static overlap, the more often the faster it is. A step as long as a period damps this oscillation, each
    time; at the end what is lost is a velocity, which openings magnify.
    """
    return 1.0 + min(swing, 1.0) * min(math.sqrt(faster), MOST_CARE) if exponent < 1.0 else 1.0


@inlined
def larger(a, b):
    """The larger of two errors; nan where either is none, which ``max`` may pass over."""
    return b if b > a or math.isnan(b) else a


@jit
def depth_at(preload, stiffness, exponent, energy):
    """An overlap at which a contact stores `energy`: the smaller of what its preload and its stiffness alone would need."""
    depth = energy / preload if preload > 0.0 else math.inf
    if stiffness > 0.0:
        depth = min(depth, power((1.0 + exponent) * energy / stiffness, 1.0 / (1.0 + exponent)))
    return depth


@inlined
def by_table(graph, i, overlap):
    """Return whether the force of contact i at `overlap` is that of a table, not of the power law with which it begins."""
    return has_table(graph, i) and abs(overlap) >= graph.segment[graph.first[i], FROM]


@inlined
def pressed_force(law, graph, i, overlap):
    """Return the force of contact i, a power law or a table, at an overlap > 0."""
    if by_table(graph, i, overlap):
        return table_value(graph, graph.force, graph.first[i], overlap)
    return law[i, 0] + law[i, 1] * power(overlap, law[i, 2])


@inlined
def is_continued(law, graph, i):
    """Return whether the force is continued beyond d = 0 within a step, so that a loaded contact opens at an event."""
    return law[i, 0] != 0.0 or law[i, 2] == 1.0 or (has_segments(graph, i) and law[i, 2] > 1.0)


@inlined
def is_smooth(law, graph, i):
    """Return whether the force begins without a slope: a loaded contact then opens within a step, not at an event."""
    return law[i, 2] > 1.0 and not is_continued(law, graph, i)


@inlined
def curve_force(law, graph, i, overlap):
    """Return the force of contact i, LOADED, at any overlap; see `signed_force`, `signed_table` and `signed_segment`."""
    if graph.kind.size:
        if overlap != 0.0 and by_table(graph, i, overlap):
            return signed_table(law, graph, i, overlap)
        if has_segments(graph, i):
            return signed_segment(law, i, overlap)
    return signed_force(law[i, 0], law[i, 1], law[i, 2], overlap)


@inlined
def curve_slope(law, graph, i, overlap, force):
    """Return df/dd of contact i, LOADED, at a point of its curve, inf if that is vertical; see `slope_at`."""
    if graph.kind.size:
        if abs(overlap) >= SMALLEST and by_table(graph, i, overlap):
            continued = overlap > 0.0 or is_continued(law, graph, i)
            return table_slope(graph, graph.first[i], abs(overlap)) if continued else 0.0
        if has_segments(graph, i) and law[i, 2] >= 1.0:
            return segment_slope(law, i, overlap)
    return slope_at(law[i, 0], law[i, 1], law[i, 2], overlap, force)


@inlined
def signed_segment(law, i, overlap):
    """Return the force of a segment at `overlap` from its origin, continued oddly beyond it for a >= 1."""
    x = law[i, LAW_SIDE] * overlap
    y = x + law[i, LAW_BEFORE]
    if y <= 0.0 and law[i, 0] == 0.0 and law[i, 2] < 1.0:
        return 0.0
    own = law[i, 1] * power(abs(y), law[i, 2]) if y != 0.0 else 0.0
    return law[i, LAW_SIDE] * (law[i, 0] + (own if y > 0.0 else -own) + law[i, LAW_STOP] * x)


@inlined
def segment_slope(law, i, overlap):
    """Return the slope of `signed_segment` for a >= 1."""
    y = abs(law[i, LAW_SIDE] * overlap + law[i, LAW_BEFORE])
    if law[i, 2] == 1.0:
        return law[i, 1] + law[i, LAW_STOP]
    return law[i, LAW_STOP] + (law[i, 2] * law[i, 1] * power(y, law[i, 2] - 1.0) if y > SMALLEST else 0.0)


@inlined
def curve_overlap(law, graph, i, excess, part):
    """Return the overlap of contact i, LOADED, at ``excess / part`` > 0 of its force over its preload."""
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
    """Return d f'/(f - F) of contact i at an overlap > 0: the exponent of a power law."""
    if force != law[i, 0] and by_table(graph, i, overlap):
        return overlap * table_slope(graph, graph.first[i], overlap) / (force - law[i, 0])
    return law[i, 2]


@jit
def signed_table(law, graph, i, overlap):
    """Return the force of a table at an overlap other than 0, continued as `signed_force`."""
    if overlap > 0.0:
        return table_value(graph, graph.force, graph.first[i], overlap)
    if not is_continued(law, graph, i):
        return 0.0
    return 2.0 * law[i, 0] - table_value(graph, graph.force, graph.first[i], -overlap)


@inlined
def short_growth(x, a):
    """(1 + x)**a - 1 for abs(x) < SHORT_MOVE."""
    return a * x * (1.0 + (a - 1.0) * x * (1.0 / 2.0 + (a - 2.0) * x * (1.0 / 6.0 + (a - 3.0) * x * (1.0 / 24.0))))


@inlined
def move_along(law, graph, i, weight, overlap, force, by_overlap, by_force):
    """One Newton move on the curve, on the side where it cannot overshoot: for a < 1 towards d = 0 in force, else in d.

    Away from 0 in force too as long as d stays small against `weight` f, what the force moves in the step (h² L_ii).
    """
    preload, exponent = law[i, 0], law[i, 2]
    # beside a preload the last digits of the rest would be lost
    soft = exponent < 1.0 and preload == 0.0 and not has_table(graph, i)
    if soft and by_overlap != 0.0 and abs(by_overlap) < SHORT_MOVE * overlap:
        return overlap + by_overlap, force + force * short_growth(by_overlap / overlap, exponent)
    continued = is_continued(law, graph, i)
    excess = force + by_force - preload
    if exponent < 1.0 and by_overlap > 0.0 and 0.0 < overlap < 0.1 * weight * excess:
        reach = curve_overlap(law, graph, i, excess, 1.0)
        if reach < 0.1 * weight * excess:
            return reach, preload + excess
    if exponent < 1.0 and by_overlap < 0.0 and overlap > 0.0:
        slope = 1.0 + weight * local_exponent(law, graph, i, overlap, force) * (force - preload) / overlap
        # far to the right of the solution: d + weight K d**a = rest bounds both terms
        if slope < 2.0 and preload > 0.0:
            rest = overlap + weight * (force - preload) + slope * by_overlap
            if rest > 0.0:
                reach = curve_overlap(law, graph, i, rest, weight)
                far = 2.0 * min(rest, reach) < overlap
                if far and rest < reach:
                    return rest, pressed_force(law, graph, i, rest)
                if far:
                    return reach, preload + rest / weight
    towards_zero = (by_overlap < 0.0) == (overlap > 0.0) and (overlap > 0.0 or continued)
    if exponent < 1.0 and (overlap == 0.0 or by_overlap == 0.0 or towards_zero):  # by_overlap 0: the curve is vertical
        if excess > 0.0 or (continued and excess < 0.0):
            reach = curve_overlap(law, graph, i, abs(excess), 1.0)
            return (reach if excess > 0.0 else -reach), preload + excess
        if not continued and excess <= 0.0:
            return min(overlap + by_overlap, -SMALLEST), 0.0
        return 0.0, preload
    moved = overlap + by_overlap
    if has_table(graph, i) and moved * overlap < 0.0 and continued:
        moved = 0.0  # a table may be flat behind a steep beginning, and a Newton iteration that passes d = 0 oscillates
    return moved, curve_force(law, graph, i, moved)


@inlined
def flow_into(i, inverse_mass, force):
    """(L f)_i, the rate at which the contact forces (n,) pull overlap i apart."""
    flow = (inverse_mass[i] + inverse_mass[i + 1]) * force[i]
    if i > 0:
        flow -= inverse_mass[i] * force[i - 1]
    if i < force.size - 1:
        flow -= inverse_mass[i + 1] * force[i + 1]
    return flow


@inlined
def acceleration_of(i, chain, force, passed):
    """w' of contact i under the contact forces (n,), `passed` [s] after now."""
    return drive_at(chain, i, passed) - flow_into(i, chain.inverse_mass, force)


@piece
def anchor_acceleration(chain, force, passed):
    """Acceleration of the anchor bead by the contact forces (n,) and from outside, `passed` [s] after now."""
    inverse_mass, anchor_bead = chain.inverse_mass, chain.anchor_bead
    net = force[anchor_bead - 1] if anchor_bead > 0 else 0.0
    if anchor_bead < force.size:
        net -= force[anchor_bead]
    return net * inverse_mass[anchor_bead] + drive_at(chain, force.size, passed)
