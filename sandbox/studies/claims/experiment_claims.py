"""Claims on the experiment of App. C: draft gears with the measured masses, and their likeness to soft power laws."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from softcradle.physics import Chain, Contact, draft_gear, one_on
from softcradle.physics.analysis.closed_forms import rigid_collision
from softcradle.physics.analysis.contact_distance import GRADED, squared_difference
from softcradle.physics.analysis.critical_speed import critical_speed
from softcradle.physics.analysis.matching import match
from softcradle.sandbox.studies.bed_experiment import (
    MASS,
    PRECOMPRESSION,
    STIFFNESS,
    deficits,
    friction_for,
)
from softcradle.sandbox.studies.claims.claim import Claim, Parameters, grid
from softcradle.sandbox.studies.claims.soft_chains import first_opening, start
from softcradle.sandbox.studies.claims.solver import Solver

GEAR = draft_gear(STIFFNESS, PRECOMPRESSION)
SPEEDS = (0.3, 0.6, 0.9, 0.97, 0.99, 1.01, 1.03, 1.1, 1.3, 1.7, 2.5, 4.0)  # over the critical speed


def distance_from_rigid(case: Parameters, solver: Solver) -> float:
    """Largest difference of a final velocity from that of two rigid bodies, over the striker's."""
    strikers, chain = round(case["strikers"]), Chain(MASS, GEAR)
    speed = case["V/v_c"] * critical_speed(GEAR, MASS, strikers)
    found = solver.motion(chain, start(chain, strikers, speed)).final_velocity / speed
    return float(np.abs(found - rigid_collision(MASS, strikers)).max())


def distance_of_power_law(case: Parameters, solver: Solver) -> float:
    """Distance of the force curves of the gear and of the power law nearest to it, by that solver."""
    chain = one_on(3, draft_gear(1.0, 1.0))
    velocity = start(chain, speed=case["V/v_c"] * critical_speed(chain.power_laws[0], chain.mass, 1))
    curves = [_force_curve(one, velocity, solver) for one in (chain, one_on(3, _nearest(chain, velocity)))]
    time, force = curves[0]
    return float(np.sqrt(squared_difference(time, force, *curves[1]) / np.trapezoid(force**2, time)))


@lru_cache(maxsize=16)
def _nearest(chain: Chain, velocity: tuple[float, ...]) -> Contact:
    return match(chain, velocity, "force").contact


def _force_curve(chain: Chain, velocity: tuple[float, ...], solver: Solver) -> tuple[np.ndarray, np.ndarray]:
    """Times and forces of the struck contact until it opens."""
    end = first_opening(solver.motion(chain, velocity))
    times = end * GRADED
    return times, solver.motion(chain, velocity, end, tuple(times.tolist())).force[:, 0]


def energy_for_momentum(case: Parameters, solver: Solver) -> float:
    """Energy deficit below 10 % of a bed that costs the stated momentum: 0.1 less the deficit."""
    strikers, speed = round(case["strikers"]), case["V"]
    friction = friction_for(case["momentum"], strikers, speed)
    return 0.1 - deficits(strikers, speed, friction, method=solver.method).energy


CLAIMS = (
    Claim(
        "draft-gears",
        "pre-compressed springs give rigid-body like behaviour",
        "App. C",
        "largest distance of a final velocity from that of two rigid bodies, over the striker's",
        distance_from_rigid,
        grid(strikers=(1, 2), **{"V/v_c": SPEEDS}),
        {"strikers": 1.0, "V/v_c": 0.6},
        "V/v_c",
        lambda case: case["V/v_c"],
        1e-3,
        "measured masses, k = 770 N/m, 17.7 mm, no friction; v_c is the critical speed of one on three or two on two",
        "up to v_c the cluster is exactly rigid, and no inner contact is ever loaded: there is no evanescent profile",
        refer=False,
    ),
    Claim(
        "resembles-power-law",
        "the force of a pre-compressed spring, Eq. (C1), resembles a power law with alpha << 1",
        "App. C",
        "distance of the force curves of the gear and of the nearest power law, root mean square",
        distance_of_power_law,
        grid(**{"V/v_c": (0.2, 0.35, 0.5, 0.7, 0.9)}),
        {"V/v_c": 0.5},
        "V/v_c",
        lambda case: case["V/v_c"],
        0.1,
        "one on three; resembles: force curves within 10 %",
        refer=False,
    ),
    Claim(
        "deficits",
        "the friction of the substrate explains deficits of 5-10 % in the momentum and of 10-20 % in the energy",
        "App. C",
        "10 % less the energy deficit of a bed that costs the momentum",
        energy_for_momentum,
        grid(strikers=(1, 2), momentum=(0.05, 0.075, 0.1), V=(0.25, 0.5, 1.0)),
        {"strikers": 1.0, "momentum": 0.075, "V": 0.5},
        "V",
        lambda case: case["V"],
        0.0,
        "measured masses and gears without loss; deficits from the first touch to the last opening",
        "bed friction takes momentum from slow beads, and little energy; pistons that are caught plastically take the rest",
        refer=False,
    ),
)
