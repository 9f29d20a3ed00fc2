"""Tests of beads on strings. The tests compare two beads with closed forms, and a cradle with losses with its published
motion. Further tests check energy, symmetry, limits, and the chains that methods reject.
"""

import math
import warnings

import numpy as np
import pytest
from softcradle.physics import (
    Chain,
    ChainBatch,
    Contact,
    Coupler,
    State,
    TimedForce,
    advance,
    draft_gear,
    ensemble,
    hertz,
    hooke,
    power_law,
    simulate,
)
from softcradle.physics.methods import METHODS
from softcradle.physics.trajectory import Trajectory

from tests.helpers.relations import fineness, simulate_quietly

HANGING = tuple(method.name for method in METHODS if method.name != "pymunk")
ADAPTIVE = ("accurate", "radau", "dop853", "scipy")
LENGTH, SPEED = 0.1, 0.3
OMEGA = math.sqrt(9.80665 / LENGTH)
PERIOD = 2.0 * math.pi / OMEGA
# Cradle whose contacts last about a hundredth of a swing.
BALLS = Chain([0.1] * 5, hertz(3e5), strings=LENGTH)


def test_the_frequency_of_strings():
    assert BALLS.swing == pytest.approx(OMEGA**2)
    assert Chain([1.0, 1.0], hertz(1.0), strings=2.0, gravity=1.62).swing == pytest.approx(0.81)
    assert Chain([1.0, 1.0], hertz(1.0)).swing == 0.0


@pytest.mark.parametrize("method", HANGING)
def test_a_ball_that_touches_nothing_swings_as_a_cosine(method):
    chain = Chain([1.0, 2.0], hertz(1e3), gap=1.0, strings=LENGTH)
    times = np.linspace(0.0, 3.3 * PERIOD, 34)
    found = simulate(chain, [SPEED, 0.0], times[-1], method, samples=times, **fineness(method, 2e-4 * PERIOD))
    order = next(one.order for one in METHODS if one.name == method)
    allowed = 1e-3 if order == 1 else 1e-6
    assert found.velocity[:, 0] == pytest.approx(SPEED * np.cos(OMEGA * times), abs=allowed * SPEED)
    assert found.position[:, 0] == pytest.approx(SPEED / OMEGA * np.sin(OMEGA * times), abs=allowed * SPEED / OMEGA)
    assert found.position[:, 1] == pytest.approx(1.0)


def closed_form(chain: Chain, time: float) -> tuple[float, float]:
    """Return the velocities of two equal beads with a Hooke contact. The first bead starts at SPEED.

    While the contact is closed, the overlap is half a sine with the angular frequency sqrt(2 k/m + omega²). While the
    contact is open, the overlap is half a sine with the angular frequency omega. The centre of mass swings freely.
    """
    (law, *_), mass = chain.power_laws, chain.mass[0]
    omega = math.sqrt(chain.swing)
    inside = math.sqrt(2.0 * law.stiffness / mass + omega**2)
    left = time % (math.pi / inside + math.pi / omega)
    rate = (
        math.cos(inside * left) if inside * left < math.pi else -math.cos(omega * (left - math.pi / inside))
    ) * SPEED
    mean = 0.5 * SPEED * math.cos(omega * time)
    return mean + 0.5 * rate, mean - 0.5 * rate


@pytest.mark.parametrize("method", ADAPTIVE)
def test_two_balls_exchange_their_momentum_as_in_closed_form(method):
    chain = Chain([1.0, 1.0], hooke(1e6), strings=LENGTH)
    for swings in (0.25, 0.9, 5.37):
        found = simulate(chain, [SPEED, 0.0], swings * PERIOD, method, samples=2, tolerance=1e-9)
        assert found.final_velocity == pytest.approx(closed_form(chain, swings * PERIOD), abs=1e-8 * SPEED)
    # Just after the first collision the second ball has the momentum of the first ball.
    struck = simulate(chain, [SPEED, 0.0], 0.01 * PERIOD, method, samples=2).final_velocity
    assert struck == pytest.approx([0.0, SPEED], abs=0.01 * SPEED)


