"""Tests of couplers. Solid stops and slack are compared with closed forms, and all methods with the reference. Error
messages are checked as well.
"""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from softcradle.physics.contact import Contact, hooke, power_law
from softcradle.physics.methods import METHODS, find_method
from softcradle.physics.simulation import solve

from softcradle import Chain, Coupler, State, TimedForce, advance, simulate, stable_step
from tests.helpers.relations import fineness

CARRY = [method.name for method in METHODS if method.couplers]
GEAR = Contact(250e3, 3.75e7, 1.7, loss=0.8)
TRAIN = Coupler(GEAR, pull=GEAR, slack=0.02, travel=0.166, stop=1e8)


def bounce_in_the_stop(spring, stop, travel, mass, speed):
    """Return the peak force and the contact time of a collision with a spring and a stop. The stop is a second spring
    that acts above the overlap `travel`. The motion consists of two sine arcs.
    """
    soft, hard = math.sqrt(spring / mass), math.sqrt((spring + stop) / mass)
    first = math.asin(soft * travel / speed) / soft
    left = speed * math.cos(soft * first)
    # With the total stiffness, this displacement gives the force at which the stop begins to act.
    offset = spring * travel / (spring + stop)
    reach = math.hypot(offset, left / hard)
    return (spring + stop) * reach, 2.0 * (first + math.atan2(left / hard, offset) / hard)


@pytest.mark.parametrize("side", [1.0, -1.0], ids=["pushed", "pulled"])
@pytest.mark.parametrize("method", CARRY)
def test_two_wagons_bounce_in_the_solid_stop(method, side):
    spring, stop, travel, mass, speed = 5e6, 2e8, 0.1, 80e3, 2.0
    pulled = {"pull": hooke(spring), "slack": 1.0} if side < 0.0 else {}
    chain = Chain([mass, mass], Coupler(hooke(spring), **pulled, travel=travel, stop=stop), gap=1.0 if pulled else 0.0)
    peak, time = bounce_in_the_stop(spring, stop, travel, mass / 2.0, speed)
    # The expression on the right is the peak force of the spring without the stop, times five.
    assert peak > 5.0 * speed * math.sqrt(spring * mass / 2.0)
    found = simulate(chain, [side * speed, 0.0], 1.2 * time, samples=401, method=method, **fineness(method, 2e-6))
    assert (side * found.force).max() == pytest.approx(peak, rel=1e-4)
    assert found.final_velocity == pytest.approx([0.0, side * speed], abs=1e-4)
    ((closed, opened),) = found.contact_intervals[0]
    assert (closed, opened) == (pytest.approx(0.0, abs=1e-5), pytest.approx(time, abs=1e-5))
    assert np.abs(found.ledger / found.ledger[0] - 1.0).max() < (1e-4 if method == "euler" else 1e-8)


@pytest.mark.parametrize("travel", [1e-3, 1e-2, 1e-1])
@pytest.mark.parametrize("method", ["radau", "dop853", "accurate"])
def test_a_contact_closes_at_its_start_even_if_the_first_step_ends_at_the_stop(method, travel):
    chain = Chain([1.0, 1.0], Coupler(hooke(10.0), travel=travel, stop=1e3), gap=0.5)
    _, time = bounce_in_the_stop(10.0, 1e3, travel, 0.5, 1.0)
    found = simulate(chain, [1.0, 0.0], 1.0, method=method, samples=2)
    assert found.contact_intervals[0] == (pytest.approx((0.5, 0.5 + time), abs=1e-6),)


@pytest.mark.parametrize("method", CARRY)
def test_wagons_of_a_pulled_train_start_one_after_another(method):
    """Compare the start times of wagons with the start times for hard links, which transmit all momentum. Wagon k
    starts at T (k + 1) / 2 with T = sqrt(2 s m / F).
    """
    force, mass, slack, wagons = 1e5, 8e4, 0.02, 5
    whole = math.sqrt(2.0 * slack * mass / force)
    end, errors = 0.95 * whole * (wagons + 1) / 2.0, []
    for stiffness in (1e10, 1e12):
        # At the start, each coupler is in the middle of its slack.
        link = Coupler(hooke(stiffness), pull=hooke(stiffness), slack=2.0 * slack)
        chain = Chain([mass] * (wagons + 1), link, slack, forces=TimedForce(wagons, 0.0, force))
        contact = math.pi / math.sqrt(stiffness * 2.0 / mass)
        found = simulate(chain, [0.0] * (wagons + 1), end, samples=2, method=method, **fineness(method, contact / 50.0))
        starts = [spans[0][0] for spans in reversed(found.contact_intervals) if spans]
        wanted = [whole * (k + 1) / 2.0 for k in range(1, wagons)]
        assert len(starts) == len(wanted)
        errors.append(np.abs(np.array(starts) - wanted).max())
    assert errors[0] < 10.0 * math.pi / math.sqrt(1e10 * 2.0 / mass)  # Each link delays the start by its contact time.
    assert errors[1] < 0.15 * errors[0]  # If the stiffness is a hundred times larger, the error is a tenth.


