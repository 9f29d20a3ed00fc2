"""Step sizes of `radau` and `dop853`, and which of them takes the next step.

Errors near a singular time grade the steps: they shrink like the time that is left to an opening, and grow like the time
since an onset. So the next step is foretold from the last two (Gustafsson), and from when the next contact will open.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.step import ACCURATE, DOP853
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.law_curve import LOADED, OPEN, slope_at

# entries of the pace array: longest next step, and of radau; the last step (0: none like it), its error; the time left to
# an opening at its start, and the next step had nothing come near; the longest step of dop853; the longest after a refusal
NEXT, RADAU, LAST, ERROR, LEFT, PLAIN, REACH, CEILING = 0, 1, 2, 3, 4, 5, 6, 7
PACES = 8

SAFETY = 0.9
GROW_RADAU, GROW_DOP853 = 8.0, 30.0  # times the step before, at the most; the latter between steps of radau
FORETOLD = 2.0  # at the most so much more where errors fall
LEAST_ERROR = 1e-3  # of a step's tolerance: smaller ones foretell nothing
STIFF = 9.0  # (step times local frequency)², above which a soft contact is left to radau
CHEAPER = 0.4  # of the time of a step of radau one of dop853 takes
PROBE = 1.5  # steps of dop853 that only stiffness holds back raise what is asked of radau by this
WARY, FORGET, LIFTED = (
    0.9,
    1.02,
    1.5,
)  # of a step refused: no longer one soon; a step later; but where errors fall so far
LAST_PUSH = 0.05  # of a step's tolerance: what a contact still pushes is passed over below


@jit
def begin(pace, h):
    """Forget the past; the next step is `h` at the most (inf: not known)."""
    pace[NEXT], pace[RADAU], pace[LAST], pace[LEFT], pace[CEILING] = h, h, 0.0, math.inf, math.inf


@jit
def onset_step(given, i, speed, wanted):
    """First step after contact i closes at `speed`: its impulse L K (v h)**a h / (1+a) is the error; inf if smooth."""
    exponent, stiffness = given.law[i, 2], given.law[i, 1]
    if exponent == 1.0 or stiffness == 0.0 or speed <= 0.0:
        return math.inf
    weight = (given.inverse_mass[i] + given.inverse_mass[i + 1]) * stiffness * speed**exponent
    return ((1.0 + exponent) * wanted / weight) ** (1.0 / (1.0 + exponent))


@jit
def first_step(given, moving, scale):
    """A step to begin with where no onset gives one: a hundredth of the fastest local period or crossing."""
    fastest = 0.0
    for i in range(moving.mode.size):
        weight = given.inverse_mass[i] + given.inverse_mass[i + 1]
        preload, stiffness, exponent = given.law[i, 0], given.law[i, 1], given.law[i, 2]
        if moving.mode[i] == LOADED and moving.overlap[i] > 0.0:
            slope = slope_at(preload, stiffness, exponent, moving.overlap[i], moving.force[i])
            fastest = max(fastest, math.sqrt(weight * slope))
        if moving.mode[i] != OPEN:
            push = max(moving.force[i], preload)
            fastest = max(fastest, weight * push / scale, 1e-3 * math.sqrt(weight * stiffness))
        if given.external.size:
            fastest = max(fastest, abs(given.external[i]) / scale)
    return 0.01 / fastest if fastest > 0.0 else 1.0


@jit
def soft_contacts(given, moving, wanted):
    """(reach, left, push): longest step of dop853, beyond which a soft contact is stiff; time to the next opening of a soft
    contact if its rate keeps, inf where none is near, and what this contact pushes until then [m/s]."""
    stiffest, left, push = 0.0, math.inf, 0.0
    for i in range(moving.mode.size):
        if moving.mode[i] != LOADED or given.law[i, 2] >= 1.0:
            continue
        overlap, rate = moving.overlap[i], moving.rate[i]
        if overlap <= 0.0:
            stiffest = math.inf
            continue
        weight = given.inverse_mass[i] + given.inverse_mass[i + 1]
        stiff = weight * slope_at(given.law[i, 0], given.law[i, 1], given.law[i, 2], overlap, moving.force[i])
        stiffest = max(stiffest, stiff)
        if rate < 0.0:
            time = -overlap / rate
            pushes = weight * moving.force[i] * time
            if time < left and time * time * stiff < 4.0 and pushes > LAST_PUSH * wanted:
                left, push = time, pushes
    reach = math.sqrt(STIFF / stiffest) if stiffest > 0.0 else math.inf
    if given.kind != ACCURATE:
        reach = math.inf if given.kind == DOP853 else 0.0
    return reach, left, push


@jit
def before_opening(left, push, wanted):
    """A step that ends just before an opening, the closer the less it matters: its error is that of (t_o - t)**a."""
    return left * (0.9 if push > 1e3 * wanted else 0.99 if push > 10.0 * wanted else 0.999)


@jit
def next_step(pace, rest, given, moving, wanted):
    """(explicit, h, near): whether dop853 takes the next step, its length, `rest` at the most, and whether an opening that
    is near limits it. Alone, dop853 lets soft contacts swing, and no opening of theirs foretells anything."""
    reach, left, push = soft_contacts(given, moving, wanted)
    alone = given.kind == DOP853
    if left < pace[LEFT] < math.inf and not alone and pace[NEXT] > 0.3 * left:
        pace[NEXT] = min(pace[NEXT], pace[PLAIN] * left / pace[LEFT])
    pace[LEFT], pace[REACH] = left, reach
    longest = min(pace[RADAU], pace[NEXT])
    explicit = min(reach, pace[NEXT]) >= CHEAPER * longest
    h = min(min(reach, pace[NEXT]) if explicit else longest, rest)
    if left < h:
        return explicit, 0.9 * left if alone else before_opening(left, push, wanted), not alone
    if explicit and h == reach:
        pace[RADAU] *= PROBE
    return explicit, h, False


@jit
def learn(pace, h, explicit, error, near, landing, refused, wanted):
    """Set the next step from the error of this one, of length `h`. One cut short by an opening or an event tells little."""
    power = 0.125 if explicit else 0.2
    most = GROW_DOP853 if explicit and math.isfinite(pace[REACH]) else GROW_RADAU
    grow = min(most, SAFETY * (wanted / max(error, 1e-300)) ** power)
    pace[PLAIN] = h * grow
    if landing >= 0 or near:
        pace[LAST] = 0.0
        pace[NEXT] = max(pace[NEXT], h * grow) if math.isfinite(pace[NEXT]) else h * grow
        return
    error = max(error, 1e-300)
    if pace[LAST] > 0.0:
        foretold = (h / pace[LAST]) * (pace[ERROR] / error) ** power
        if h < pace[LAST]:
            grow = min(grow, SAFETY * foretold * (wanted / error) ** power)
        elif math.isfinite(pace[REACH]):
            grow = min(most, grow * min(max(foretold, 1.0), FORETOLD))
    pace[LAST], pace[ERROR], pace[NEXT] = h, max(error, LEAST_ERROR * wanted), h * grow
    if explicit:
        if refused < math.inf:
            pace[CEILING] = max(h, WARY * refused)
        elif grow > LIFTED:
            pace[CEILING] = math.inf
        pace[NEXT] = min(pace[NEXT], pace[CEILING])
        pace[CEILING] *= FORGET
    if not explicit:
        pace[RADAU] = h * grow
