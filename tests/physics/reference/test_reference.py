"""The reference itself: contact modes, located switches, pushes, and every other method compared with it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from softcradle.physics import Chain, Coupler, OwnLaw, TimedForce, cluster_on_cluster, one_on, simulate
from softcradle.physics.analysis.closed_forms import one_on_one
from softcradle.physics.chain import GRAVITY
from softcradle.physics.contact import Contact, draft_gear, hertz, hooke, power_law
from softcradle.physics.reference.laws import Laws

from tests.helpers.relations import ADAPTIVE, FIXED_STEP, NAMES
from tests.helpers.spaces import LOSS, LOSSY
from tests.helpers.truth import GEARS

SOFT = [power_law(1.0, 0.5), power_law(2.0, 0.3), power_law(1.0, 0.4)]
CHAINS = {
    "Hertz cradle": (one_on(4, hertz(1.0)), [1, 0, 0, 0, 0], None),
    "soft": (Chain([1, 2, 1, 0.5], SOFT), [1, 0, 0, 0], None),
    "gaps": (Chain([1, 1, 2, 1], hertz(3.0), [0.5, 0.1, 0.0]), [2, 0, 0.5, -1], None),
    "Hooke interface": (Chain([1, 1, 1, 1], [hooke(1.0), hertz(4.0), power_law(1.0, 0.8)]), [1, 0, 0, 0], None),
    "three clusters": (Chain([1, 1, 1, 1, 1], hooke(2.0), [0.0, 0.3, 0.3, 0.0]), [1, 1, 0, -1, -1], None),
    "wall behind": (Chain([1, 2, 1, math.inf], hertz(2.0), 0.1), [1, 0, 0, 0], None),
    "between walls": (Chain([math.inf, 1, 2, math.inf], hooke(5.0), 0.2), [0, 1, -0.5, 0], 4.0),
    "one gear": (Chain([1, 2], draft_gear(3.0, 0.1)), [1, 0], None),
}
STEPS_A_SECOND = 4000


def ended(chain, velocity, duration=None):
    """The end of a motion by the reference, as fine as it can be."""
    return simulate(chain, velocity, duration, "scipy", samples=2, tolerance=1e-11)


def test_an_alpha_of_a_thirtieth_is_no_hindrance():
    """Inner overlaps of 1e-29 count as touching, with a multiplier, until the tolerance distinguishes them from 0."""
    chain, start = one_on(10, power_law(1.0, 1 / 30)), [1] + [0] * 10
    found, finer = (simulate(chain, start, method="scipy", tolerance=tolerance) for tolerance in (1e-7, 1e-8))
    assert found.final_velocity == pytest.approx(finer.final_velocity, abs=1e-6)
    assert found.evaluations < 50_000


@pytest.mark.slow
@pytest.mark.parametrize("case", CHAINS)
def test_all_methods_agree_with_it(case):
    """Beside one run of the reference, with samples also where an adaptive method says that contacts switch."""
    chain, velocity, duration = CHAINS[case]
    speed = np.ptp(velocity)
    duration = duration or 1.1 * simulate(chain, velocity, None, "scipy", samples=2).time[-1]
    times = np.linspace(0.0, duration, 33)
    runs = [simulate(chain, velocity, duration, method.name, samples=times, tolerance=1e-7) for method in ADAPTIVE]
    switches = [switches_of(found) for found in runs]
    every = np.unique(np.concatenate((times, *([time for time, _ in those] for those in switches))))
    exact = simulate(chain, velocity, duration, "scipy", samples=every, tolerance=1e-10)
    rows = np.searchsorted(every, times)
    for found, those in zip(runs, switches, strict=True):
        assert np.abs(found.final_velocity - exact.final_velocity).max() < 1e-6 * speed
        # within a second or third collision a sample also has the error of when it began: displacement over closing speed
        assert np.abs(found.velocity - exact.velocity[rows]).max() < 3e-6 * speed
        assert np.abs(found.overlap - exact.overlap[rows]).max() < 1e-5
        assert [len(pairs) for pairs in found.contact_intervals] == [len(pairs) for pairs in exact.contact_intervals]
        # not by time: beads that part slowly, or push each other through others that do, touch at no sharp time
        for time, contact in those:
            overlap = exact.overlap[np.searchsorted(every, time), contact]
            assert abs(overlap) <= 1e-6 * speed * time + 1e-12
    onset = 1.0 if "gear" in case else 1.0 + min(contact.exponent for contact in chain.contact)
    for method in FIXED_STEP:
        found = simulate(chain, velocity, duration, method.name, 1.0 / STEPS_A_SECOND, times)
        bound = 10.0 * STEPS_A_SECOND ** -min(method.order, onset)  # forces and masses are near 1
        assert np.abs(found.velocity - exact.velocity[rows]).max() < bound, method.name
        assert np.abs(found.position - exact.position[rows]).max() < bound, method.name
        assert np.abs(found.final_velocity - exact.final_velocity).max() < bound, method.name


def switches_of(found):
    """(time, contact) of every closing and opening."""
    each = ((time, i) for i, pairs in enumerate(found.contact_intervals) for pair in pairs for time in pair)
    return sorted(switch for switch in each if switch[0] < math.inf)


def test_touching_contacts_carry_a_multiplier():
    """One on three gears below the critical speed: inner overlaps exactly 0, forces those of a rigid cluster."""
    truth = GEARS[0]
    found = simulate(truth.chain, truth.start, method="scipy", samples=truth.time)
    assert (found.overlap[:, 1:] == 0.0).all()
    assert (found.rate[:, 1:] == 0.0).all()
    assert found.force[:, 1:] == pytest.approx(found.force[:, :1] * [2 / 3, 1 / 3], rel=1e-12)
    assert found.contact_intervals[1:] == (found.contact_intervals[0],) * 2  # they push exactly as long as it does


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


@pytest.mark.parametrize("method", NAMES)
def test_scales_of_length_and_time_do_not_matter(method):
    """Grains of micrometres that touch for microseconds move as their image in metres and seconds."""
    length, time = 1e-6, 1e-7
    large = simulate(one_on(3, hertz(1.0)), [1, 0, 0, 0], 4.0, method, samples=5)
    stiffness = 1.0 / (time**2 * math.sqrt(length))
    small = simulate(one_on(3, hertz(stiffness)), [length / time, 0, 0, 0], 4.0 * time, method, samples=5)
    assert small.velocity * time / length == pytest.approx(large.velocity, abs=1e-8)
    assert small.overlap / length == pytest.approx(large.overlap, abs=1e-8)


def test_friction_holds_a_bead_where_it_turns():
    """Pushed against a spring; the next bead stays, for the spring never pushes with more than its friction."""
    chain = Chain([1.0, 1.0], hooke(10.0), drive=[1.2 * 0.2 * GRAVITY, 0.0], friction=0.2)
    # one bead swings about its balance under the spring alone, from rest to rest: it never pushes with 2 * 0.2 mu g
    frequency, force = math.sqrt(10.0), 0.2 * 0.2 * GRAVITY
    middle = ended(chain, [0.0, 0.0], 0.5 * math.pi / frequency)
    assert middle.final_velocity[0] == pytest.approx(force / frequency, abs=1e-12)
    # within 3 s it turns, and friction holds it there
    assert ended(chain, [0.0, 0.0], 3.0).final_velocity.tolist() == [0.0, 0.0]


def test_samples_obey_the_ledger_of_energy():
    """With friction, loss and a brake over time; contacts close and open, and all beads come to rest."""
    chain = Chain(
        [1.0, 2.0, 1.0], [hertz(100.0, 0.3), draft_gear(50.0, 0.01, 0.5)], [0.1, 0.0], friction=0.1,
        brakes=TimedForce(1, [0.0, 0.2, 0.3], [0.0, 2.0, 0.5]),
    )  # fmt: skip
    found = simulate(chain, [1.0, 0.0, 0.0], method="scipy", samples=41)
    assert found.ledger == pytest.approx(np.full(41, found.ledger[0]), rel=1e-9)
    assert not found.velocity[-1].any()
    assert found.absorbed_by_contacts[-1] > 0.0
    assert found.absorbed_by_bed[-1] > 0.0


def test_parts_of_a_coupler_that_only_together_are_determined():
    """Both gears of a coupler touch at the same overlap: the force between the beads is one, whichever part carries it."""
    link = Coupler(draft_gear(100.0, 0.05), pull=draft_gear(80.0, 0.05))
    found = ended(Chain([1.0, 2.0, 3.0], link, drive=[3.0, 0.0, 0.0]), [0.0, 0.0, 0.0], 2.0)
    assert found.final_velocity == pytest.approx([1.0, 1.0, 1.0], abs=1e-12)
    assert found.force[-1] == pytest.approx([2.5, 1.5], abs=1e-9)


def test_a_touch_within_one_step_is_not_passed_over():
    """Steps of a flight are as long as it is; a bead thrown at a ceiling comes down at the speed at which it left."""
    for speed in (3.001, 3.1, 8.0):  # the first would reach a third of a millimetre beyond it
        chain = Chain([1.0, math.inf], hertz(1e6), gap=0.5 * 3.0**2 / 9.8, drive=[-9.8, 0.0])
        assert len(ended(chain, [speed, 0.0], 2.0 * speed / 9.8).contact_intervals[0]) == 1


def test_a_law_of_ones_own_is_what_it_is_as_a_power_law():
    """On a bed, beside loss and a coupler: whatever the reference carries, it carries together."""
    link = Coupler(draft_gear(100.0, 0.05, 0.2), pull=hooke(30.0), slack=0.02)
    ends = [
        ended(Chain([1.0, 2.0, 1.0, 1.5], [law, hertz(50.0, 0.3), link], friction=0.05), [1.0, 0.5, 0.0, 0.0], 0.4)
        for law in (OwnLaw(lambda overlap: 20.0 + 100.0 * overlap), Contact(20.0, 100.0, 1.0))
    ]
    assert ends[0].final_velocity == pytest.approx(ends[1].final_velocity, abs=1e-9)


def test_a_solver_may_try_a_law_of_ones_own_where_that_has_no_number():
    """Iterates of an implicit step went to 293 m, where exp ends: that step is tried again, shorter, and no run ends by it."""
    laws = Laws(one_on(1, OwnLaw(lambda overlap: math.expm1(50.0 * overlap))), 1.0)
    assert not np.isfinite(laws.force(np.array([293.0])))
    assert not np.isfinite(laws.slope(np.array([293.0])))
    assert laws.force(np.array([[0.1], [-0.1]])) == pytest.approx(np.array([[math.expm1(5.0)], [0.0]]))
    with pytest.raises(ValueError, match=r"gives the force nan N at an overlap of 293"):
        OwnLaw(lambda overlap: math.expm1(50.0 * overlap)).force(293.0)


def test_what_is_pressed_at_the_start_is_closed_from_there_on():
    """Also where friction holds it so that nothing moves."""
    for friction, until in ((0.5, math.inf), (0.0, 0.25 * math.pi / math.sqrt(5.0))):
        chain = Chain([1.0, 1.0], hooke(10.0), gap=-0.01, friction=friction)
        for method in ("scipy", "accurate", "conserving"):
            ((found,),) = simulate(chain, [0.0, 0.0], None, method, samples=2).contact_intervals
            assert found == pytest.approx((0.0, until), abs=1e-4), method


def test_a_contact_that_is_pressed_in_slowly_is_not_held_by_the_switches_of_another():
    """Two inner contacts begin to yield at forces of 1e-15 N; each switch began the motion of the other anew, 9500 times."""
    chain = Chain([0.6256050420307148, 1.9966455213844647, 1.7485191867510559, 0.5551660365009872, 1.0], hooke(100.0))
    assert simulate(chain, [1.40621878, 0, 0, 0, 0], 0.12, "scipy", samples=2).steps < 100


@pytest.mark.parametrize("law", LOSSY)
@pytest.mark.parametrize(("method", "allowed"), [("scipy", 1e-11), ("accurate", 1e-9)])
def test_loss_takes_its_part_of_the_energy(method, allowed, law):
    """Restitution sqrt(1 - loss), whatever the law and the masses; a contact opens as much slower as it closes."""
    restitution = math.sqrt(1.0 - LOSS)
    found = simulate(Chain([1.0, 2.0], LOSSY[law]), [1.0, 0.0], method=method, samples=2, tolerance=1e-11)
    assert found.final_velocity == pytest.approx([1 / 3 - restitution * 2 / 3, (1 + restitution) / 3], abs=allowed)
    ((closed, opened),) = found.contact_intervals[0]
    if law != "preload and root":  # which has no closed form
        time = one_on_one(replace(LOSSY[law], loss=0.0), 2 / 3, 1.0).contact_time
        assert opened - closed == pytest.approx(0.5 * time * (1.0 + 1.0 / restitution), rel=1e-6)
