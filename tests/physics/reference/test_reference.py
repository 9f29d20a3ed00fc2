"""Tests of the reference method: contact modes, event location, external forces, and comparisons of random motions."""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, Coupler, OwnLaw, TimedForce, cluster_on_cluster, one_on, simulate
from softcradle.physics.contact import draft_gear, hertz, hooke, power_law, step_force
from softcradle.physics.methods import refusal_of
from softcradle.physics.reference.laws import Laws
from softcradle.physics.status import Status, WarningCode

from benchmarks.scan.families import motion
from tests.helpers.relations import KERNELS, NAMES, PROMISE, assert_momentum, ledger_error, simulate_quietly

FEW = {  # Random seeds of each family of chains. For these seeds, the reference method is fast.
    "couplers": range(1, 10), "bounded": (1, 3, 5, 9, 12, 13), "timed": (2, 5, 8), "driven": (5, 7, 8, 9),
    "friction": (0, 3, 6, 7, 9), "loss": (1, 2, 3, 4, 7), "walls": (0, 2, 8), "own-laws": (1, 2, 3),
}  # fmt: skip
MORE = {"couplers": range(10, 24), "bounded": (10,), "timed": (1,), "driven": (2,), "walls": (4,)}
CHOSEN = [(family, seed) for family, seeds in FEW.items() for seed in seeds]
CHOSEN += [pytest.param(family, seed, marks=pytest.mark.slow) for family, seeds in MORE.items() for seed in seeds]


@pytest.mark.parametrize(("family", "seed"), CHOSEN)
def test_random_motions_agree_with_the_reference(family, seed):
    """Check that the errors of random motions are at most ten tolerances plus the estimated error. The method
    conserving must keep energy and momentum up to round-off.
    """
    chosen = motion(family, seed)
    chain, velocity, speed = chosen.chain, chosen.velocity, chosen.speed
    truth = simulate_quietly(chain, velocity, chosen.duration, "scipy", samples=5, tolerance=1e-9)
    end = truth.time[-1]
    assert ledger_error(truth) < 1e-9
    for method in (one for one in KERNELS if not refusal_of(one, chain)):
        found = simulate_quietly(chain, velocity, end, method, samples=5, tolerance=1e-7)
        assert np.abs(found.velocity - truth.velocity).max() < PROMISE * 1e-7 * speed, method
        assert np.abs(found.overlap - truth.overlap).max() < PROMISE * 1e-7 * max(1.0, speed), method
        off = np.abs(found.final_velocity - truth.final_velocity)
        assert (off <= found.velocity_error + 1e-8 * speed).all(), method
        assert ledger_error(found) < 1e-7, method
    found = simulate_quietly(chain, velocity, end, "conserving", end / 40_000, samples=5)
    assert np.abs(found.velocity - truth.velocity).max() < 1e-4 * speed
    assert ledger_error(found) < 1e-10
    for one in (truth, found):
        for absorbed in (one.absorbed_by_contacts, one.absorbed_by_bed):
            assert (np.diff(absorbed) >= -1e-9 * truth.ledger[0]).all()
    if not chain.on_bed:
        assert_momentum(found, velocity)


def ended(chain, velocity, duration=None):
    """Simulate the chain by the reference method with its finest tolerance."""
    return simulate(chain, velocity, duration, "scipy", samples=2, tolerance=1e-11)


def test_an_alpha_of_a_thirtieth_is_no_hindrance():
    """Check a collision with alpha = 1/30, whose inner overlaps are 1e-29. The contacts count as being at overlap 0
    until the tolerance distinguishes their overlaps from 0.
    """
    chain, start = one_on(10, power_law(1.0, 1 / 30)), [1] + [0] * 10
    found, finer = (simulate(chain, start, method="scipy", tolerance=tolerance) for tolerance in (1e-7, 1e-8))
    assert found.final_velocity == pytest.approx(finer.final_velocity, abs=1e-6)
    assert found.evaluations < 50_000


@pytest.mark.parametrize(
    ("limit", "most", "sentence"),
    [("runner.MOST_PHASES", 3, "3 changes of contacts"), ("phases.MOST_EVALUATIONS", 100, "after 101 evaluations")],
)
def test_running_out_is_a_value(limit, most, sentence, monkeypatch):
    monkeypatch.setattr(f"softcradle.physics.reference.{limit}", most)
    with pytest.warns(RuntimeWarning, match=rf"scipy gave up at t = .* {sentence}"):
        found = simulate(cluster_on_cluster(2, 3, hertz(1.0)), [1, 1, 0, 0, 0], method="scipy")
    assert len(found.warnings) == 1
    assert found.velocity.sum(axis=1) == pytest.approx(2.0, abs=1e-9)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_motion_of_which_not_one_step_can_be_taken_is_a_value():
    coupler = Coupler(draft_gear(1e3, 1e-3), draft_gear(1e29, 0.0), 1e29, 2.0, 1e-3)
    contacts, brake = [hooke(1.0, loss=0.999999), hooke(1e30), coupler], TimedForce(1, 0.0, 1e30)
    found = simulate(Chain([1.0, 0.5, 2.0, 1.0], contacts, brakes=[brake]), [1, 5, 0, 1], 1.0, "scipy")
    assert (found.status, "scipy failed at t = " in str(found.warnings[0])) == (Status.FAILED, True)