@pytest.mark.parametrize("method", ["euler", "verlet", "conserving", "scipy"])
def test_pulling_is_pushing_seen_from_the_other_side(method):
    chain, finer = Chain([8e4, 8e4], TRAIN, 0.01), fineness(method, 1e-4)
    pushing, pulling = (simulate(chain, [speed, 0.0], 0.6, method, samples=31, **finer) for speed in (3.0, -3.0))
    np.testing.assert_allclose(pulling.overlap + 0.02, -pushing.overlap, atol=1e-9)
    np.testing.assert_allclose(pulling.force, -pushing.force, atol=2e-2)
    for pushed, pulled in zip(pushing.contact_intervals[0], pulling.contact_intervals[0], strict=True):
        assert pulled == pytest.approx(pushed, abs=1e-9)


@pytest.mark.parametrize("method", ["auto", "accurate", "radau", "dop853"])
def test_adaptive_methods_reject_soft_pulling_gears(method):
    soft = power_law(1e5, 0.5)
    for coupler in (Coupler(soft, pull=soft), Coupler(soft, travel=0.1, stop=1e8)):
        with pytest.raises(ValueError, match="have exponents of 1 or more: take 'conserving' or 'scipy'"):
            simulate(Chain([1.0, 1.0], coupler), [1.0, 0.0], 1.0, method)
    pushed = simulate(Chain([1.0, 1.0], Coupler(soft)), [1.0, 0.0], 1.0, method)
    assert pushed.final_velocity == pytest.approx([0.0, 1.0], abs=1e-6)


def test_the_alternative_to_yoshida4_accepts_the_chain():
    for law in (hooke(1e5), Coupler(hooke(1e5)), lambda overlap: 1e5 * overlap):
        chain = Chain([1.0, 1.0], law, friction=0.1)
        with pytest.raises(ValueError, match="carries neither bed friction nor contacts with loss: take") as refused:
            simulate(chain, [1.0, 0.0], 0.1, "yoshida4")
        for method in re.findall(r"'(\w+)'", str(refused.value).partition(": take ")[2]):
            assert simulate(chain, [1.0, 0.0], 0.1, method).absorbed_by_bed[-1] > 0.0


def test_the_stable_step_knows_the_stop():
    links = [Coupler(hooke(1e6), travel=0.1, stop=stop) for stop in (1e6, 1e10)]
    soft, hard = (stable_step(Chain([8e4] * 2, link), [3, 0], 0.5) for link in links)
    assert hard < 0.2 * soft
    # The pulling part of this coupler is much stiffer than the pushing part.
    chain = Chain([1.0, 1.0], Coupler(hooke(10.0), pull=hooke(1e6), slack=0.1))
    assert stable_step(chain, [0, 1], 0.5) < 1e-2 * stable_step(Chain([1.0, 1.0], hooke(10.0)), [1, 0], 0.5)
    assert solve(chain, [0.0, 1.0], 0.15, "verlet").final_velocity == pytest.approx([1.0, 0.0], abs=1e-3)


# Coupler of wagons of 30 t that meet at 1.5 m/s. The peak force sqrt(mu k) v is 580 948 N.
WAGONS = Coupler(hooke(1e7), pull=hooke(1e7), slack=0.02)
BLOW = 1.5 * math.sqrt(1.5e4 * 1e7)


