"""Numbers known in closed form or to quadruple precision: collisions, contact times, critical speeds, friction, loss."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from itertools import pairwise

from softcradle.physics import (
    Chain,
    Contact,
    cluster_on_cluster,
    draft_gear,
    hertz,
    hooke,
    one_on,
    power_law,
    simulate,
    step_force,
)
from softcradle.physics.analysis.closed_forms import long_linear_chain, one_on_one, rigid_stroke
from softcradle.physics.analysis.critical_speed import critical_speed
from softcradle.physics.chain import GRAVITY
from softcradle.sandbox.studies.verify.known_number import KnownNumber

TOLERANCE = 1e-9
QUADRUPLE = "Taylor series of order 26 to 36 in quadruple precision"
GEAR = draft_gear(770.0, 0.0177)  # the paper's, with its mass
GEAR_MASS = 0.396
TAPER = 0.95
FINAL = {  # velocity of the striker after a collision at 1 m/s, unit masses and strengths
    (4, 0.1): -0.56758562476447303918,
    (5, 0.1): -0.59285240054465332785,
    (4, 1 / 14): -0.59754443842240887993,
    (5, 1.5): -0.071085017086094284724,
    (4, 1.0): -0.13227948470970768681,
}


def rows() -> Iterator[KnownNumber]:
    """All rows of this file."""
    yield from _striker_rows()
    yield from _gear_rows()
    yield from _loss_rows()
    yield from _gap_rows()


def _striker_rows() -> Iterator[KnownNumber]:
    """Velocities of the striker, and of the last of two on two."""
    for (n, exponent), value in FINAL.items():
        name = f"velocity of the striker, one on {n}, alpha {exponent:.3g} [m/s]"
        yield KnownNumber(name, value, QUADRUPLE, partial(_striker, n, power_law(1.0, exponent)), 1e-7)
    before, _ = long_linear_chain()
    yield KnownNumber(
        "striker of a long Hooke chain [m/s]",
        before,
        "J0 at the first zero of J2",
        partial(_striker, 12, hooke(1.0)),
        1e-7,
    )
    for n in (2, 9):
        yield KnownNumber(
            f"rigid limit: striker, one on {n} step forces [m/s]",
            (1 - n) / (1 + n),
            "two rigid bodies",
            partial(_striker, n, step_force(1.0)),
            1e-7,
        )
    yield KnownNumber(
        "velocity of the last, two on two, alpha 0.1 [m/s]", 1.0011285726409516, QUADRUPLE, _two_on_two, 1e-7
    )


def _gear_rows() -> Iterator[KnownNumber]:
    """Contact times of two beads, and critical speeds of draft gears."""
    for name, law in (
        ("alpha 1/10", power_law(1.0, 0.1)),
        ("Hertz", hertz(1.0)),
        ("draft gear", GEAR),
        ("step force", step_force(1.0)),
    ):
        stroke = one_on_one(law, 0.5, 1.0)
        yield KnownNumber(
            f"contact time of two beads, {name} [s]",
            stroke.contact_time,
            "beta function or arctangent",
            partial(_contact_time, law),
            1e-7,
        )
    for n in (3, 5):
        mass = [GEAR_MASS] * (n + 1)
        known = critical_speed(GEAR, mass, 1)
        yield KnownNumber(
            f"critical speed of one gear on {n} [m/s]",
            known,
            "w D sqrt(2N-1)/(N-1), rigid clusters",
            partial(_measured_critical_speed, n),
            1e-4,
        )


def _loss_rows() -> Iterator[KnownNumber]:
    """What a contact with loss gives back, and how far a bead slides."""
    yield KnownNumber("restitution at loss 0.36", 0.8, "sqrt(1 - loss)", _restitution, 1e-7)
    yield KnownNumber("way of a bead on a bed, friction 0.3 [m]", 1.0 / (0.6 * GRAVITY), "v**2 / (2 mu g)", _way, 1e-7)


def _gap_rows() -> Iterator[KnownNumber]:
    """Balls that collide in pairs."""
    yield KnownNumber(
        "Newton's cradle with gaps: last of five [m/s]",
        1.0,
        "elastic collisions of two equal balls",
        lambda: _with_gaps([1.0] * 5),
        1e-7,
    )
    yield KnownNumber(
        "ball 4 to 1 through 2, with gaps [m/s]",
        16 / 9,
        "elastic collisions of two balls, 2 m / (m + M) each",
        lambda: _with_gaps([4.0, 2.0, 1.0]),
        1e-7,
    )
    tapered = [TAPER ** (3 * k) for k in range(10)]  # each diameter 0.95 of the one before
    yield KnownNumber(
        "tapered chain of ten, with gaps: last [m/s]",
        math.prod(2.0 * m / (m + after) for m, after in pairwise(tapered)),
        "elastic collisions of two balls each",
        lambda: _with_gaps(tapered),
        1e-7,
    )


def _striker(n: int, law: Contact) -> float:
    found = simulate(one_on(n, law), [1.0] + [0.0] * n, samples=2, tolerance=TOLERANCE)
    return float(found.final_velocity[0])


def _contact_time(law: Contact) -> float:
    closed, opened = simulate(one_on(1, law), [1.0, 0.0], samples=2, tolerance=TOLERANCE).contact_intervals[0][0]
    return opened - closed


def _measured_critical_speed(n: int) -> float:
    """Speed at which an inner gear first yields while the struck one is pressed in, by halving."""
    chain = one_on(n, GEAR, GEAR_MASS)
    low, high = 0.1, 3.0
    while high - low > 1e-5 * high:
        speed = 0.5 * (low + high)
        pressed_in = 0.55 * rigid_stroke(GEAR, chain.mass, 1, speed).contact_time
        deepest = simulate(chain, [speed] + [0.0] * n, pressed_in, samples=401, tolerance=1e-8).overlap[:, 1:].max()
        low, high = (low, speed) if deepest > 0.0 else (speed, high)
    return 0.5 * (low + high)


def _restitution() -> float:
    final = simulate(one_on(1, hertz(1.0, 0.36), [1.0, 3.0]), [1.0, 0.0], samples=2, tolerance=TOLERANCE).final_velocity
    return float(final[1] - final[0])


def _way() -> float:
    chain = Chain([1.0, 1.0], hertz(1.0), gap=10.0, friction=0.3)
    return float(simulate(chain, [1.0, 0.0], 1.0, samples=2, tolerance=TOLERANCE).position[-1, 0])


def _with_gaps(mass: list[float]) -> float:
    chain = Chain(mass, hertz(1e6), gap=0.5)
    return float(simulate(chain, [1.0] + [0.0] * (len(mass) - 1), samples=2, tolerance=TOLERANCE).final_velocity[-1])


def _two_on_two() -> float:
    found = simulate(
        cluster_on_cluster(2, 2, power_law(1.0, 0.1)), [1.0, 1.0, 0.0, 0.0], samples=2, tolerance=TOLERANCE
    )
    return float(found.final_velocity[3])
