"""Errors of radau, dop853 and accurate against their tolerance: ten tolerances at the most, or a warning."""

from dataclasses import replace

import numpy as np
import pytest
from softcradle.physics import Chain, Contact, hertz, hooke, one_on, power_law, step_force

from softcradle import scenes
from tests.helpers.relations import PROMISE, closing_speed, kinetic_energy, run, simulate_quietly
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


DEEP = {5: 1 / 14, 10: 1 / 30, 20: 1 / 50}  # n: exponent


@pytest.mark.parametrize("n", DEEP)
def test_error_in_deep_clusters(n):
    """One on 5 bounces six times at 1e-6 of its speed before it is over: there one part in 1e10 is a bounce."""
    chain, start = one_on(n, power_law(1.0, DEEP[n])), np.eye(1, n + 1)[0]
    exact = run(chain, start, method="radau", tolerance=1e-12).final_velocity
    check_errors(exact, TOLERANCES, chain, start)


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


def test_what_no_tolerance_resolves_says_so():
    """One on 4 at alpha = 1/20 rattles 450 times at the end, and no two tolerances agree to better than 1e-5."""
    with pytest.warns(RuntimeWarning, match=r"final velocities are determined to (.*e-05|0\.000\d) m/s only"):
        found = run(one_on(4, power_law(1.0, 1 / 20)), [1, 0, 0, 0, 0], 2.0, tolerance=1e-8)
    assert len(found.warnings) == 1
    assert kinetic_energy(found.chain, found.final_velocity) == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("method", ["radau", "dop853", "accurate"])
@pytest.mark.parametrize(("n", "ratio"), [(4, 1.005), (4, 1.014), (10, 1.005), (10, 1.014)])
def test_a_gear_that_yields_for_a_moment_is_seen(method, n, ratio, tolerance):
    """Just above the critical speed an inner contact passes its preload by a part in a thousand, between the nodes of a step."""
    chain = one_on(n, GEAR)
    speed = ratio * gear_critical_speed(n)
    start = [speed] + [0.0] * n
    reference = run(chain, start, method="radau", tolerance=1e-12, samples=2)
    found = run(chain, start, method=method, tolerance=tolerance, samples=2)
    assert np.abs(found.final_velocity - reference.final_velocity).max() < 10.0 * tolerance * speed
    assert np.ptp(found.final_velocity[1:]) > 1e-5
    if tolerance < 1e-3:  # which does not tell bounces of a thousandth of the speed apart
        assert len(found.contact_intervals[1]) == len(reference.contact_intervals[1])


@pytest.mark.parametrize("method", ["accurate", "dop853"])
def test_a_spring_that_is_pressed_from_rest(method):
    """By a steady force that begins within long steps: errors of rates alone vanish there, those of overlaps do not."""
    start = [0.65, 0.65, 0.65, 0.5236, 0.5236, -0.179]
    for seed in range(12):
        stiffness = np.random.default_rng(seed).uniform(3.0, 5.0)
        laws = [Contact(1.69, 3.17, 0.287), Contact(0.0194, stiffness, 1.0), step_force(0.272)]
        laws += [Contact(1.95, 0.172, 0.747), step_force(0.54)]
        chain = Chain([1.0] * 6, laws, gap=[0.0, 0.0, 0.3, 0.0, 0.0])
        exact = run(chain, start, method="radau", tolerance=1e-11).final_velocity
        check_errors(exact, FINE, chain, start, method=method)


def test_a_stiff_contact_that_yields_as_its_neighbour_presses():
    """Newton's iteration crept there, along a law that is all but linear, and was taken to have converged."""
    laws = [Contact(1.9, 23.6, 0.956, loss) for loss in (0.2, 0.7, 0.9)]
    chain = Chain([8.4, 0.113, 2.86, 1.12], laws)
    exact = run(chain, [1.0, 1.0, 0.0, 0.0], 0.154, method="scipy", tolerance=1e-10).final_velocity
    for method in ("accurate", "radau", "dop853"):
        check_errors(exact, FINE, chain, [1.0, 1.0, 0.0, 0.0], 0.154, method=method)