@pytest.mark.parametrize(("method", "order"), [("euler", 1), ("verlet", 2), ("yoshida4", 4), ("conserving", 2)])
def test_fixed_steps_converge_with_their_order(method, order):
    chain = Chain([1.0, 1.0], hooke(100.0), gap=-0.02, strings=LENGTH)  # This contact never opens.
    end, steps = 0.7, np.array([200, 400])
    swing = OMEGA**2 + 200.0
    # The overlap oscillates about the value at which the strings and the contact are in balance.
    middle = 0.02 * OMEGA**2 / swing
    exact = (0.02 - middle) * math.cos(math.sqrt(swing) * end)
    found = [
        simulate(chain, [0.0, 0.0], 1e-2 * end, method, step=1e-2 * end / n, samples=2).overlap[-1, 0] for n in steps
    ]
    errors = np.abs(np.array(found) - middle - (0.02 - middle) * math.cos(math.sqrt(swing) * 1e-2 * end))
    assert abs(exact) < 0.02
    assert errors[1] < 1.2 * errors[0] / 2**order or errors[0] < 1e-15


@pytest.mark.parametrize("chain", [BALLS, Chain([0.1] * 4, power_law(50.0, 0.2), strings=LENGTH)])
def test_conserving_keeps_the_energy_over_a_thousand_swings(chain):
    found = simulate_quietly(
        chain, [-SPEED] + [0.0] * chain.contacts, 1000 * PERIOD, "conserving", step=PERIOD / 700, samples=300
    )
    assert found.steps > 100_000
    assert np.ptp(found.ledger) < 1e-10 * found.ledger[0]
    assert found.kinetic_energy.min() < 0.5 * found.ledger[0] < found.string_energy.max()


@pytest.mark.slow
@pytest.mark.parametrize(("law", "strikers"), [(hertz(3e5), 1), (hertz(3e5), 2), (power_law(50.0, 0.2), 1)])
@pytest.mark.parametrize("method", ["accurate", "radau"])
def test_adaptive_methods_agree_with_extended_precision(law, strikers, method):
    from benchmarks.scan.extended_precision import reference_end

    chain, velocity = Chain([0.1] * 4, law, strings=LENGTH), [-SPEED] * strikers + [0.0] * (4 - strikers)
    true = reference_end(chain, velocity, 1.2 * PERIOD, 1e-12)
    found = simulate(chain, velocity, 1.2 * PERIOD, method, samples=2)
    assert true.error < 1e-10 * SPEED
    assert np.abs(found.final_velocity - true.velocity).max() < 1e-7 * SPEED


@pytest.mark.parametrize("method", ["accurate", "radau", "conserving", "verlet"])
def test_the_mirrored_row_has_the_mirrored_motion(method):
    laws, mass = [hertz(3e5), hooke(2e4), hertz(1e5)], [0.1, 0.3, 0.2, 0.1]
    start, options = [-SPEED, 0.0, 0.0, 0.5 * SPEED], fineness(method, 1e-4 * PERIOD)
    found = simulate(Chain(mass, laws, [0.0, 1e-3, 0.0], strings=LENGTH), start, 0.8 * PERIOD, method, **options)
    mirrored = Chain(mass[::-1], laws[::-1], [0.0, 1e-3, 0.0], strings=LENGTH)
    image = simulate(mirrored, [-v for v in start[::-1]], 0.8 * PERIOD, method, **options)
    assert -image.velocity[:, ::-1] == pytest.approx(found.velocity, abs=1e-6 * SPEED)


@pytest.mark.parametrize("method", HANGING)
def test_very_long_strings_are_as_good_as_none(method):
    velocity, options = [SPEED, 0.0, 0.0, 0.0], fineness(method, 2e-5)
    laws = [hertz(3e5), power_law(3.0, 0.5), hertz(1e5)]
    free = simulate_quietly(Chain([0.1] * 4, laws), velocity, 0.05, method, samples=2, **options)
    hung = simulate_quietly(Chain([0.1] * 4, laws, strings=1e12), velocity, 0.05, method, samples=2, **options)
    assert hung.final_velocity == pytest.approx(free.final_velocity, abs=1e-7 * SPEED)


