"""Samples from the steps of one run: those that a run with a known end takes, however the steps are kept."""

import numpy as np
import pytest
from softcradle.physics import Chain, TimedForce, Trajectory, draft_gear, hertz, one_on, power_law
from softcradle.physics.adaptive import kept_steps, runner

from tests.helpers.relations import simulate_quietly, struck

KERNELS = runner.TIERS["adaptive"]

CHAINS = {
    "power law": one_on(4, power_law(1.0, 0.1)),
    "gears": one_on(10, draft_gear(1.0, 0.1)),
    "hertz": one_on(20, hertz(1.0)),
    "loss": one_on(4, power_law(1.0, 0.1, loss=0.2)),
    "friction": Chain([1.0] * 5, power_law(1.0, 0.1), friction=0.05, gap=[0.0, 0.02, 0.0, 0.1]),
    "gaps": Chain([1.0] * 4, draft_gear(100.0, 0.05), gap=[0.0, 0.02, 0.0]),
    "forces": Chain([1.0] * 4, power_law(1.0, 0.1), forces=TimedForce(0, [0.0, 0.6, 0.7], [0.3, 0.3, 0.0])),
}
ROWS = ("time", "overlap", "rate", "force", "anchor", "absorbed_by_contacts", "absorbed_by_bed")


def same_rows(one: Trajectory, other: Trajectory) -> bool:
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in ROWS)


@pytest.mark.parametrize("name", CHAINS)
def test_a_run_to_its_end_has_the_samples_of_one_with_this_duration(name):
    chain = CHAINS[name]
    found = simulate_quietly(chain, struck(chain), samples=37)
    known = simulate_quietly(chain, struck(chain), found.time[-1], samples=37)
    for row in ("overlap", "rate", "anchor", "given"):
        assert getattr(found, row) == pytest.approx(getattr(known, row), abs=1e-8)
    inner = slice(0, -1)  # at the end itself the last contact has just opened, or is about to
    assert found.force[inner] == pytest.approx(known.force[inner], rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("name", CHAINS)
def test_samples_cost_no_second_run(name, monkeypatch):
    runs = []
    KERNELS.load_made()  # each kernel is called once as it is loaded
    monkeypatch.setattr(runner, "integrate", _counted(runner.integrate, runs))
    monkeypatch.setattr(KERNELS, "of", lambda kernel, work=0.0: kernel)
    chain = CHAINS[name]
    simulate_quietly(chain, struck(chain), samples=2, tolerance=1e-4)
    before = len(runs)
    simulate_quietly(chain, struck(chain), samples=50, tolerance=1e-4)
    begun = [not resumed for resumed in runs[before:]]
    assert sum(begun) == sum(not resumed for resumed in runs[:before])


def _counted(kernel, runs):
    def counted(allowed, resumed, *rest):
        runs.append(resumed)
        return kernel(allowed, resumed, *rest)

    return counted


@pytest.mark.parametrize("name", CHAINS)
def test_samples_do_not_tell_in_how_many_blocks_the_steps_were_kept(name, monkeypatch):
    chain = CHAINS[name]
    whole = simulate_quietly(chain, struck(chain), samples=23)
    monkeypatch.setattr(kept_steps, "MOST_ROWS", 3)
    monkeypatch.setattr(kept_steps, "_spare", kept_steps._Spare())
    assert same_rows(simulate_quietly(chain, struck(chain), samples=23), whole)


def test_a_run_of_more_steps_than_are_kept_is_run_again(monkeypatch):
    chain = CHAINS["power law"]
    whole = simulate_quietly(chain, struck(chain), samples=23)
    monkeypatch.setattr(kept_steps, "MOST_KEPT", 1)
    again = simulate_quietly(chain, struck(chain), samples=23)
    assert again.rate == pytest.approx(whole.rate, abs=1e-8)
    assert again.overlap == pytest.approx(whole.overlap, abs=1e-8)


def test_samples_after_the_end_are_free_flight():
    chain = CHAINS["power law"]
    end = simulate_quietly(chain, struck(chain), samples=2).time[-1]
    found = simulate_quietly(chain, struck(chain), samples=[0.0, 0.5, end + 1.0, end + 2.0])
    assert found.velocity[2] == pytest.approx(found.final_velocity, abs=1e-8)
    assert found.position[3] - found.position[2] == pytest.approx(found.final_velocity, abs=1e-8)
