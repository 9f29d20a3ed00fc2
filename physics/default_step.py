"""The default step of methods with a fixed step."""

from __future__ import annotations

from numpy.typing import ArrayLike
from softcradle.physics.chain import Chain
from softcradle.physics.scales import contact_scales, speed_scale

STEPS_A_CONTACT = 1000  # in the shortest contact time
STEPS_A_STOP = 100  # at the least, in the time in which bed friction stops a bead


def default_step(chain: Chain, velocity: ArrayLike) -> float:
    """Step [s] of a fixed-step method where none is given: a thousandth of the shortest contact time.

    With bed friction or brakes it is at most a hundredth of the time in which they stop a bead.
    """
    shortest = float(contact_scales(chain, velocity)[1].min()) / STEPS_A_CONTACT
    strongest = float(chain.bed.max(initial=0.0))
    if not strongest:
        return shortest
    return min(shortest, speed_scale(chain, velocity) / strongest / STEPS_A_STOP)
