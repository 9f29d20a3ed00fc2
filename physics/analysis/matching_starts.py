"""Starts for the search of the nearest contact, over all of its kinds of motion: draft gears by V/v_c, power laws by alpha.

A draft gear below its critical speed moves the clusters as rigid bodies, whatever its numbers: there the outcome is flat, and a
search that starts there stays. So the search begins with contacts of every V/v_c, or of every alpha, that hold two rigid bodies
together for a given time, in closed form:

    draft gear   T = (2/w) atan(x), x = V/(w D) = (V/v_c) sqrt(1/r^2 - 1)
    power law    T ~ K^(-1/p), p = 1 + alpha, from that of stiffness 1
"""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics.analysis.closed_forms import one_on_one, rigid_masses
from softcradle.physics.chain import Chain, mass_shares
from softcradle.physics.contact import Contact, draft_gear, power_law

RATIOS = tuple(np.geomspace(0.3, 30.0, 33).tolist())  # V/v_c of the gears that a search begins with
EXPONENTS = tuple(np.geomspace(0.025, 2.5, 17).tolist())  # of the power laws that it begins with


def gears_of_all_speeds(chain: Chain, struck: int, speed: float, time: float) -> list[Contact]:
    """A draft gear for every V/v_c of RATIOS that holds two rigid bodies together for `time` [s]; none for one on one."""
    first, second = rigid_masses(chain.mass, struck + 1)
    carried = float(np.delete(mass_shares(chain.mass, struck), struck).max(initial=0.0))
    if not 0.0 < carried < 1.0:
        return []
    found = []
    for ratio in RATIOS:
        x = ratio * math.sqrt(1.0 / carried**2 - 1.0)
        frequency = 2.0 * math.atan(x) / time
        found.append(draft_gear(frequency**2 / (1.0 / first + 1.0 / second), speed / (frequency * x)))
    return found


def laws_of_all_exponents(chain: Chain, struck: int, speed: float, time: float) -> list[Contact]:
    """A power law for every exponent of EXPONENTS that holds two rigid bodies together for `time` [s]."""
    first, second = rigid_masses(chain.mass, struck + 1)
    found = []
    reduced = 1.0 / (1.0 / first + 1.0 / second)
    for exponent in EXPONENTS:
        unit = one_on_one(power_law(1.0, exponent), reduced, speed).contact_time  # of stiffness 1; T ~ K^(-1/p)
        found.append(power_law((unit / time) ** (1.0 + exponent), exponent))
    return found
