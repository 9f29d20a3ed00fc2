"""Main loop of the adaptive methods: step size, steps of `radau` and `dop853`, events, free flight, and the end of a
collision.

Step lengths follow the singular times of soft contacts (onset, opening) by factors of up to 8 from step to step.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.constants import FEW_TRIES, ROUND_OFF, TOLERANCE_PART
from softcradle.physics.adaptive.corner_action import begin, cross, fly_to_event, open_passed, pass_knot
from softcradle.physics.adaptive.flight import back_to_opening, nothing_pushes
from softcradle.physics.adaptive.row_graphs import friction_needed, most_friction, put_drive
from softcradle.physics.adaptive.sampling import absorb, accept_step, keep_step
from softcradle.physics.adaptive.step_control import (
    find_step,
    first_step,
    propose_step,
    restart_control,
    update_control,
)
from softcradle.physics.adaptive.step_records import (
    AT_ONCE,
    CENTRE,
    DOP853,
    LAST,
    LOCAL_SQUARE,
    MASS,
    NEXT,
    RESTED,
    START,
    VELOCITY,
    Accuracy,
    Regime,
    Scratch,
    StepContext,
    Steps,
    Trial,
    bounds_of,
)
from softcradle.physics.adaptive.switch_log import end_within_bounces, find_openings, grow_errors, log_switches
from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.jit import inlined, piece, whole
from softcradle.physics.numerics.knots import BESIDE, next_knot
from softcradle.physics.numerics.meeting import meets_again
from softcradle.physics.numerics.records import (
    DONE,
    FLIGHT,
    FROZEN,
    KEPT,
    OUT_OF_STEPS,
    PAUSED,
    REJECTED,
    SEPARATED,
    STEP,
    ChainData,
    Extent,
    Motion,
    SwitchLog,
)


@piece
def nothing_moves(least, chain, regime, motion, velocity):
    """Return True if all beads have come to rest: none is faster than `least` [m/s], and friction or a balance of
    forces holds each.

    A bead that creeps while a soft contact damps it never turns, so it would creep forever. Therefore beads slower than
    `least` count as resting on a bed. `velocity` (n+1,) is scratch memory.
    """
    # The difference of two bead velocities is at most twice the limit. This test is cheap and fails for most motions.
    for i in range(motion.rate.size):
        if abs(motion.rate[i]) > 2.0 * least:
            return False
    bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
    # Friction can hold a bead if it can balance all other forces. On a bead without friction the forces must balance up
    # to round-off.
    for j in range(velocity.size):
        held = ROUND_OFF * largest_force(j, chain, motion)
        if regime.bed[j] > 0.0:
            held += most_friction(j, chain, regime, 0.0)
        pushed = regime.inverse_mass[j] > 0.0 and abs(friction_needed(j, chain, regime, motion.force, 0.0)) > held
        if pushed or abs(velocity[j]) > (least if regime.bed[j] > 0.0 else 0.0):
            return False
    return True


@inlined
def largest_force(j, chain, motion):
    """Return the largest force [N] that acts on bead j."""
    found = abs(chain.push[j]) if chain.push.size else 0.0
    for i in range(max(j - 1, 0), min(j + 1, motion.force.size)):
        found = max(found, abs(motion.force[i]), abs(chain.law[i, 0]))
    return found


@inlined
def put_to_rest(regime, motion):
    """Set all velocities to 0, because friction holds all beads."""
    for i in range(motion.rate.size):
        motion.rate[i] = 0.0
    for j in range(regime.slide.size):
        regime.slide[j] = 0
    motion.anchor[1] = 0.0


@inlined
def total_mass(regime, anchor_bead):
    """Return the mass of all beads [kg], summed from the anchor bead outwards."""
    mass = 1.0 / regime.inverse_mass[anchor_bead]
    for j in range(anchor_bead - 1, -1, -1):
        mass += 1.0 / regime.inverse_mass[j]
    for j in range(anchor_bead + 1, regime.inverse_mass.size):
        mass += 1.0 / regime.inverse_mass[j]
    return mass


@inlined
def centre_from_anchor(regime, anchor_bead, rate, mass):
    """Return the velocity [m/s] of the centre of mass relative to the anchor bead; `mass` [kg] is that of all beads."""
    momentum, velocity = 0.0, 0.0
    for j in range(anchor_bead - 1, -1, -1):
        velocity += rate[j]
        momentum += velocity / regime.inverse_mass[j]
    velocity = 0.0
    for j in range(anchor_bead, rate.size):
        velocity -= rate[j]
        momentum += velocity / regime.inverse_mass[j + 1]
    return momentum / mass


@inlined
def find_centre(chain, regime, motion, control):
    """Write the total mass and the velocity of the centre of mass into `control`.

    The mass is 0 if a wall, a bed or strings exert a force on the beads. Then `keep_momentum` does nothing.
    """
    control[MASS] = 0.0
    for j in range(regime.inverse_mass.size):
        if regime.inverse_mass[j] == 0.0:
            return
    if regime.bed.size == 0 and chain.strings.rest.size == 0:
        mass = total_mass(regime, chain.anchor_bead)
        control[MASS] = mass
        control[CENTRE] = motion.anchor[1] + centre_from_anchor(regime, chain.anchor_bead, motion.rate, mass)


@inlined
def push_centre(h, chain, control):
    """Update the velocity of the centre of mass with the impulse of the external forces in a step of length `h` [s]."""
    if control[MASS] > 0.0:
        for j in range(chain.push.size):
            control[CENTRE] += h * chain.push[j] / control[MASS]
        for j in range(chain.knots.push_slope.size):
            control[CENTRE] += 0.5 * h * h * chain.knots.push_slope[j] / control[MASS]


@inlined
def keep_momentum(chain, regime, motion, control):
    """Set the velocity of the anchor bead so that the total momentum is exact.

    Two errors change the momentum. The contact forces of a step cancel only up to the precision of its stages. An event sets a
    negligible rate to 0 without the impulse that this takes. The correction adds the same velocity to all beads, so it changes
    no rate.
    """
    if control[MASS] > 0.0:
        relative = centre_from_anchor(regime, chain.anchor_bead, motion.rate, control[MASS])
        motion.anchor[1] = control[CENTRE] - relative


@inlined
def any_frozen(motion):
    """Return whether a contact is closed between two beads that do not move."""
    found = False
    for i in range(motion.mode.size):
        found |= motion.mode[i] == FROZEN and motion.overlap[i] > 0.0
    return found


@whole
def integrate(
    extent_fields, pause, accuracy_fields, chain_fields, regime_fields, motion_fields, trial_fields, look_fields,
    scratch_fields, steps_fields, log_fields,
):  # fmt: skip
    """Integrate from the start to the end of an Extent, and change the motion in place.

    `pause` contains whether the run is resumed, and the number of steps (including rejected ones) after which control
    returns to Python. Then, or when no row for another stored step is left, the status is PAUSED; a resumed call
    continues at that time. Each record is an argument, a plain tuple of its fields, because tuples are cheap to pass from
    Python; `look` is a second Trial for probe steps
    inside a step. Returns the status and the time reached. Overlaps of contacts with several segments are counted from
    the origins of their segments.
    """
    (time, end, stop, most_steps), (resumed, budget) = Extent(*extent_fields), pause
    allowed, tolerance, scale = Accuracy(*accuracy_fields)
    chain, motion, steps = ChainData(*chain_fields), Motion(*motion_fields), Steps(*steps_fields)
    regime = Regime(*regime_fields, chain.graph)  # type: ignore[call-arg]
    trial, look = Trial(*trial_fields), Trial(*look_fields)
    scratch, log = Scratch(*scratch_fields), SwitchLog(*log_fields)
    # Limits of velocities that follow from the tolerance, see `Bounds`. The error bound of a step is the unit of the
    # others.
    wanted = TOLERANCE_PART * tolerance * scale
    bounds = bounds_of(wanted, scale)
    ctx = StepContext(chain, regime, motion, trial, look, bounds, scratch, log, steps)
    control, counter, firm = scratch.control, log.counter, regime.bed.size > 0
    # `until` is the next breakpoint of a force over time, at which a step must end. `acts` is true if beads in free
    # flight do not move along parabolas.
    timed, acts, until = chain.knots.time.size > 0, False, next_knot(time, end, chain.knots)
    if timed:
        acts = put_drive(time, chain, regime)
    if not resumed:
        find_centre(chain, regime, motion, control)
        begin(time, ctx)
    while True:
        keep_momentum(chain, regime, motion, control)
        # 1. The end time, and breakpoints of forces over time.
        if time >= end:
            end_within_bounces(end - control[START], chain, motion, wanted, scratch)
            return DONE, end
        if time >= until:
            acts = pass_knot(time, ctx)
            until = next_knot(time, end, chain.knots)
        # 2. The budget of steps: give up, or return to Python and be called again.
        spent = counter[STEP] + counter[REJECTED]
        if spent >= most_steps:
            return OUT_OF_STEPS, time
        if spent >= budget or (steps.time.size > 0 and counter[KEPT] == steps.time.size):
            return PAUSED, time
        # 3. Friction holds all beads: nothing changes until the next breakpoint.
        if firm and not acts and nothing_moves(bounds.negligible, chain, regime, motion, scratch.work[VELOCITY]):
            put_to_rest(regime, motion)
            if until == end:
                return (SEPARATED, time) if stop else (DONE, end)
            keep_step(time, until - time, RESTED, ctx)
            time = until
            continue
        # 4. No contact pushes: overlaps are parabolas, and the time of the next event is a closed form.
        if not acts and nothing_pushes(chain, regime, motion, bounds.negligible):
            # a closed contact between fixed beads does not separate
            apart = stop and firm and until == end and not any_frozen(motion)
            if apart and not meets_again(chain, regime.bed, motion, bounds.negligible, scratch.work[VELOCITY]):
                return SEPARATED, back_to_opening(time, chain, regime, motion, scratch)
            before = time
            time, row = fly_to_event(time, until, ctx)
            if time < math.inf:
                push_centre(time - before, chain, control)
            if row < 0 and stop and until == end:
                return SEPARATED, time
            counter[FLIGHT] += 1
            if counter[FLIGHT] >= most_steps:
                return OUT_OF_STEPS, time
            continue
        # 5. A step: choose its kind and length, and shorten it until its error holds and it ends at the first event.
        if not math.isfinite(control[NEXT]):
            restart_control(control, first_step(chain, motion, scale))
        kind, proposed, near = propose_step(control, until - time, allowed, chain, motion, wanted)
        h, error, row, side, rejected = find_step(time, proposed, kind, allowed == DOP853, most_steps, ctx)
        # Length 0 with an event: the event is at the start. Allow a few such events for each contact and bead; an
        # endless sequence of them (Zeno behaviour) ends the run below.
        if h == 0.0 and row >= 0 and control[AT_ONCE] < FEW_TRIES * (motion.mode.size + regime.bed.size):
            control[AT_ONCE] += 1.0
            cross(row, side, time, ctx)
            continue
        # Length 0 without an event: no step converges, or the budget is used up.
        if h == 0.0:
            return OUT_OF_STEPS, time
        # 6. Accept the step: controller, error estimate, openings within the step, dense output, energy balance.
        update_control(control, h, kind, error, near and h == proposed, row, rejected, wanted)
        control[AT_ONCE] = 0.0
        control[LOCAL_SQUARE] += error * error
        find_openings(h, kind, ctx)
        keep_step(time, h, kind, ctx)
        push_centre(h, chain, control)
        absorb(h, chain, regime, motion, trial, scratch.work, motion.taken)
        accept_step(motion, trial)
        before, time = time, time + h if h < until - time else until
        # At a breakpoint use the values just before it, even if the step to it is as short as the last digit of the
        # time.
        if timed:
            beside = time if time < until else before + (1.0 - BESIDE) * (time - before)
            acts = put_drive(beside if beside < until else before, chain, regime)
        # 7. Contact modes at the end of the step: openings without an event, the log of switches, error amplification,
        # and the mode transition if the step ended at an event.
        counter[STEP] += 1
        if open_passed(row, h, time, ctx):
            control[LAST] = 0.0
        log_switches(before, time, row, ctx)
        grow_errors(row, side, before, ctx)
        if row >= 0:
            cross(row, side, time, ctx)
