"""Errors of radau, dop853 and accurate against their tolerance: ten tolerances at the most, or a warning."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import beta
from softcradle.physics import Chain, Contact, hertz, hooke, one_on, power_law, step_force

from softcradle import scenes
from tests.helpers.relations import KERNELS, PROMISE, closing_speed, run, simulate_quietly, struck
from tests.helpers.truth import ELASTIC, GEAR, GEARS, gear_critical_speed

TOLERANCES = tuple(10.0 ** (-0.25 * k) for k in range(12, 41))  # quarter decades, 1e-3 to 1e-10
FINE = (1e-6, 1e-7, 1e-8, 1e-9)
RATTLING = TOLERANCES[:21:2]  # half decades to 1e-8, for motions whose runs are many and long
FINE_RUNS = 8  # of a motion, to see how far it is determined
SHAKEN = 1e-14  # relative change of forces between fine runs: a few units of the last place, as between two processors
SPREADS = 3.0  # spreads of the fine runs by which another run may lie away from their mean
CASES = ELASTIC + GEARS


def lanes():
    """Every lane of every scene that ends by itself, once."""
    found = {}
    for name in scenes.names():
        for k, lane in enumerate(scenes.load(name).lanes):
            chain, velocity = lane.chain(), tuple(lane.velocity)
            if chain.walls < 2 and chain.drive is None and not chain.dissipative:
                found.setdefault((chain, velocity), f"{name}-{k}")
    marks = {"mixed-0": pytest.mark.slow}
    return [pytest.param(*motion, id=name, marks=marks.get(name, ())) for motion, name in found.items()]


def check_errors(exact, tolerances, *arguments, speed=1.0, **options):
    """The error at each tolerance: ten of them at the most, of that speed."""
    for tolerance in tolerances:
        found = run(*arguments, tolerance=tolerance, **options)
        assert np.abs(found.final_velocity - exact).max() < PROMISE * tolerance * speed, tolerance


@pytest.mark.parametrize("truth", CASES, ids=lambda truth: truth.name)
@pytest.mark.parametrize("method", ["radau", "accurate"])
def test_error_stays_below_ten_tolerances(method, truth):
    check_errors(truth.final, TOLERANCES, truth.chain, truth.start, method=method, speed=closing_speed(truth.start))


@pytest.mark.parametrize(("n", "softness"), [(5, 14), (10, 30), (20, 50)])
def test_error_in_deep_clusters(n, softness):
    """One on 5 bounces six times at 1e-6 of its speed before it is over: there one part in 1e10 is a bounce."""
    chain = one_on(n, power_law(1.0, 1.0 / softness))
    exact = run(chain, struck(chain), method="radau", tolerance=1e-12).final_velocity
    check_errors(exact, TOLERANCES, chain, struck(chain))


@pytest.mark.parametrize(("chain", "velocity"), lanes())
def test_error_in_every_scene(chain, velocity):
    """Ten tolerances, as far as the motion is determined: the last two beads of `mixed` rattle, and end within 2e-6 m/s.

    Where a contact bounces often, errors of single steps are passed on and grow: finer runs confirm these. A warning is
    in place only where fine runs differ by more than the tolerance.
    """
    ends, bounces = fine_ends(chain, velocity)
    exact, undetermined = ends.mean(axis=0), SPREADS * np.ptp(ends, axis=0)
    for tolerance in RATTLING if bounces > 2 else TOLERANCES:
        found = simulate_quietly(chain, velocity, tolerance=tolerance, samples=2)
        error, allowed = np.abs(found.final_velocity - exact), tolerance * closing_speed(velocity)
        assert (error < PROMISE * allowed + undetermined).all()
        assert not found.warnings or undetermined.max() > allowed


def fine_ends(chain, velocity):
    """Final velocities (FINE_RUNS, n+1) of fine runs whose forces differ by round-off, and the most closings of a contact."""
    shaken = np.random.default_rng(0)
    runs = []
    for _ in range(FINE_RUNS):
        factors = 1.0 + SHAKEN * shaken.uniform(-1.0, 1.0, chain.contacts)
        contacts = [
            replace(contact, preload=contact.preload * factor, stiffness=contact.stiffness * factor)
            for contact, factor in zip(chain.contact, factors, strict=True)
        ]
        other = replace(chain, contact=contacts)
        runs.append(simulate_quietly(other, velocity, method="radau", samples=2, tolerance=1e-10))
    closings = max(len(intervals) for run in runs for intervals in run.contact_intervals)
    return np.array([run.final_velocity for run in runs]), closings


def test_error_under_a_steady_push():
    """The pushed cluster comes back to nearly no overlap: a change d of it there is one of sqrt(d) in velocity.

    Its end is from `reference_end` of the scan, in extended precision, at 1e-13: known to 4e-13 m/s. Finer runs differ by 1e-9.
    """
    scene = scenes.load("driven-cluster")
    chain, velocity = scene.lanes[0].chain(), scene.lanes[0].velocity
    exact = [3.2812531034648, 3.3059875881534, 3.3063794628714, 3.3063798455104]
    for tolerance in (*RATTLING, 1e-10):
        found = simulate_quietly(chain, velocity, scene.duration, tolerance=tolerance, samples=2)
        assert not found.warnings or tolerance == 1e-10
        assert np.abs(found.final_velocity - exact).max() < PROMISE * tolerance


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("method", KERNELS)
@pytest.mark.parametrize(("n", "ratio"), [(4, 1.005), (4, 1.014), (10, 1.005), (10, 1.014)])
def test_a_gear_that_yields_for_a_moment_is_seen(method, n, ratio, tolerance):
    """Just above the critical speed an inner contact passes its preload by a part in a thousand, between the nodes of a step."""
    chain = one_on(n, GEAR)
    speed = ratio * gear_critical_speed(n)
    reference = run(chain, speed * struck(chain), method="radau", tolerance=1e-12)
    found = run(chain, speed * struck(chain), method=method, tolerance=tolerance)
    assert np.abs(found.final_velocity - reference.final_velocity).max() < PROMISE * tolerance * speed
    assert np.ptp(found.final_velocity[1:]) > 1e-5
    if tolerance < 1e-3:  # which does not tell bounces of a thousandth of the speed apart
        assert len(found.contact_intervals[1]) == len(reference.contact_intervals[1])


def spring_from_rest(seed):
    """Pressed by a steady force that begins within long steps: errors of rates alone vanish there, those of overlaps do not."""
    stiffness = np.random.default_rng(seed).uniform(3.0, 5.0)
    laws = [Contact(1.69, 3.17, 0.287), Contact(0.0194, stiffness, 1.0), step_force(0.272)]
    laws += [Contact(1.95, 0.172, 0.747), step_force(0.54)]
    return Chain([1.0] * 6, laws, gap=[0.0, 0.0, 0.3, 0.0, 0.0]), [0.65, 0.65, 0.65, 0.5236, 0.5236, -0.179]


def stiff_beside_pressed(_):
    """Newton's iteration crept there, along a law that is all but linear, and was taken to have converged."""
    laws = [Contact(1.9, 23.6, 0.956, loss) for loss in (0.2, 0.7, 0.9)]
    return Chain([8.4, 0.113, 2.86, 1.12], laws), [1.0, 1.0, 0.0, 0.0], 0.154


