"""Samples of a run to its end are taken from what it kept: the same motion as with a known duration, and no second run."""

from unittest.mock import Mock

import numpy as np
import pytest
from softcradle.physics import Chain, TimedForce, draft_gear, hertz, hooke, one_on, power_law
from softcradle.physics.adaptive import kept_steps, runner
from softcradle.physics.fixed_step import runner as fixed_step
from softcradle.physics.fixed_step import step_loop
from softcradle.physics.own_law import OwnLaw
from softcradle.physics.pymunk_contacts import runner as pymunk_contacts

from tests.helpers.relations import simulate_quietly, struck

PLAIN = {
    "power law": one_on(4, power_law(1.0, 0.1)),
    "gears with gaps": Chain([1.0] * 4, draft_gear(100.0, 0.05), gap=[0.0, 0.02, 0.0]),
    "flights": Chain([1.0] * 3, hooke(1e3), gap=[7.0, 0.3]),
    "own law": Chain([1.0] * 3, OwnLaw(lambda overlap: overlap + overlap**3)),
    "over at once": Chain([1.0, 1.0, 1.0], hooke(1.0), gap=0.1),
}
DISSIPATIVE = {
    "loss": one_on(4, power_law(1.0, 0.1, loss=0.2)),
    "friction": Chain([1.0] * 5, power_law(1.0, 0.1), friction=0.05, gap=[0.0, 0.02, 0.0, 0.1]),
    "forces": Chain([1.0] * 4, power_law(1.0, 0.1), forces=TimedForce(0, [0.0, 0.6, 0.7], [0.3, 0.3, 0.0])),
}
METHODS = ("euler", "verlet", "yoshida4", "conserving", "pymunk")
ROUND_OFF = 1e-12, 1e-9  # a Space goes on from positions rounded anew, and bounces make that grow
NOT_CARRIED = {("own law", "pymunk")}
ADAPTIVE = {  # whose samples are taken from the steps that a run has kept
    "gears in a row": one_on(10, draft_gear(1.0, 0.1)),
    "hertz": one_on(20, hertz(1.0)),
    **{name: PLAIN[name] for name in ("power law", "gears with gaps")},
    **DISSIPATIVE,
}
CASES = [
    *((name, method) for name in PLAIN for method in METHODS if (name, method) not in NOT_CARRIED),
    *((name, method) for name in DISSIPATIVE for method in ("verlet", "conserving", "pymunk")),
]


def named(name: str) -> tuple[Chain, np.ndarray]:
    chain = {**PLAIN, **DISSIPATIVE}[name]
    return chain, (-1.0 if name == "over at once" else 1.0) * struck(chain)


@pytest.mark.parametrize("rows", [None, 6], ids=["", "thinned many times"])
@pytest.mark.parametrize(("name", "method"), CASES)
def test_a_run_to_its_end_has_the_samples_of_one_with_this_duration(name, method, rows, monkeypatch):
    if rows:
        monkeypatch.setattr(step_loop, "MOST_ROWS", rows)
        monkeypatch.setattr("softcradle.physics.problem.MOST_CHECKPOINTS", rows)
    chain, velocity = named(name)
    found = simulate_quietly(chain, velocity, method=method, samples=37)
    known = simulate_quietly(chain, velocity, found.time[-1], method=method, samples=37)
    assert found.time == pytest.approx(known.time, rel=1e-15, abs=0.0)
    for row in ("overlap", "velocity", "absorbed_by_contacts", "absorbed_by_bed", "given"):
        scale = 1.0 + np.abs(getattr(known, row)).max()
        assert getattr(found, row) == pytest.approx(getattr(known, row), abs=ROUND_OFF[method == "pymunk"] * scale)


@pytest.mark.parametrize("name", [pytest.param("friction", marks=pytest.mark.slow), "forces"])
def test_the_reference_takes_its_samples_from_its_solution(name):
    chain, velocity = named(name)
    found = simulate_quietly(chain, velocity, method="scipy", samples=9, tolerance=1e-8)
    known = simulate_quietly(chain, velocity, found.time[-1], method="scipy", samples=9, tolerance=1e-8)
    assert found.overlap == pytest.approx(known.overlap, abs=3e-8)
    assert found.velocity == pytest.approx(known.velocity, abs=3e-8)
    assert found.given == pytest.approx(known.given, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    ("module", "method", "name"),
    [(fixed_step, "conserving", "power law"), (fixed_step, "verlet", "loss"), (pymunk_contacts, "pymunk", "power law")],
)
def test_samples_cost_no_second_run(module, method, name, monkeypatch):
    chain, velocity = named(name)
    simulate_quietly(chain, velocity, method=method, samples=50)  # the first of a process loads kernels too
    counted = Mock(wraps=module._pass)
    monkeypatch.setattr(module, "_pass", counted)
    assert len(simulate_quietly(chain, velocity, method=method, samples=50).time) == 50
    assert [call.args[1] for call in counted.call_args_list] == [np.inf]


@pytest.mark.parametrize("chain", ADAPTIVE.values(), ids=ADAPTIVE)
def test_adaptive_methods_take_samples_from_their_steps(chain):
    found = simulate_quietly(chain, struck(chain), samples=37)
    known = simulate_quietly(chain, struck(chain), found.time[-1], samples=37)
    for row in ("overlap", "rate", "anchor", "given"):
        assert getattr(found, row) == pytest.approx(getattr(known, row), abs=1e-8)
    inner = slice(0, -1)  # at the end itself the last contact has just opened, or is about to
    assert found.force[inner] == pytest.approx(known.force[inner], rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("chain", ADAPTIVE.values(), ids=ADAPTIVE)
def test_samples_cost_no_second_run_of_an_adaptive_method(chain, monkeypatch):
    kernels, counted, begun = runner.TIERS["adaptive"], Mock(wraps=runner.integrate), []
    kernels.load_made()  # each kernel is called once as it is loaded
    monkeypatch.setattr(runner, "integrate", counted)
    monkeypatch.setattr(kernels, "of", lambda kernel, work=0.0: kernel)
    for samples in (2, 50):
        counted.reset_mock()
        simulate_quietly(chain, struck(chain), samples=samples, tolerance=1e-4)
        begun.append(sum(not resumed for _, (resumed, *_), *_ in [call.args for call in counted.call_args_list]))
    assert begun[0] == begun[1] > 0


@pytest.mark.parametrize("chain", ADAPTIVE.values(), ids=ADAPTIVE)
def test_samples_do_not_tell_in_how_many_blocks_the_steps_were_kept(chain, monkeypatch):
    whole = simulate_quietly(chain, struck(chain), samples=23)
    monkeypatch.setattr(kept_steps, "MOST_ROWS", 3)
    monkeypatch.setattr(kept_steps, "_spare", kept_steps._Spare())
    found = simulate_quietly(chain, struck(chain), samples=23)
    for row in ("time", "overlap", "rate", "force", "anchor", "absorbed_by_contacts", "absorbed_by_bed"):
        np.testing.assert_array_equal(getattr(found, row), getattr(whole, row))


def test_a_run_of_more_steps_than_are_kept_is_run_again(monkeypatch):
    chain = PLAIN["power law"]
    whole = simulate_quietly(chain, struck(chain), samples=23)
    monkeypatch.setattr(kept_steps, "MOST_KEPT", 1)
    again = simulate_quietly(chain, struck(chain), samples=23)
    assert again.rate == pytest.approx(whole.rate, abs=1e-8)
    assert again.overlap == pytest.approx(whole.overlap, abs=1e-8)