@pytest.mark.parametrize("method", CARRY)
def test_a_wagon_that_rolls_up_couples_when_it_meets_the_other(method):
    """Check a wagon that rolls toward another wagon. The coupler does not pull across the gap. After the collision the
    coupler runs through its slack and pulls with the same peak force.
    """
    found = simulate(
        Chain([3e4, 3e4], WAGONS, gap=0.05), [1.5, 0.0], 0.3, method, samples=301, **fineness(method, 1e-5)
    )
    error = 1e-3 if method == "euler" else 1e-5
    meets, lasts = 0.05 / 1.5, math.pi * math.sqrt(1.5e4 / 1e7)
    assert not found.force[found.time < meets - 1e-3].any()
    assert not found.contact_energy[found.time < meets - 1e-3].any()
    (push, pull) = found.contact_intervals[0]
    assert push == pytest.approx((meets, meets + lasts), abs=1e-4)
    assert pull == pytest.approx((meets + lasts + 0.02 / 1.5, meets + 2.0 * lasts + 0.02 / 1.5), abs=2e-4)
    # These peak forces are reached between samples.
    assert (found.force.max(), found.force.min()) == pytest.approx((BLOW, -BLOW), rel=1e-3)
    np.testing.assert_allclose(found.ledger, found.ledger[0], rtol=error)


@pytest.mark.parametrize("method", CARRY)
def test_wagons_that_part_before_they_met_are_not_held(method):
    found = simulate(Chain([1.0, 1.0], WAGONS, gap=0.05), [0.0, 1.0], 0.1, method, samples=3, **fineness(method, 1e-4))
    assert not found.force.any()
    assert found.final_velocity.tolist() == [0.0, 1.0]
    held = replace(WAGONS, coupled=True)
    found = simulate(Chain([1.0, 1.0], held, gap=0.05), [0.0, 1.0], 1e-4, method, samples=3, **fineness(method, 1e-6))
    assert found.force[0, 0] == pytest.approx(-1e7 * 0.03)


@pytest.mark.parametrize(
    ("coupled", "gap", "at_start"),
    [
        (None, 0.0, 1),
        (None, 0.02, 1),
        (None, 0.021, 0),
        (None, -0.01, 1),
        (False, 0.01, 0),
        (False, 0.0, 1),
        (True, 0.05, 1),
    ],
)
def test_the_option_tells_whether_a_coupler_is_coupled_at_the_start(coupled, gap, at_start):
    chain = Chain([1.0, 1.0], replace(WAGONS, coupled=coupled), gap=gap)
    assert State.at_start(chain, [0.0, 0.0]).coupled.tolist() == [at_start]
    assert bool(simulate(chain, [0.0, 0.5], 0.2, "conserving", samples=2).contact_intervals[0]) == bool(at_start)


@pytest.mark.parametrize("method", CARRY)
def test_frames_of_live_use_couple_as_a_run_does(method):
    """Check that the State stores from frame to frame which couplers are coupled. A copy of the State and a run
    continue with these couplers.
    """
    chain = Chain([3e4, 2e4, 3e4], WAGONS, gap=[0.05, 0.03])
    state, end = State.at_start(chain, [1.5, 0.0, 0.0]), 0.35
    whole = simulate(chain, [1.5, 0.0, 0.0], end, method, samples=2, **fineness(method, 1e-4))
    seen = [state.coupled.tolist()]
    for _ in range(35):
        state = state.copy()
        advance(chain, state, 0.01, method, **fineness(method, 1e-4))
        seen.append(state.coupled.tolist())
    assert [seen[k] for k in range(1, 36) if seen[k] != seen[k - 1]] == [[1, 0], [1, 1]]
    assert state.velocity(chain) == pytest.approx(
        whole.final_velocity, abs=1e-6 if find_method(method).adaptive else 1e-9
    )
    assert whole.force.min() <= 0.0


def test_couplers_of_a_long_row_couple_one_after_another():
    """Check a wagon that is pushed into a row of wagons at rest. Each pair of wagons couples when the wagons meet. At
    the end all wagons form one train.
    """
    chain = Chain([3e4] * 6, replace(WAGONS, push=hooke(1e7, 0.5), pull=hooke(1e7, 0.5)), gap=0.05, friction=0.0)
    found = simulate(chain, [1.5, *[0.0] * 5], 12.0, "conserving", samples=601)
    first = [spans[0][0] for spans in found.contact_intervals]
    assert first == sorted(first)
    assert found.overlap[-1].min() > -0.02 - 1e-3
    assert np.ptp(found.final_velocity) < 0.1


def test_wrong_options_of_coupling_are_refused():
    with pytest.raises(ValueError, match="coupler coupled must be True, False or None, not 'yes'"):
        replace(WAGONS, coupled="yes")
    with pytest.raises(ValueError, match="with the option coupled needs a pull"):
        Coupler(hooke(1.0), coupled=False)
