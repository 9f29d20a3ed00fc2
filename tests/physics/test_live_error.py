"""Tests of the error that a State estimates over the frames of `advance`. A State must warn if the estimate is above
the guaranteed error.
"""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, Contact, Coupler, State, advance, one_on, power_law, simulate
from softcradle.physics.adaptive.error_estimate import error_growth
from softcradle.physics.adaptive.step_records import GROWTH
from softcradle.physics.simulation import move
from softcradle.physics.status import WarningCode

from tests.helpers.relations import PROMISE, simulate_quietly, struck

# Contact laws of three wagons whose couplers pull after a slack. The motion of these wagons amplifies errors a
# hundredfold.
PUSH, OTHER = Contact(0.21, 65.0, 1.0), Contact(0.46, 1.67, 1.5)
TRAIN = Chain(
    [0.25, 0.14, 2.1],
    [
        Coupler(PUSH, pull=Contact(0.4, 1.5, 1.5), slack=0.05, travel=0.05, stop=457.0),
        Coupler(OTHER, travel=0.05, stop=163.0),
    ],
    gap=[0.15, 0.0],
)
START = [1.0, 0.0, 0.0]
CRADLE = one_on(4, power_law(1.0, 0.1))


def after(chain: Chain, velocity, duration: float, frames: int, tolerance: float, method: str = "accurate") -> State:
    """Return the state after `frames` frames. The state contains the warnings of the last frame."""
    state = State.at_start(chain, velocity)
    for _ in range(frames):
        move(chain, state, duration / frames, method, None, tolerance, 200_000)
    return state


@pytest.mark.parametrize("frames", [1, 10, 300])
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_live_couplers_report_errors_above_the_guarantee(tolerance: float, frames: int) -> None:
    """Check that an error above the guarantee causes a warning. In an earlier version, a frame at the tolerance 1e-8
    had an error of 164 tolerances without a warning.
    """
    right = simulate_quietly(TRAIN, START, 5.0, tolerance=1e-10, samples=2).final_velocity
    state = after(TRAIN, START, 5.0, frames, tolerance)
    error = np.abs(state.velocity(TRAIN) - right).max()
    assert error <= state.velocity_error
    codes = [warning.code for warning in state.warnings]
    assert codes == ([WarningCode.ESTIMATE] if state.velocity_error > PROMISE * tolerance else [])


def test_advance_warns_above_the_guarantee() -> None:
    state = State.at_start(TRAIN, START)
    with pytest.warns(RuntimeWarning, match="velocities may be off by .* m/s, more than accurate guarantees"):
        advance(TRAIN, state, 5.0, "accurate", tolerance=1e-8)
    assert state.warnings[0].numbers["error"] == state.velocity_error


def coupled_row(seed: int) -> tuple[Chain, list[float]]:
    rng = np.random.default_rng(seed)
    couplers = [
        Coupler(
            Contact(rng.uniform(0.0, 0.5), 10.0 ** rng.uniform(0, 2), rng.choice([1.0, 1.5])),
            pull=Contact(rng.uniform(0.0, 0.5), 10.0 ** rng.uniform(0, 2), 1.0),
            slack=0.05 * rng.random(),
            travel=0.05,
            stop=10.0 ** rng.uniform(2, 3),
        )
        for _ in range(4)
    ]
    return Chain(rng.uniform(0.1, 3.0, 5), couplers), [1.0, *[0.0] * 4]


@pytest.mark.parametrize("frames", [1, 60])
@pytest.mark.parametrize("seed", range(8))
def test_live_rows_of_couplers_are_within_what_they_report(seed: int, frames: int) -> None:
    chain, velocity = coupled_row(seed)
    exact = simulate_quietly(chain, velocity, 3.0, tolerance=1e-10, samples=2)
    state = after(chain, velocity, 3.0, frames, 1e-6)
    allowed = max(state.velocity_error, PROMISE * 1e-6)
    assert np.abs(state.velocity(chain) - exact.final_velocity).max() <= allowed + exact.velocity_error.max()


def growth(state: State) -> float:
    scratch = state.work["adaptive"].scratch
    return float(error_growth(scratch.control[GROWTH], scratch.grown, scratch.turns))


@pytest.mark.parametrize("frames", [7, 60, 300])
def test_the_growth_of_errors_goes_on_from_frame_to_frame(frames: int) -> None:
    """Check that error amplification accumulates over several frames. A flight or a bounce can last many frames."""
    whole = growth(after(TRAIN, START, 4.6, 1, 1e-6))
    assert whole > 15.0
    assert growth(after(TRAIN, START, 4.6, frames, 1e-6)) == pytest.approx(whole, rel=0.5)


def test_a_short_collision_has_no_warning() -> None:
    state = after(CRADLE, struck(CRADLE), 10.0, 600, 1e-8)
    right = simulate(CRADLE, struck(CRADLE), 10.0, samples=2).final_velocity
    assert np.abs(state.velocity(CRADLE) - right).max() < state.velocity_error < 1e-7
    assert not state.warnings


def test_a_copy_goes_on_from_the_error_that_it_has() -> None:
    state = after(TRAIN, START, 2.0, 20, 1e-6)
    copy, error = state.copy(), state.velocity_error
    assert copy.velocity_error == error > 0.0
    move(TRAIN, copy, 0.1, "accurate", None, 1e-6, 200_000)
    assert copy.velocity_error >= error
    copy.velocity_error = 0.0  # After this reset, the error estimate starts again from zero.
    move(TRAIN, copy, 1e-3, "accurate", None, 1e-6, 200_000)
    assert copy.velocity_error < 0.1 * error


@pytest.mark.parametrize("method", ["verlet", "conserving", "scipy"])
def test_a_method_without_an_estimate_leaves_none(method: str) -> None:
    state = after(CRADLE, struck(CRADLE), 0.1, 1, 1e-6, method)
    assert math.isnan(state.velocity_error)
    move(CRADLE, state, 0.1, "accurate", None, 1e-6, 200_000)
    assert math.isnan(state.velocity_error)  # The estimate includes the unknown error of the previous frame.
    assert not state.warnings


def test_a_frame_that_another_method_finishes_has_no_estimate() -> None:
    state = State.at_start(CRADLE, struck(CRADLE))
    move(CRADLE, state, 0.5, "accurate", None, 1e-8, 3)
    assert math.isnan(state.velocity_error)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8])
def test_an_estimate_is_at_most_what_energy_allows(tolerance: float) -> None:
    """Check the estimated error of beads that bounce between two walls for minutes. This motion amplifies errors by
    millions. The total energy limits the speed of each bead and therefore its error.
    """
    chain = Chain([math.inf, 1.0, 1.5, 2.0, math.inf], power_law(1e3, 1.0), gap=0.1)
    velocity = [0.0, 1.0, -0.3, 0.2, 0.0]
    state = after(chain, velocity, 100.0, 100, tolerance)
    assert state.velocity_error < 2.0 * math.sqrt(2.0 * state.energy(chain))