@pytest.mark.parametrize("method", NAMES)
def test_scales_of_length_and_time_do_not_matter(method):
    """Compare the same motion in different units. One chain has grains of micrometres and contacts that last
    microseconds. The other chain uses metres and seconds.
    """
    length, time = 1e-6, 1e-7
    large = simulate(one_on(3, hertz(1.0)), [1, 0, 0, 0], 4.0, method, samples=5)
    stiffness = 1.0 / (time**2 * math.sqrt(length))
    small = simulate(one_on(3, hertz(stiffness)), [length / time, 0, 0, 0], 4.0 * time, method, samples=5)
    assert small.velocity * time / length == pytest.approx(large.velocity, abs=1e-8)
    assert small.overlap / length == pytest.approx(large.overlap, abs=1e-8)


def test_parts_of_a_coupler_that_only_together_are_determined():
    """Check a coupler with two draft gears at overlap 0. Only the sum of their forces is determined."""
    link = Coupler(draft_gear(100.0, 0.05), pull=draft_gear(80.0, 0.05))
    found = ended(Chain([1.0, 2.0, 3.0], link, drive=[3.0, 0.0, 0.0]), [0.0, 0.0, 0.0], 2.0)
    assert found.final_velocity == pytest.approx([1.0, 1.0, 1.0], abs=1e-12)
    assert found.force[-1] == pytest.approx([2.5, 1.5], abs=1e-9)


def test_the_solver_survives_overflow_of_a_law():
    """Check a contact law that overflows. The iterations of an implicit step reached an overlap of 293 m, where exp
    overflows. Such a step must be repeated with a shorter length, and the run must continue.
    """
    laws = Laws(one_on(1, OwnLaw(lambda overlap: math.expm1(50.0 * overlap))), 1.0)
    on = np.zeros(1, dtype=int), np.zeros(1, dtype=bool)  # State of the contact: first segment, loading branch.
    assert not np.isfinite(laws.force(np.array([293.0]), *on))
    assert not np.isfinite(laws.slope(np.array([293.0]), *on))
    assert laws.force(np.array([[0.1], [-0.1]]), *on) == pytest.approx(np.array([[math.expm1(5.0)], [0.0]]))


def test_contacts_pressed_at_the_start_are_closed():
    """Check that contacts with an overlap at the start count as closed. Friction holds their beads, so nothing moves."""
    for method in ("scipy", "accurate", "conserving"):
        chain = Chain([1.0, 1.0], hooke(10.0), gap=-0.01, friction=0.5)
        assert simulate(chain, [0.0, 0.0], None, method, samples=2).contact_intervals == (((0.0, math.inf),),), method


def test_a_touching_contact_closes_with_its_neighbour():
    """Check a contact at overlap 0 next to a contact that closes and opens. When the neighbouring contact closes and
    when it opens, the force of the tested contact is 0. An earlier version checked the force only at these times and
    did not detect the closing.
    """
    found = ended(one_on(2, [hooke(1.0), step_force(20.0)]), [1.0, 0.0, 0.0])
    (pushed,), (touching,) = found.contact_intervals
    assert pushed == pytest.approx((0.0, math.pi / math.sqrt(1.5)), abs=1e-9)
    assert touching == pytest.approx(pushed, abs=1e-9)
    # Beads that slide side by side no longer push each other.
    sliding = Chain([1.0, 2.0, 1.0], [hooke(1.0), hertz(1.0)], friction=0.1)
    assert ended(sliding, [1.0, 1.0, 1.0], 0.5).contact_intervals == ((), ())


def test_slow_yielding_is_not_restarted_by_other_contacts():
    """Check two inner contacts that yield slowly at forces of 1e-15 N. In an earlier version, each mode change of one
    contact restarted the motion of the other contact, 9500 times in total.
    """
    chain = Chain([0.6256050420307148, 1.9966455213844647, 1.7485191867510559, 0.5551660365009872, 1.0], hooke(100.0))
    assert simulate(chain, [1.40621878, 0, 0, 0, 0], 0.12, "scipy", samples=2).steps < 100


# Each entry contains masses [kg], stiffness, exponent, gaps [m], friction, velocity of the first bead [m/s], and
# tolerance.
STUCK = [
    ([0.46947684638014126, 0.467007658846719, 1.0077010100542962, 2.4738512390997687], 1.2940312341255225, 1.0,
     [0.0, 0.0246158635633857, 0.0], 0.056163714095268005, 1.9246372161548775, 1e-3),
    ([0.5556933818784061, 0.3421568131414885, 3.0317075013657115, 0.3178966701898147], 84.19839199869811, 3.0,
     [-0.029956371420502115, 0.009795492471958732, 0.0], 0.4257236900244771, 0.6263505979320219, 1e-6),
]  # fmt: skip


@pytest.mark.parametrize(("mass", "stiffness", "exponent", "gap", "friction", "speed", "tolerance"), STUCK)
def test_a_switch_that_repeats_ends_the_run_soon(mass, stiffness, exponent, gap, friction, speed, tolerance) -> None:
    """Check chains on a friction bed in which the same mode change repeats endlessly. In an earlier version the run
    gave up only after half a minute. Round-off made the times between the mode changes longer than the limit.
    """
    chain = Chain(mass, power_law(stiffness, exponent), gap=gap, friction=friction)
    found = simulate_quietly(chain, [speed, 0.0, 0.0, 0.0], 5.0, method="scipy", samples=2, tolerance=tolerance)
    assert found.evaluations < 40_000
    assert found.status == Status.DONE or [one.code for one in found.warnings] == [WarningCode.GAVE_UP]
