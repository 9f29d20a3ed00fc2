"""Claims about the experiment of App. C. The claims concern draft gears with the measured masses and similar soft power
laws.
"""

from functools import lru_cache

import numpy as np
from scipy.optimize import minimize
from softcradle.physics import Chain, Contact, draft_gear, one_on
from softcradle.physics.analysis.closed_forms import critical_speed, rigid_collision
from softcradle.physics.analysis.matching import GRADED, match, squared_difference
from softcradle.sandbox.scene_runs import KEEPING
from softcradle.sandbox.studies.claims.claim import Claim, grid
from softcradle.sandbox.studies.experiment import MASS, PRECOMPRESSION, STIFFNESS, deficits, friction_for
from softcradle.sandbox.studies.paper import MethodFineness, Parameters, first_opening, start

GEAR = draft_gear(STIFFNESS, PRECOMPRESSION)
# Speeds of the striker relative to the critical speed.
SPEEDS = (0.3, 0.6, 0.9, 0.97, 0.99, 1.01, 1.03, 1.1, 1.3, 1.7, 2.5, 4.0)


def distance_from_rigid(case: Parameters, solver: MethodFineness) -> float:
    """Compare the final velocities with the collision of two rigid bodies.

    Return the largest difference of a velocity, divided by the striker's velocity.
    """
    strikers, chain = round(case["strikers"]), Chain(MASS, GEAR)
    speed = case["V/v_c"] * critical_speed(GEAR, MASS, strikers)
    found = solver.motion(chain, start(chain, strikers, speed)).final_velocity / speed
    return float(np.abs(found - rigid_collision(MASS, strikers)).max())


def distance_of_power_law(case: Parameters, solver: MethodFineness) -> float:
    """Return the distance between the force curve of the draft gear and the curve of the nearest power law."""
    chain = one_on(3, draft_gear(1.0, 1.0))
    velocity = start(chain, speed=case["V/v_c"] * critical_speed(chain.power_laws[0], chain.mass, 1))
    curves = [_force_curve(one, velocity, solver) for one in (chain, one_on(3, _nearest(chain, velocity)))]
    time, force = curves[0]
    return float(np.sqrt(squared_difference(time, force, *curves[1]) / np.trapezoid(force**2, time)))


def fitted_exponent(case: Parameters, solver: MethodFineness) -> float:
    """Return the exponent of the power law whose force curve is nearest to the curve of the draft gear."""
    chain = one_on(3, draft_gear(1.0, 1.0))
    velocity = start(chain, speed=case["V/v_c"] * critical_speed(chain.power_laws[0], chain.mass, 1))
    curve, near = _force_curve(chain, velocity, solver), _nearest(chain, velocity)

    def apart(logarithms: np.ndarray) -> float:
        f0, alpha = np.exp(logarithms).tolist()
        return float(squared_difference(*curve, *_force_curve(one_on(3, Contact(0.0, f0, alpha)), velocity, solver)))

    first = np.log([near.stiffness, near.exponent])
    return float(np.exp(minimize(apart, first, method="Nelder-Mead", options={"xatol": 1e-3, "fatol": 1e-10}).x[1]))


@lru_cache(maxsize=16)
def _nearest(chain: Chain, velocity: tuple[float, ...]) -> Contact:
    return match(chain, velocity, "force").contact


def _force_curve(chain: Chain, velocity: tuple[float, ...], solver: MethodFineness) -> tuple[np.ndarray, np.ndarray]:
    """Return the times and forces of the struck contact until it opens."""
    end = first_opening(solver.motion(chain, velocity))
    times = end * GRADED
    return times, solver.motion(chain, velocity, end, tuple(times.tolist())).force[:, 0]


def energy_for_momentum(case: Parameters, solver: MethodFineness) -> float:
    """Return 0.1 minus the relative energy deficit that a bed with the stated momentum loss causes."""
    strikers, speed = round(case["strikers"]), case["V"]
    friction = friction_for(case["momentum"], strikers, speed)
    return 0.1 - deficits(strikers, speed, friction, method=solver.method).energy


CLAIMS = (
    Claim(
        name="draft-gears", place="App. C",
        statement="pre-compressed springs give rigid-body like behaviour",
        quantity="largest distance of a final velocity from that of two rigid bodies, over the striker's",
        measure=distance_from_rigid,
        cases=grid(strikers=(1, 2), **{"V/v_c": SPEEDS}), own={"strikers": 1.0, "V/v_c": 0.6},
        variable="V/v_c", order=lambda case: case["V/v_c"], allowed=1e-3,
        how="measured masses, k = 770 N/m, 17.7 mm, no friction; v_c is the critical speed of one on three or two on two",
        remark="up to v_c the cluster is exactly rigid, and no inner contact is ever loaded: there is no evanescent profile",
        refer=False,
    ),
    Claim(
        name="resembles-power-law", place="App. C",
        statement="the force of a pre-compressed spring, Eq. (C1), resembles a power law with alpha << 1",
        quantity="distance of the force curves of the gear and of the nearest power law, root mean square",
        measure=distance_of_power_law,
        cases=grid(**{"V/v_c": (0.2, 0.35, 0.5, 0.7, 0.9)}), own={"V/v_c": 0.5},
        variable="V/v_c", order=lambda case: case["V/v_c"], allowed=0.1,
        how="one on three; resembles: force curves within 10 %",
        refer=False,
    ),
    Claim(
        name="small-exponent", place="App. C",
        statement="the power law that a pre-compressed spring resembles has alpha << 1",
        quantity="exponent of the power law nearest to the gear", measure=fitted_exponent,
        cases=grid(**{"V/v_c": (0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.2, 2.0, 4.0)}), own={"V/v_c": 0.5},
        variable="V/v_c", order=lambda case: case["V/v_c"], allowed=0.1,
        how="one on three; nearest by the curves of the striker's force; << 1 is read as at most 0.1",
        remark="it grows with the stroke over the precompression, and tends to 1, that of the bare spring, for fast strikers",
        second=MethodFineness(KEEPING, 1e-3), refer=False,
    ),
    Claim(
        name="deficits", place="App. C",
        statement="the friction of the substrate explains deficits of 5-10 % in the momentum and of 10-20 % in the energy",
        quantity="10 % less the energy deficit of a bed that costs the momentum", measure=energy_for_momentum,
        cases=grid(strikers=(1, 2), momentum=(0.05, 0.075, 0.1), V=(0.25, 0.5, 1.0)),
        own={"strikers": 1.0, "momentum": 0.075, "V": 0.5},
        variable="V", order=lambda case: case["V"], allowed=0.0,
        how="measured masses and gears without loss; deficits from the first touch to the last opening",
        remark="bed friction takes momentum from slow beads, and little energy; pistons that are caught plastically "
        "take the rest",
        refer=False, chosen=False,
    ),
)  # fmt: skip
