"""Claims about one collision from Secs. I and IV and Figs. 1b to 1d of the paper."""

import math

import numpy as np
from softcradle.physics.analysis.ringing import turning_points
from softcradle.sandbox.studies.claims.claim import Claim, grid
from softcradle.sandbox.studies.paper import (
    FINER_SECOND,
    FINEST_SECOND,
    OWN,
    SWING,
    MethodFineness,
    Parameters,
    chain_of,
    first_opening,
    outcome,
    spread,
    start,
)

STEP_OF_INVERSE = 0.25  # Step of 1/alpha between two points of a curve of the spread.
WINDOW_STEP = 0.5  # Step of 1/alpha between two points of a window.
# Width of the window of 1/alpha in which the largest spread is taken. The window contains several peaks of the spread.
WINDOW = 4.0


def rise_of_spread(case: Parameters, solver: MethodFineness) -> float:
    """Return the logarithm of the ratio of two velocity spreads.

    The spreads belong to 1/alpha and to the value of 1/alpha one step below. The result is above 0 if the spread rises
    as alpha falls.
    """
    before = {**case, "1/alpha": case["1/alpha"] - STEP_OF_INVERSE}
    return math.log(spread(case, solver) / spread(before, solver))


def envelope_ratio(case: Parameters, solver: MethodFineness) -> float:
    """Return the largest spread in a window of 1/alpha, divided by the largest spread in the window before it.

    The window begins at the value of 1/alpha of the case.
    """
    inverse = np.arange(0.0, WINDOW, WINDOW_STEP)
    largest = [
        max(spread({**case, "1/alpha": float(begin + part)}, solver) for part in inverse)
        for begin in (case["1/alpha"] - WINDOW, case["1/alpha"])
    ]
    return largest[1] / largest[0]


def others_over_first(case: Parameters, solver: MethodFineness) -> float:
    """Compare the first target with the other targets, and return a ratio of velocities.

    The numerator is the spread of the targets behind the first one. The denominator is the difference between the first
    target's velocity and the mean of the others.
    """
    velocity = outcome(case, solver)[1:]
    return float(np.ptp(velocity[1:]) / abs(velocity[1:].mean() - velocity[0]))


def turns_after_detachment(case: Parameters, solver: MethodFineness) -> float:
    """Return the largest number of turning points of a target velocity after the striker has detached."""
    chain = chain_of(case)
    whole = solver.motion(chain, start(chain))
    detached, end = first_opening(whole), float(whole.time[-1])
    times = tuple(np.linspace(detached, end, 4001).tolist())
    velocity = solver.motion(chain, start(chain), end, times).velocity[:, 1:]
    return float(max(turning_points(column, SWING).size for column in velocity.T))


CLAIMS = (
    Claim(
        name="rigid-like", place="Sec. I, Figs. 1c, 1d",
        statement="the velocities of the targets differ after the collision, and the differences decrease as alpha -> 0",
        quantity="rise of the logarithm of the spread from 1/alpha - 0.25 to 1/alpha", measure=rise_of_spread,
        cases=grid(n=(2, 3, 4), **{"1/alpha": np.arange(6.0, 19.0, STEP_OF_INVERSE)}), own=OWN,
        variable="1/alpha", order=lambda case: case["1/alpha"], allowed=0.0,
        how="spread of the targets' velocities over their mean when every contact is open",
        remark="the spread falls, but not steadily: it rises where the inner contact comes back in or out of step with "
        "the striker",
        second=FINER_SECOND, chosen=False,
    ),
    Claim(
        name="spread-vanishes", place="caption of Fig. 1, Fig. 3 of ref. [1]",
        statement="the deviation of the targets' velocities vanishes as alpha -> +0",
        quantity="largest spread in a window of 4 in 1/alpha over that of the window before", measure=envelope_ratio,
        cases=grid(n=(2, 3, 4), **{"1/alpha": np.arange(7.0, 18.0, 1.0)}), own={"n": 2.0, "1/alpha": 10.0},
        variable="1/alpha", order=lambda case: case["1/alpha"], allowed=0.8,
        how="the largest of 8 spreads in each window: the envelope, since the spread itself does not fall steadily",
        second=FINER_SECOND, refer=False,
    ),
    Claim(
        name="first-target", place="caption of Fig. 1",
        statement="v1 shows well-visible deviations from the remaining targets",
        quantity="spread of the remaining targets over the distance of v1 from their mean", measure=others_over_first,
        cases=grid(n=(3, 4, 5, 6, 8, 12), **{"1/alpha": (6, 8, 10, 12, 14, 16)}), own=OWN,
        variable="n alpha", order=lambda case: case["n"] / case["1/alpha"], allowed=0.5,
        how="velocities when every contact is open; v1 stands out where the others differ by at most half as much",
        second=FINER_SECOND,
    ),
    Claim(
        name="after-detachment", place="Sec. IV",
        statement="once the striker has left, the overlaps left behind drive the targets apart in a non-oscillatory manner",
        quantity="most turning points of a target's velocity after the detachment", measure=turns_after_detachment,
        cases=grid(n=(2, 3, 4, 5, 6), **{"1/alpha": (6, 8, 9, 10, 11, 12, 14, 16, 18)}), own=OWN,
        variable="1/alpha", order=lambda case: case["1/alpha"], allowed=1.0,
        how="4001 samples from the detachment to the end; a swing below 1e-5 of the striker's speed is none",
        second=FINEST_SECOND, chosen=False,
    ),
)  # fmt: skip