@pytest.mark.parametrize("method", ["accurate", "radau"])
def test_a_soft_contact_that_yields_under_a_growing_push(method):
    """Its overlap is small against what its preload moves in a step, and yet its rate is not determined by overlaps alone."""
    start = [1.0, 0.0, 0.0]
    for seed in range(20):
        drawn = np.random.default_rng(seed)
        yielding = Contact(drawn.uniform(0.05, 0.4), drawn.uniform(0.2, 1.0), drawn.uniform(0.7, 0.95))
        chain = Chain([drawn.uniform(0.2, 1.0), drawn.uniform(1.0, 3.0), np.inf], [hooke(10.0), yielding])
        exact = run(chain, start, 0.3, method="dop853", tolerance=1e-12).final_velocity
        check_errors(exact, FINE, chain, start, 0.3, method=method)


def pressed_bead(law, push: float, mass: float) -> tuple[Chain, float]:
    """A bead at rest that a steady force pushes against a wall from zero overlap on, and its period [s] by quadrature.

    Its energy is that of the contact less the work of the force, so at overlap d it is as fast as the difference of the two.
    """
    chain = Chain([mass, np.inf], law, drive=[push, 0.0])
    deepest = (push * (law.exponent + 1.0) / law.stiffness) ** (1.0 / law.exponent)
    # d = deepest * sin(q)**2 takes the square roots at both ends away
    nodes, weights = np.polynomial.legendre.leggauss(200)
    q = 0.25 * np.pi * (nodes + 1.0)
    d = deepest * np.sin(q) ** 2
    speed = np.sqrt(2.0 / mass * (push * d - law.stiffness * d ** (law.exponent + 1.0) / (law.exponent + 1.0)))
    half = 0.25 * np.pi * np.sum(weights * 2.0 * deepest * np.sin(q) * np.cos(q) / speed)
    return chain, 2.0 * half


@pytest.mark.parametrize("seed", range(12))
def test_a_bead_that_comes_back_to_zero_overlap_is_as_exact_as_the_tolerance(seed):
    """Steps across such a turn saw a smooth force: one in ten was off by 12 to 40 tolerances."""
    draw = np.random.default_rng(seed)
    law = hertz(float(10.0 ** draw.uniform(-1, 2)))
    chain, period = pressed_bead(law, float(10.0 ** draw.uniform(-1, 0)), float(10.0 ** draw.uniform(-1, 1)))
    for part in (1.25, 1.5, 2.3):
        wanted = run(chain, [0, 0], part * period, method="radau", tolerance=1e-12).final_velocity[0]
        if part == 1.5:
            assert wanted == pytest.approx(0.0, abs=1e-7)  # the deepest point, known by quadrature
        for tolerance in 10.0 ** np.arange(-5.0, -9.1, -0.5):
            found = run(chain, [0.0, 0.0], part * period, method="dop853", tolerance=tolerance)
            speed = max(np.ptp(found.velocity), 1e-3)
            assert found.final_velocity[0] == pytest.approx(wanted, abs=10.0 * tolerance * max(speed, 1.0))


@pytest.mark.parametrize("method", ["radau", "accurate"])
@pytest.mark.parametrize("seed", range(4))
def test_the_stated_error_of_many_oscillations(method, seed):
    """Errors of a phase add up: they were stated as those of steps that know nothing of each other."""
    draw = np.random.default_rng(seed)
    stiff = [hertz, hooke][seed % 2](float(10.0 ** draw.uniform(3, 4)))
    masses = 10.0 ** draw.uniform(-0.5, 1.0, 3)
    chain = Chain(masses, [stiff, power_law(1e-2, 0.2)])
    velocity = [1.0, 0.9, 0.0]  # the stiff contact rings as long as the soft one pushes
    truth = simulate_quietly(chain, velocity, 20.0, method=method, tolerance=1e-11, samples=2)
    for tolerance in (1e-4, 1e-5, 1e-6):
        found = simulate_quietly(chain, velocity, 20.0, method=method, tolerance=tolerance, samples=2)
        apart = np.abs(found.final_velocity - truth.final_velocity)
        assert (apart <= np.maximum(found.velocity_error, 10.0 * tolerance)).all()
