"""The controller of the step size of `radau` and `dop853`, and which of them takes the next step.

Errors near a singular time grade the steps: they shrink like the time that is left to an opening, and grow like the time
since an onset. So the next step is predicted from the last two (Gustafsson), and from when the next contact will open.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.constants import (
    COST_RATIO,
    FIRST_PART,
    FURTHER_GROWTH,
    MOST_GROWTH,
    NEWTON_PART,
    SAFETY,
    STIFF,
    TOLERANCE_PART,
)
from softcradle.physics.adaptive.step_records import (
    DOP853,
    EITHER,
    ERROR,
    ERROR_EXPONENT,
    LAST,
    LEFT,
    NEXT,
    RADAU,
    RADAU_NEXT,
    REACH,
    UNLIMITED,
)
from softcradle.physics.numerics.elementary import power
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.law_curve import curve_slope
from softcradle.physics.numerics.records import LOADED, OPEN


@inlined
def restart_control(control, h):
    """Forget the past; the next step is `h` at the most (inf: not known)."""
    control[NEXT], control[RADAU_NEXT], control[LAST] = h, h, 0.0
    control[LEFT] = math.inf


@piece
def onset_step(chain, i, speed, wanted):
    """First step after contact i closes at `speed`: its impulse L K (v h)**a h / (1+a) is the error; inf if smooth."""
    exponent, stiffness = chain.law[i, 2], chain.law[i, 1]
    if exponent == 1.0 or stiffness == 0.0 or speed <= 0.0:
        return math.inf
    weight = (chain.inverse_mass[i] + chain.inverse_mass[i + 1]) * stiffness * power(speed, exponent)
    return power((1.0 + exponent) * wanted / weight, 1.0 / (1.0 + exponent))


@piece
def first_step(chain, motion, scale):
    """A step to begin with where no onset gives one: a hundredth of the fastest local period or crossing."""
    fastest = 0.0
    for i in range(motion.mode.size):
        weight = chain.inverse_mass[i] + chain.inverse_mass[i + 1]
        preload, stiffness = chain.law[i, 0], chain.law[i, 1]
        if motion.mode[i] == LOADED and motion.overlap[i] > 0.0:
            slope = curve_slope(chain.law, chain.own, i, motion.overlap[i], motion.force[i])
            fastest = max(fastest, math.sqrt(weight * slope))
        if motion.mode[i] != OPEN:
            push = max(motion.force[i], preload)
            fastest = max(fastest, weight * push / scale, 1e-3 * math.sqrt(weight * stiffness))
        if chain.external.size:
            fastest = max(fastest, abs(chain.external[i]) / scale)
    return FIRST_PART / fastest if fastest > 0.0 else 1.0


@inlined
def soft_contacts(chain, motion, wanted):
    """(reach, left, push): longest step of dop853, beyond which a soft contact is stiff; time to the next opening of a soft
    contact if its rate stays, inf where none is near, and what this contact pushes until then [m/s]."""
    stiffest, left, push = 0.0, math.inf, 0.0
    for i in range(motion.mode.size):
        if motion.mode[i] != LOADED or chain.law[i, 2] >= 1.0:
            continue
        overlap, rate = motion.overlap[i], motion.rate[i]
        if overlap <= 0.0:
            stiffest = math.inf
            continue
        weight = chain.inverse_mass[i] + chain.inverse_mass[i + 1]
        stiff = weight * curve_slope(chain.law, chain.own, i, overlap, motion.force[i])
        stiffest = max(stiffest, stiff)
        if rate < 0.0:
            time = -overlap / rate
            pushes = weight * motion.force[i] * time
            if time < left and time * time * stiff < 4.0 and pushes > TOLERANCE_PART * wanted:
                left, push = time, pushes
    reach = math.sqrt(STIFF / stiffest) if stiffest > 0.0 else math.inf
    return reach, left, push


@piece
def before_opening(left, push, wanted):
    """A step that ends just before an opening, the closer the less it matters: its error is that of (t_o - t)**a."""
    return left * (0.9 if push > 1e3 * wanted else 0.99 if push > 10.0 * wanted else 0.999)


@inlined
def propose_step(control, rest, allowed, chain, motion, wanted):
    """(kind, h, near): the kind of the next step, its length, `rest` at the most, and whether a near opening limits it.

    `allowed` is the one kind that the method takes, or EITHER. dop853 alone lets soft contacts oscillate, so no opening of
    theirs predicts anything.
    """
    reach, left, push = soft_contacts(chain, motion, wanted)
    if allowed != EITHER:
        reach = math.inf if allowed == DOP853 else 0.0
    alone = allowed == DOP853
    if left < control[LEFT] < math.inf and not alone:
        control[NEXT] = min(control[NEXT], control[UNLIMITED] * left / control[LEFT])
    control[LEFT], control[REACH] = left, reach
    longest = min(control[RADAU_NEXT], control[NEXT])
    kind, h = RADAU, min(longest, rest)
    if min(reach, control[NEXT]) >= COST_RATIO * longest:
        kind, h = DOP853, min(reach, control[NEXT], rest)
    if left < h:
        return kind, SAFETY * left if alone else before_opening(left, push, wanted), not alone
    if kind == DOP853 and h == reach:
        control[RADAU_NEXT] *= FURTHER_GROWTH
    return kind, h, False


@inlined
def update_control(control, h, kind, error, near, landing, rejected, wanted):
    """Set the next step from the error of this one, of length `h`. One that an opening or an event cut short predicts little.

    `rejected` is the length of the last step rejected for its error just before this one (inf: none): the next stays well below.
    """
    exponent = ERROR_EXPONENT[kind]
    grow = min(MOST_GROWTH, SAFETY * power(wanted / max(error, 1e-300), exponent))
    control[UNLIMITED] = h * grow
    if landing >= 0 or near:
        control[LAST] = 0.0
        control[NEXT] = max(control[NEXT], h * grow) if math.isfinite(control[NEXT]) else h * grow
        return
    error = max(error, 1e-300)
    if control[LAST] > 0.0:
        predicted = (h / control[LAST]) * power(control[ERROR] / error, exponent)
        if h < control[LAST]:
            grow = min(grow, SAFETY * predicted * power(wanted / error, exponent))
        elif math.isfinite(control[REACH]):
            grow = min(MOST_GROWTH, grow * min(max(predicted, 1.0), FURTHER_GROWTH))
    control[LAST], control[ERROR], control[NEXT] = h, max(error, NEWTON_PART * wanted), h * grow
    if kind == RADAU:
        control[RADAU_NEXT] = h * grow
    elif rejected < math.inf:
        control[NEXT] = min(control[NEXT], max(h, SAFETY * SAFETY * rejected))
