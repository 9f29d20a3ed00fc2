"""Tests of user-defined contact laws. Such laws must give the same motions as built-in power laws. Energy and momentum
must be conserved, and the results must agree with the reference.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from softcradle.physics import Contact, kernel_records
from softcradle.physics.contact import hertz, hooke, power_law, step_force
from softcradle.physics.fixed_step.step_loop import log_switches
from softcradle.physics.numerics.plain_kernels import plain
from softcradle.physics.numerics.records import Motion
from softcradle.physics.numerics.table_kernels import table_inverse, table_slope, table_value
from softcradle.physics.simulation import solve
from softcradle.sandbox.notebook.views import html_of

from softcradle import Chain, OwnLaw, State, Trajectory, one_on, stable_step

START = [1.0, 0.0, 0.0, 0.0, 0.0]


def power(f0: float, alpha: float) -> Callable[[float], float]:
    """Return a power law as a Python function, as a user would write it."""
    return lambda overlap: f0 * overlap**alpha


@dataclass(frozen=True)
class Toda:
    """An exponential repulsive contact law with a method for its energy."""

    stiffness: float

    def force(self, overlap: float) -> float:
        return self.stiffness * math.expm1(overlap)

    def energy(self, overlap: float) -> float:
        return self.stiffness * (math.expm1(overlap) - overlap)


def two_slopes(overlap: float) -> float:
    return 3.0 * overlap if overlap < 0.1 else 0.3 + 20.0 * (overlap - 0.1)


def gear(overlap: float) -> float:
    return 2.0 + 3.0 * overlap + 5.0 * overlap**3


SUBNORMAL = 112443850.21149778, 1.16693629679573
PAIRS = {
    "soft": (power(1.0, 0.1), power_law(1.0, 0.1)),
    "softer": (power(2.0, 1 / 30), power_law(2.0, 1 / 30)),
    "linear": (power(3.0, 1.0), hooke(3.0)),
    "hertz": (power(2.0, 1.5), hertz(2.0)),
    "gear": (lambda overlap: 2.0 + 3.0 * overlap, Contact(2.0, 3.0, 1.0)),
    "step": (lambda overlap: 2.0, step_force(2.0)),
    "soft gear": (lambda overlap: 0.3 + 2.0 * overlap**0.3, Contact(0.3, 2.0, 0.3)),
    "softest gear": (lambda overlap: 0.01 + 3.0 * overlap ** (1 / 30), Contact(0.01, 3.0, 1 / 30)),
    "subnormal at first": (power(*SUBNORMAL), power_law(*SUBNORMAL)),
}


@pytest.mark.parametrize("method", ["euler", "verlet", "yoshida4", "conserving"])
@pytest.mark.parametrize(("own", "built_in"), [PAIRS["hertz"], PAIRS["soft"]], ids=["hertz", "soft"])
def test_a_power_law_of_ones_own_moves_as_the_built_in_does(method, own, built_in):
    # In these motions, round-off grows by a factor of a thousand per bounce.
    chatters = built_in.exponent < 1.0 and method != "conserving"
    settings = {"duration": 0.3 if chatters else 2.5, "method": method, "step": 0.01, "samples": 51}
    found, wanted = (solve(Chain([1.0] * 5, law), START, **settings) for law in (own, built_in))
    assert found.steps == wanted.steps
    for name in ("final_velocity", "overlap", "contact_energy"):
        assert getattr(found, name) == pytest.approx(getattr(wanted, name), abs=1e-12)
    assert stable_step(found.chain, START) == pytest.approx(stable_step(wanted.chain, START), rel=0.3)


@pytest.mark.parametrize("method", ["radau", "accurate"])
@pytest.mark.parametrize(("own", "built_in"), PAIRS.values(), ids=PAIRS)
def test_adaptive_methods_take_a_power_law_of_ones_own_as_the_built_in(own, built_in, method):
    """Compare a user-defined power law with the built-in one. The results must agree within the guaranteed error, with
    no more steps. The table of the user-defined law equals the power law, including its beginning.
    """
    found, wanted = (solve(Chain([1.0, 1.0, 2.0, 1.0], law), START[:4], method=method) for law in (own, built_in))
    assert found.final_velocity == pytest.approx(wanted.final_velocity, abs=3e-8)
    assert found.steps < 1.4 * wanted.steps + 20
    assert found.warnings == ()


OWN_SHAPES = {
    "exponential": Toda(3.0),
    "steep": Toda(0.01),
    "saturating": lambda overlap: math.tanh(100.0 * overlap),
    "logarithm": lambda overlap: math.log1p(100.0 * overlap),
    "a dead zone": lambda overlap: max(0.0, 5.0 * (overlap - 0.01)),
    "two slopes": two_slopes,
    "three slopes": lambda overlap: min(overlap, 0.02) + 40.0 * max(overlap - 0.1, 0.0),
    "soft and stiff": lambda overlap: overlap**0.3 + 50.0 * overlap**3,
    "cubic with a preload": gear,
    "no formula of numbers": OwnLaw(lambda d: {"grows": math.expm1(d)}["grows"], Toda(1.0).energy),
}


@cache
def by_method(law, method):
    return solve(Chain([1.0, 2.0, 1.0, 1.5], law), START[:4], method=method)


@pytest.mark.parametrize("method", ["radau", "dop853", "accurate", "auto"])
@pytest.mark.parametrize("law", OWN_SHAPES.values(), ids=OWN_SHAPES)
def test_adaptive_methods_against_the_reference(law, method):
    found, truth = by_method(law, method), by_method(law, "scipy")
    assert method in ("auto", found.method)
    assert found.final_velocity == pytest.approx(truth.final_velocity, abs=1e-7)
    assert (np.abs(found.final_velocity - truth.final_velocity) <= 0.5 * found.velocity_error).all()
    assert found.velocity_error.max() < 1e-6


@pytest.mark.parametrize("law", OWN_SHAPES.values(), ids=OWN_SHAPES)
@pytest.mark.parametrize("step", [3e-2, 0.3])
def test_energy_and_momentum_are_conserved_at_any_step(law, step):
    # The step is too long for the contact, so the run warns. The energy must still be conserved.
    found = solve(one_on(4, law), START, duration=4.0, method="conserving", step=step, samples=41)
    assert np.ptp(found.ledger) < 1e-12 * found.ledger[0]
    assert np.ptp(found.momentum) < 1e-13
    assert not any("converge" in warning.sentence for warning in found.warnings)


def test_a_chain_has_the_law_as_it_is_when_it_is_made():
    """Check that a new chain evaluates the contact law again instead of using a cached table. In a notebook, the user
    can change a variable that the function uses.
    """
    stiffness = 1.0

    def spring(overlap):
        return stiffness * overlap

    for stiffness in (1.0, 4.0):
        for method in ("accurate", "conserving", "scipy"):
            found = solve(Chain([1.0, 1.0], spring), [1.0, 0.0], method=method)
            assert found.time[-1] == pytest.approx(math.pi / math.sqrt(2.0 * stiffness), rel=2e-3), method
            assert np.ptp(found.ledger) < 1e-6


LAWS = {
    "hertz": (lambda d: d**1.5, lambda d: d**2.5 / 2.5),
    "soft": (lambda d: d**0.05, lambda d: d**1.05 / 1.05),
    "a bend": (two_slopes, lambda d: 1.5 * min(d, 0.1) ** 2 + (d > 0.1) * (0.3 * (d - 0.1) + 10.0 * (d - 0.1) ** 2)),
    "singular at 1": (lambda d: -math.log1p(-d), lambda d: (1.0 - d) * math.log1p(-d) + d),
    "gear": (gear, lambda d: 2.0 * d + 1.5 * d * d + 1.25 * d**4),
}


@pytest.mark.parametrize(("force", "energy"), LAWS.values(), ids=LAWS)
def test_the_table_of_a_law_is_the_law_at_random_overlaps_of_all_sizes(force, energy):
    """Check the table of a contact law at overlaps of all sizes. If a law does not define its energy, the energy is the
    integral of the force. Slope and inverse functions come from the table.
    """
    law, draw = OwnLaw(force), np.random.default_rng(1)
    table, overlaps = law.table, 10.0 ** draw.uniform(-9.0, -1e-3, 2000)
    errors = np.abs(table.values(table.force, overlaps) - [force(d) for d in overlaps.tolist()])
    assert (errors <= 1e-13 * table.values(table.force, np.minimum(1.5 * overlaps, 0.999))).all()
    large = overlaps[overlaps > 1e-2]  # Below this overlap the closed forms lose digits.
    assert law.energy(large) == pytest.approx([energy(d) for d in large.tolist()], rel=2e-12)
    few = [1e-3, 0.05, 0.1, 0.11, 0.3, 0.99]
    assert law.energy(few) == pytest.approx([energy(d) for d in few], rel=2e-14)
    assert (np.diff(table.edge) > 0.0).all()
    chain = Chain([1.0, 1.0], law)
    graph = kernel_records.graphs_of(chain, State.at_start(chain, [0.0, 0.0]))
    for overlap in overlaps[overlaps > 1e-8][:50]:
        for rows in (graph.force, graph.energy):
            assert table_inverse(graph, rows, 0, plain(table_value)(graph, rows, 0, overlap)) == pytest.approx(
                overlap, rel=1e-9
            )
        digits = 1e-10 * force(overlap) / overlap  # Round-off of a difference of two forces, as a slope.
        assert table_slope(graph, 0, overlap) == pytest.approx(law.slope(overlap), rel=1e-5, abs=digits)
    assert table_inverse(graph, graph.force, 0, 1e300) == math.inf


def test_a_law_without_digits_is_taken_as_it_is():
    """Check the force sqrt(1 + d) - 1, which is only round-off for d below 1e-16. The table must not add points to
    resolve this round-off.
    """
    table = OwnLaw(lambda d: math.sqrt(1.0 + d) - 1.0).table
    assert len(table.force) < 5000
    assert table.values(table.force, np.array([0.5])) == pytest.approx(math.sqrt(1.5) - 1.0, rel=1e-14)


def test_laws_for_numbers_and_for_arrays_are_accepted():
    for law in (lambda d: d**2, lambda d: math.pow(d, 2), lambda d: 0.0 if d < 0.0 else d**2):
        assert OwnLaw(law).force([[-1.0, 0.0], [0.5, 2.0]]).tolist() == [[0.0, 0.0], [0.25, 4.0]]
    assert OwnLaw(lambda d: 3.0).force([1.0, 2.0]).tolist() == [3.0, 3.0]
    assert OwnLaw(power(2.0, 1.5)).overlap([2.0, 16.0]) == pytest.approx([1.0, 4.0])
    assert OwnLaw(math.tanh).overlap(2.0) == math.inf
    assert OwnLaw(math.asin).overlap(2.0) == 1.0  # The contact law is not defined above this overlap.


def test_a_file_holds_the_table_of_a_law(tmp_path):
    chain = Chain([1.0] * 4, [Toda(3.0), hertz(2.0), Toda(3.0)], drive=[0.1, 0, 0, 0])
    found = solve(chain, START[:4], 2.0)
    found.save(tmp_path / "toda.npz")
    again = Trajectory.load(tmp_path / "toda.npz")
    assert repr(again.chain) == repr(chain)
    assert again.overlap.tolist() == found.overlap.tolist()
    assert again.contact_energy == pytest.approx(found.contact_energy, abs=1e-12)
    assert solve(again.chain, START[:4], 2.0).final_velocity.tolist() == found.final_velocity.tolist()
    again.save(tmp_path / "again.npz")


def test_errors_of_a_law_are_raised():
    def with_a_limit(overlap: float) -> float:
        if overlap > 1.5:
            raise KeyError("pressed too far")
        return overlap

    with pytest.raises(KeyError, match="pressed too far"):
        solve(Chain([1.0, 1.0], with_a_limit), [9.0, 0.0], method="verlet")


def test_a_force_that_falls_is_told():
    for speed, falls in ((0.5, False), (1.2, True)):
        found = solve(Chain([1.0, 1.0], lambda d: d * math.exp(-(d**2))), [speed, 0.0], method="verlet")
        assert any("falls from an overlap of" in warning.sentence for warning in found.warnings) is falls


@pytest.mark.parametrize("at", [0.3, 0.5, 1.0, 2.0])
def test_the_overlap_from_which_a_force_falls_is_located(at):
    """Check the overlap in the warning about a decreasing force. In an earlier version, the warning contained the last
    tested overlap before the decrease, which was up to 43 % too small.
    """
    chain = Chain([15.0, math.inf], OwnLaw(lambda d: d if d < at else 0.5 * at))
    warning = next(w for w in solve(chain, [2.0, 0.0]).warnings if "falls from an overlap of" in w.sentence)
    assert warning.numbers["overlap"] == pytest.approx(at, rel=1e-5)


@pytest.mark.parametrize(
    ("force", "at"),
    [
        (lambda d: d * math.exp(-(d**2)), math.sqrt(0.5)),  # This force has a smooth maximum.
        (lambda d: min(d, 0.4) if d < 0.7 else 0.1, 0.7),  # This force is constant before it decreases.
        # This force increases again after the decrease and exceeds its first maximum.
        (lambda d: d if d < 0.2 else d - 0.15, 0.2),
    ],
)
def test_smooth_maxima_and_plateaus_are_located(force, at):
    assert OwnLaw(force).falls(1.5) == pytest.approx(at, rel=1e-3)


@pytest.mark.parametrize("law", [lambda d, w: 100.0 * d + 5.0 * w, lambda: 1.0], ids=["rate", "none"])
def test_a_law_of_other_arguments_is_refused(law):
    with pytest.raises(ValueError, match="must be a function of one number, the overlap"):
        Chain([1.0, math.inf], law)


def test_an_energy_of_other_arguments_is_refused():
    with pytest.raises(ValueError, match="energy of a contact law must be a function of one number"):
        OwnLaw(lambda d: d, lambda d, w: d * w)
    # An argument with a default value does not count as a second argument.
    assert OwnLaw(lambda d, stiffness=2.0: stiffness * d).force(1.0) == 2.0


def test_results_show_themselves(tmp_path):
    found = solve(Chain([1.0] * 3, Toda(3.0)), START[:3], method="verlet", step=0.05)
    assert repr(found.chain) == "Chain(mass=3 x 1.0, contact=2 x OwnLaw(Toda))"
    assert "Toda(overlap)" in html_of(found.chain)
    assert found.film(size=(320, 180)).data[4:8] == b"ftyp"
    found.to_page(tmp_path / "x.html")
    page = (tmp_path / "x.html").read_text(encoding="utf-8")
    assert "Toda(overlap)" in page
    assert 'data-say="file"' not in page  # This button would save the scene with another contact law.
    assert found.to_xarray().force.shape == found.force.shape


def test_a_pulse_is_solved_although_its_energy_loses_digits():
    """Check a pulse in a chain with a law that loses digits. Far ahead of the pulse the overlaps are so small that the
    closed form of the energy is only round-off.
    """
    steep = OwnLaw(lambda d: math.expm1(5.0 * d), lambda d: math.expm1(5.0 * d) / 5.0 - d)
    found = solve(one_on(10, steep), [1.0] + [0.0] * 10, method="conserving", step=0.01)
    assert found.warnings == ()
    assert np.ptp(found.ledger) < 1e-13 * found.ledger[0]
    assert found.final_velocity[-1] == pytest.approx(0.971, abs=1e-3)


def test_a_law_that_refuses_some_overlaps_of_an_array_has_the_others():
    """Check a law that calls another law. One overlap of its table is beyond the range of the other law."""
    steep = OwnLaw(lambda overlap: np.expm1(50.0 * overlap))
    twice = OwnLaw(lambda overlap: 2.0 * steep.force(overlap))
    assert twice.table.edge[-1] == pytest.approx(steep.table.edge[-1], rel=0.1)
    assert twice.force(np.array([0.1, 1.0])) == pytest.approx(2.0 * np.expm1([5.0, 50.0]))
    with pytest.raises(ValueError, match="gives the force nan N at an overlap of 293"):
        twice.force(np.array([0.1, 293.0]))


def test_a_user_defined_law_closes_without_writing_beyond_its_arrays() -> None:
    # Only chains with several segments store flags of couplers. Plain Python raises an error for a wrong index, but
    # machine code does not.
    chain = Chain([1.0, 1.0], OwnLaw(power(2.0, 1.0)))
    state = State.at_start(chain, [1.0, 0.0])
    state.overlap[0] = 0.1
    log = kernel_records.empty_log(1, 4)
    graph, motion = kernel_records.graphs_of(chain, state), Motion(*kernel_records.motion_record(state))
    assert plain(log_switches)(0.0, 0.1, graph, motion, log) == 1
    assert log.contact[0] == 0
    assert log.time[0] == 0.0