def relative_energy(found: Trajectory) -> np.ndarray:
    """Return the share of the energy in the motion of the beads relative to their centre of mass, as an array of shape
    (T,).
    """
    mass = np.array(found.chain.mass)
    parts = []
    for values, factor in ((found.velocity, 1.0), (found.position - found.position[0], found.chain.swing)):
        apart = values - (values @ mass / mass.sum())[:, None]
        parts.append(0.5 * factor * apart**2 @ mass)
    return (sum(parts) + found.contact_energy) / (found.kinetic_energy + found.string_energy + found.contact_energy)


def test_balls_with_losses_end_up_swinging_together():
    """Check that all balls of a cradle with losses swing in phase at the end. The losses of the contacts damp the
    motion of the balls relative to each other. See Hutzler, Delaney, Weaire and MacLeod, "Rocking Newton's cradle",
    Am. J. Phys. 72, 1508 (2004).
    """
    steel = Chain([0.1] * 5, Contact(0.0, 3e5, 1.5, loss=0.1), strings=LENGTH)
    found = simulate_quietly(
        steel, [-SPEED, 0.0, 0.0, 0.0, 0.0], 60 * PERIOD, "conserving", step=PERIOD / 2000, samples=601
    )
    share = relative_energy(found)
    assert share[0] == pytest.approx(0.8)  # Only the first of five balls moves, so the share is 1 - 1/5.
    assert share[-100:].max() < 1e-3
    # The common swing of all balls does not lose energy, so a fifth of the energy remains.
    left = (found.kinetic_energy + found.string_energy)[-1] / found.kinetic_energy[0]
    assert left == pytest.approx(0.2, rel=1e-3)
    assert np.ptp(found.ledger) < 1e-10 * found.ledger[0]


@pytest.mark.parametrize("method", ["accurate", "radau", "conserving", "scipy"])
@pytest.mark.parametrize("loss", [0.0, 0.4])
def test_the_ledger_includes_the_strings(method, loss):
    laws = [Contact(0.0, 3e5, 1.5, loss=loss), Contact(2.0, 1e4, 1.0, loss=loss)]
    push = [TimedForce(1, [0.0, 0.1, 0.2], [0.0, 0.3, 0.0])]
    chain = Chain([0.1, 0.3, 0.2], laws, [1e-3, 0.0], drive=[0.0, 0.05, 0.0], forces=push, strings=LENGTH)
    options = fineness(method, 1e-4 * PERIOD)
    found = simulate(chain, [SPEED, 0.0, 0.0], 1.1 * PERIOD, method, **options)
    assert found.string_energy.max() > 0.1 * found.kinetic_energy[0]
    assert np.ptp(found.ledger) < 1e-7 * found.kinetic_energy[0]


@pytest.mark.parametrize("method", ["accurate", "conserving", "verlet"])
def test_a_constant_force_shifts_the_place_of_rest(method):
    chain = Chain([1.0, 2.0], hertz(1e3), gap=1.0, drive=[0.5, 0.0], strings=LENGTH)
    times = np.linspace(0.0, PERIOD, 9)
    found = simulate(chain, [0.0, 0.0], PERIOD, method, samples=times, **fineness(method, 1e-4 * PERIOD))
    assert found.position[:, 0] == pytest.approx(0.5 / OMEGA**2 * (1.0 - np.cos(OMEGA * times)), abs=1e-8)


@pytest.mark.parametrize("method", ["accurate", "radau", "dop853", "conserving", "scipy"])
def test_preloaded_contacts_touch_until_they_yield(method):
    chain = Chain([1.0] * 4, draft_gear(1e3, 0.05), strings=LENGTH)
    found = simulate(chain, [-SPEED, 0.0, 0.0, 0.0], 0.8 * PERIOD, method, samples=2, **fineness(method, 2e-5 * PERIOD))
    other = simulate(chain, [-SPEED, 0.0, 0.0, 0.0], 0.8 * PERIOD, "radau", samples=2, tolerance=1e-10)
    assert found.final_velocity == pytest.approx(other.final_velocity, abs=1e-4 * SPEED)


