"""Warnings about numbers that are valid but probably not intended, such as millimetres instead of metres."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from softcradle.physics.chain import Chain, per_chain
from softcradle.physics.scales import NO_APPROACH, contact_scales
from softcradle.physics.status import CodedWarning, WarningCode, Warnings

# Largest usual tolerance, relative to the closing speed. With a larger tolerance the velocities are arbitrary.
LARGEST_TOLERANCE = 0.1
# Smallest usual overlap, relative to the precompression. If the overlap is smaller, the spring of the draft gear does
# not affect the motion.
LEAST_YIELD = 1e-3
LARGEST_FRICTION = 5.0  # Largest usual coefficient of friction. Rubber on concrete has a coefficient of about 1.


def unusual_warnings(chain: Chain, velocity: ArrayLike, tolerance: float) -> Warnings:
    """Return warnings about unusual values of the tolerance, the precompressions and the friction of `chain`.

    Also warn about user-defined laws with a falling force. A tolerance of 0 means fixed steps.
    """
    found = (*_of_tolerance(tolerance), *_of_gears(chain, velocity), *_of_friction(chain.friction))
    return (*found, *_of_own_laws(chain, velocity))


def _of_tolerance(tolerance: float) -> Warnings:
    if tolerance <= LARGEST_TOLERANCE:
        return ()
    sentence = (
        f"a tolerance of {tolerance:g} leaves the velocities open: it is their error relative to the closing speed"
    )
    return (CodedWarning(WarningCode.UNUSUAL, f"{sentence}; usual are 1e-3 to 1e-10", {"tolerance": tolerance}),)


def _of_gears(chain: Chain, velocity: ArrayLike) -> Warnings:
    """Return a warning if a draft gear hardly yields. The warning names the gear that yields least."""
    usual = _usual_speed_of_gears(chain)
    speeds = np.asarray(velocity).tolist() if usual else [0.0]
    if not 0.0 < max(speeds) - min(speeds) < usual:
        return ()
    laws, depth = chain.law_rows.tolist(), contact_scales(chain, velocity)[0].tolist()
    shares = [d * law[1] / law[0] if _is_gear(law) else math.inf for d, law in zip(depth, laws, strict=True)]
    i = int(np.argmin(shares))
    if shares[i] >= LEAST_YIELD:
        return ()
    length = laws[i][0] / laws[i][1]
    sentence = (
        f"contact {i}-{i + 1} is precompressed by {length:.3g} m and yields by about {depth[i]:.1g} m only, as a step force "
        "would: is the precompression given in metres?"
    )
    return (CodedWarning(WarningCode.UNUSUAL, sentence, {"precompression": length, "yield": depth[i]}),)


def _is_gear(law: Sequence[float]) -> bool:
    """Return True if a law (preload, stiffness, exponent) is a preloaded linear spring."""
    return law[0] > 0.0 < law[1] and law[2] == 1.0


@per_chain
def _usual_speed_of_gears(chain: Chain) -> float:
    """Return the closing speed [m/s] above which every draft gear yields by at least the share LEAST_YIELD of its
    precompression.

    The result is 0 without draft gears.
    """
    contacts = zip(chain.law_rows.tolist(), chain.inverse_reduced_mass.tolist(), strict=True)
    # Squares of the speeds at which the kinetic energy equals preload times overlap
    squares = [2.0 * weight * law[0] * (LEAST_YIELD * law[0] / law[1]) for law, weight in contacts if _is_gear(law)]
    return math.sqrt(max(squares, default=0.0)) * (1.0 + NO_APPROACH)


def _of_friction(friction: float) -> Warnings:
    if friction <= LARGEST_FRICTION:
        return ()
    sentence = f"a coefficient of friction of {friction:g} is unusual: rubber on concrete has 1"
    return (CodedWarning(WarningCode.UNUSUAL, sentence, {"friction": friction}),)


def _of_own_laws(chain: Chain, velocity: ArrayLike) -> Warnings:
    """Return a warning for each user-defined law whose force falls while the overlap grows."""
    depth = contact_scales(chain, velocity)[0] if chain.own_laws else np.zeros(0)
    found = []
    for law in chain.own_laws:
        at = law.falls(max(float(depth[i]) for i, own in chain.own_contacts if own == law))
        if at:
            sentence = (
                f"the force of contact law {law.name!r} falls from an overlap of {at:.3g} m on: the motion may jump there, "
                "and 'conserving' may not find its step"
            )
            found.append(CodedWarning(WarningCode.UNUSUAL, sentence, {"overlap": at}))
    return tuple(found)