def soft_under_a_growing_push(seed):
    """The overlap is small against what the preload moves in a step, and yet its rate is not determined by overlaps alone."""
    drawn = np.random.default_rng(seed)
    yielding = Contact(drawn.uniform(0.05, 0.4), drawn.uniform(0.2, 1.0), drawn.uniform(0.7, 0.95))
    chain = Chain([drawn.uniform(0.2, 1.0), drawn.uniform(1.0, 3.0), np.inf], [hooke(10.0), yielding])
    return chain, [1.0, 0.0, 0.0], 0.3


@pytest.mark.parametrize(
    ("motion", "seeds", "truth", "methods"),
    [
        (spring_from_rest, 12, ("radau", 1e-11), ("accurate", "dop853")),
        (stiff_beside_pressed, 1, ("scipy", 1e-10), KERNELS),
        (soft_under_a_growing_push, 20, ("dop853", 1e-12), ("accurate", "radau")),
    ],
)
def test_a_contact_that_yields_within_long_steps(motion, seeds, truth, methods):
    for seed in range(seeds):
        given = motion(seed)
        exact = run(*given, method=truth[0], tolerance=truth[1]).final_velocity
        for method in methods:
            check_errors(exact, FINE, *given, method=method)


@pytest.mark.parametrize("seed", range(12))
def test_a_bead_that_comes_back_to_zero_overlap_is_as_exact_as_the_tolerance(seed):
    """A steady force pushes it against a wall, from zero overlap on; steps across such a turn saw a smooth force."""
    draw = np.random.default_rng(seed)
    law, push, mass = hertz(10.0 ** draw.uniform(-1, 2)), 10.0 ** draw.uniform(-1, 0), 10.0 ** draw.uniform(-1, 1)
    chain = Chain([mass, np.inf], law, drive=[push, 0.0])
    deepest = (2.5 * push / law.stiffness) ** (2.0 / 3.0)
    period = np.sqrt(2.0 * mass * deepest / push) * beta(1.0 / 3.0, 0.5) / 1.5  # in closed form, by energy
    for part in (1.25, 1.5, 2.3):
        wanted = run(chain, [0, 0], part * period, method="radau", tolerance=1e-12).final_velocity[0]
        if part == 1.5:
            assert wanted == pytest.approx(0.0, abs=1e-7)  # the deepest point
        for tolerance in 10.0 ** np.arange(-5.0, -9.1, -0.5):
            found = run(chain, [0.0, 0.0], part * period, method="dop853", tolerance=tolerance)
            speed = max(np.ptp(found.velocity), 1.0)
            assert found.final_velocity[0] == pytest.approx(wanted, abs=10.0 * tolerance * speed)


@pytest.mark.parametrize("method", ["radau", "accurate"])
@pytest.mark.parametrize("seed", range(4))
def test_the_stated_error_of_many_oscillations(method, seed):
    """Errors of a phase add up: they were stated as those of steps that know nothing of each other."""
    draw = np.random.default_rng(seed)
    stiff = [hertz, hooke][seed % 2](10.0 ** draw.uniform(3, 4))
    chain = Chain(10.0 ** draw.uniform(-0.5, 1.0, 3), [stiff, power_law(1e-2, 0.2)])
    velocity = [1.0, 0.9, 0.0]  # the stiff contact rings as long as the soft one pushes
    truth = simulate_quietly(chain, velocity, 20.0, method=method, tolerance=1e-11, samples=2)
    for tolerance in (1e-4, 1e-5, 1e-6):
        found = simulate_quietly(chain, velocity, 20.0, method=method, tolerance=tolerance, samples=2)
        apart = np.abs(found.final_velocity - truth.final_velocity)
        assert (apart <= np.maximum(found.velocity_error, 10.0 * tolerance)).all()