@pytest.mark.parametrize("method", ["accurate", "conserving", "verlet"])
def test_live_frames_follow_the_whole_motion(method):
    chain, state, frames = BALLS, State.at_start(BALLS, [-SPEED] + [0.0] * 4), 80
    whole = simulate(chain, [-SPEED] + [0.0] * 4, 1.3 * PERIOD, method, samples=2)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # The estimated error of live frames is larger.
        for _ in range(frames):
            advance(chain, state, 1.3 * PERIOD / frames, method)
    assert state.velocity(chain) == pytest.approx(whole.final_velocity, abs=2e-5 * SPEED)
    assert state.energy(chain) == pytest.approx(0.5 * 0.1 * SPEED**2, rel=1e-5)


def test_a_frame_at_a_turning_point_has_a_step_for_the_blow():
    """Check the step of a frame that begins at a turning point. At a turning point all velocities are 0. The velocities
    therefore do not determine how fast the beads will collide.
    """
    state = State.at_start(BALLS, [-SPEED] + [0.0] * 4)
    advance(BALLS, state, 0.25 * PERIOD, "accurate")
    assert np.abs(state.velocity(BALLS)).max() < 1e-6 * SPEED
    advance(BALLS, state, 0.5 * PERIOD, "conserving")
    assert state.velocity(BALLS)[4] == pytest.approx(
        simulate(BALLS, [-SPEED] + [0.0] * 4, 0.75 * PERIOD).final_velocity[4], abs=1e-3 * SPEED
    )


def test_ensembles_files_and_text_keep_the_strings(tmp_path):
    velocity = [-SPEED] + [0.0] * 4
    one = simulate(BALLS, velocity, PERIOD)
    (found,) = ensemble([BALLS], [velocity], PERIOD)
    assert np.array_equal(found.final_velocity, one.final_velocity)
    one.save(tmp_path / "swing.npz")
    again = Trajectory.load(tmp_path / "swing.npz")
    assert again.chain == BALLS
    assert np.array_equal(again.string_energy, one.string_energy)
    assert "strings=0.1" in repr(BALLS)
    assert "gravity=1.62" in repr(Chain([1, 1], hertz(1.0), strings=1.0, gravity=1.62))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"strings": 0.0}, "length of the strings"),
        ({"strings": -1.0}, "length of the strings"),
        ({"strings": 1.0, "gravity": 0.0}, "gravity"),
        ({"strings": 1.0, "friction": 0.1}, "do not lie on a bed"),
        ({"strings": 1.0, "brakes": [TimedForce(0, [0.0], [1.0])]}, "do not lie on a bed"),
    ],
)
def test_chains_that_cannot_hang(arguments, message):
    with pytest.raises(ValueError, match=message):
        Chain([1.0, 1.0], hertz(1.0), **arguments)


def test_runs_that_are_refused():
    with pytest.raises(ValueError, match="swing forever: give a duration"):
        simulate(BALLS, [SPEED] + [0.0] * 4)
    with pytest.raises(ValueError, match="a row without strings: take 'conserving'"):
        simulate(BALLS, [SPEED] + [0.0] * 4, 1.0, "pymunk")
    with pytest.raises(ValueError, match="a wall among beads on strings stays at rest"):
        simulate(Chain([math.inf, 1.0], hertz(1.0), strings=1.0), [1.0, 0.0], 1.0)
    train = Chain([1.0, 1.0], Coupler(hooke(1e3), hooke(1e3), slack=0.01, coupled=True), strings=1.0)
    with pytest.raises(ValueError, match="one contact law from overlap 0 on: take 'conserving' or 'scipy'"):
        simulate(train, [1.0, 0.0], 1.0)
    with pytest.raises(ValueError, match="chains without strings: take ensemble"):
        ChainBatch.of([BALLS])


@pytest.mark.parametrize("method", ["conserving", "verlet"])
def test_couplers_on_strings(method):
    """Compare two wagons on strings with the reference. The coupler between the wagons pulls."""
    chain = Chain([1.0, 2.0], Coupler(hooke(1e3), hooke(5e2), slack=0.01, coupled=True), strings=LENGTH)
    found = simulate(chain, [-SPEED, 0.0], 0.6 * PERIOD, method, step=1e-5, samples=2)
    true = simulate(chain, [-SPEED, 0.0], 0.6 * PERIOD, "scipy", samples=2)
    assert found.final_velocity == pytest.approx(true.final_velocity, abs=1e-4 * SPEED)
