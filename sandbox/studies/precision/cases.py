"""Collisions of the work-precision chart, each with its true result. Any scene can be used as a case."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, Trajectory, draft_gear, hertz, one_on, power_law, step_force
from softcradle.physics.analysis.closed_forms import critical_speed, rigid_collision
from softcradle.physics.simulation import solve
from softcradle.scenes import Scene

Array = NDArray[np.float64]

# Error levels at which methods are compared. The errors are those of final velocities, relative to the closing speed.
ERROR_LEVELS = (1e-3, 1e-6, 1e-9)
# Tolerance of the method scipy. The result of scipy is the true result if this method reaches the end.
REFERENCE_TOLERANCE = 1e-12
REFERENCE_STEPS = 100_000  # Largest number of steps of the method scipy. These steps take half a minute.
TRUTH_TOLERANCE = 1e-12  # Tolerance of radau. The result of radau is the true result if no better result is known.
# Tolerance of accurate. The difference of accurate from the true result is the uncertainty of the true result.
CHECK_TOLERANCE = 3e-12
# Other integrators cannot detect the end of a collision. The duration of these integrators is the true duration times
# this factor.
PEER_MARGIN = 1.001
# Number of sample times at which forces and overlaps are compared, in the first closing of the struck contact.
SAMPLE_COUNT = 64

# Final velocities of one on 4 with alpha = 1/10. The velocities were computed with Taylor series in quadruple
# precision; see tests/helpers/data/README.md.
ONE_ON_FOUR = (
    -0.56758562476547303918, 0.17392146672861098151, 0.4540787148354326006, 0.46978361268000769326,
    0.4698018305214217638,
)  # fmt: skip
# Final velocities of one on 10 with alpha = 1/30, which SciPy cannot solve. The velocities were computed by collocation
# in extended precision with `reference_end` of benchmarks/scan.
ONE_ON_TEN = (
    -0.7832546035595891, -0.06730576344112452, 0.1695828240424023, 0.2067366104888179, 0.21042330395979278,
    0.21063308123078361, 0.21063690197294313, 0.21063691127543868, 0.21063691134291795, 0.2106369113437304,
    0.21063691134388685,
)  # fmt: skip
RIGID_SOURCE = "two rigid bodies, exact"


@dataclass(frozen=True)
class Start:
    """Initial state of a case that begins `early` [s] before the case itself. The beads move freely in this time."""

    chain: Chain
    velocity: Array
    early: float = 0.0


@dataclass(frozen=True)
class ChartCase:
    """One collision with its true result.

    Attributes:
        name, label, chain, velocity: the collision; the name is for files and commands, the label for people.
        duration: [s] if an external force acts, because it continues after the collision; None otherwise.
        end: end of the collision [s].
        truth: (n+1,) final velocities [m/s].
        uncertainty: difference of two independent results, relative to the closing speed; 0 if the truth is more exact.
        source: source of the truth.
        aims: goals for the computing time of `accurate` [ms], by error level.
    """

    name: str
    label: str
    chain: Chain
    velocity: Array
    duration: float | None
    end: float
    truth: Array
    uncertainty: float
    source: str
    aims: dict[float, float] = field(default_factory=dict)

    @property
    def run_duration(self) -> float:
        """Duration [s] of a simulation that cannot detect the end of the collision."""
        return self.end * PEER_MARGIN if self.duration is None else self.duration

    @cached_property
    def closing_speed(self) -> float:
        """Speed [m/s] at which the colliding beads approach each other."""
        return float(np.ptp(self.velocity)) or 1.0

    def error(self, velocity: Array) -> float:
        """Return the largest error of a final velocity, relative to the closing speed. The error is infinite if a
        velocity is NaN.
        """
        error = float(np.abs(velocity - self.truth).max() / self.closing_speed)
        return error if np.isfinite(error) else np.inf

    @cached_property
    def sampled_truth(self) -> Trajectory:
        """Motion at `sample_times`, computed with `radau` at its smallest tolerance."""
        return self._solve_by_radau(TRUTH_TOLERANCE, self.sample_times)

    @property
    def yielding(self) -> NDArray[np.bool_]:
        """(SAMPLE_COUNT, n) True if the contact is compressed or extended at that sample time."""
        overlap = self.sampled_truth.overlap
        found: NDArray[np.bool_] = (overlap > 0.0) | (overlap < 0.0) & (self.sampled_truth.force < 0.0)
        return found

    @cached_property
    def sample_times(self) -> Array:
        """(SAMPLE_COUNT,) sample times [s] in the first closing of the first contact that is hit.

        The closing is divided into equal parts. The sample times are the midpoints of these parts.
        """
        found = self._solve_by_radau(1e-8, 2).contact_intervals
        closings = [intervals[0] for intervals in found if intervals]
        first = min((closed for closed, _ in closings), default=0.0)
        last = max((opened for closed, opened in closings if closed == first), default=self.run_duration)
        parts = (np.arange(SAMPLE_COUNT) + 0.5) / SAMPLE_COUNT
        times: Array = first + parts * (min(last, self.run_duration) - first)
        return times

    def _solve_by_radau(self, tolerance: float, samples: int | Array) -> Trajectory:
        return solve(self.chain, self.velocity, self.run_duration, "radau", None, samples, tolerance)

    def starts(self, lead_times: Sequence[float]) -> list[Start]:
        """Return copies of the case that start earlier by each of `lead_times` [s]. All have the same end.

        The case must begin with free flight. If it does not, return only the case itself. The beads do not begin in
        free flight if an external force acts, or if a contact would have pushed or pulled earlier.
        """
        rate, gap = -np.diff(self.velocity), np.array(self.chain.gap)
        gaps = gap + np.outer(lead_times, rate)
        free = np.full(gap.size, np.inf)
        for contact, coupler in self.chain.piecewise:
            free[contact] = -coupler.pulls_below
        if _acts_from_outside(self.chain) or ((gaps < 0.0) | (gaps > free)).any():
            return [Start(self.chain, self.velocity)]
        return [
            Start(replace(self.chain, gap=row), self.velocity, early)
            for early, row in zip(lead_times, gaps, strict=True)
        ]


@dataclass(frozen=True)
class CaseDefinition:
    """Definition of a case, before its true result is computed.

    Attributes:
        name, label: as in ChartCase.
        make_chain: function that returns the chain.
        duration: as in ChartCase.
        truth: function that returns (n+1,) final velocities, if a better result than ours is known; `source` is its
            source.
        velocity: initial velocities; None means that bead 0 strikes at unit speed.
        aims: as in ChartCase.
    """

    name: str
    label: str
    make_chain: Callable[[], Chain]
    duration: float | None = None
    truth: Callable[[], Array] | None = None
    source: str = ""
    uncertainty: float = 0.0  # Error of the true velocities [m/s].
    velocity: Array | None = None
    aims: dict[float, float] = field(default_factory=dict)

    def solve(self, by_reference: bool = True) -> ChartCase:
        """Return the case with its true result, which is computed or looked up.

        If `by_reference` is False, the true result comes from two of our methods.
        """
        chain = self.make_chain()
        velocity = np.eye(1, chain.contacts + 1)[0] if self.velocity is None else self.velocity
        finest = solve(chain, velocity, self.duration, "radau", samples=2, tolerance=TRUTH_TOLERANCE)
        end = float(finest.time[-1])
        if not end:
            raise ValueError("nothing collides: there is nothing to measure")
        duration = end if self.duration is None and _acts_from_outside(chain) else self.duration
        truth, uncertainty, source = self._truth(chain, velocity, duration, finest.final_velocity, by_reference)
        return ChartCase(self.name, self.label, chain, velocity, duration, end, truth, uncertainty, source, self.aims)

    def _truth(
        self, chain: Chain, velocity: Array, duration: float | None, finest: Array, by_reference: bool
    ) -> tuple[Array, float, str]:
        """Return the true result, its uncertainty relative to the closing speed, and its source.

        The argument `finest` is the simulation by radau with the smallest tolerance.
        """
        if self.truth is not None:
            return self.truth(), self.uncertainty, self.source
        speed = np.ptp(velocity) or 1.0
        if by_reference:
            settings = None, 2, REFERENCE_TOLERANCE, REFERENCE_STEPS
            reference = solve(chain, velocity, duration, "scipy", *settings)
            if not reference.status.gave_up:
                error = float(np.abs(finest - reference.final_velocity).max() / speed)
                known = f"scipy at {REFERENCE_TOLERANCE:g}, radau at {TRUTH_TOLERANCE:g} within {error:.0e}"
                return reference.final_velocity, error, known
        check = solve(chain, velocity, duration, "accurate", samples=2, tolerance=CHECK_TOLERANCE)
        error = float(np.abs(finest - check.final_velocity).max() / speed)
        return finest, error, f"radau at {TRUTH_TOLERANCE:g}, accurate at {CHECK_TOLERANCE:g} within {error:.0e}"


def _acts_from_outside(chain: Chain) -> bool:
    """Return True if an external force, a brake, a bed or strings act on beads, also in free flight."""
    return chain.driven or chain.takes_momentum


def definitions_of(scene: Scene) -> list[CaseDefinition]:
    """Return one case definition for each lane of `scene`."""
    if len(scene.lanes) == 1:
        labels = [scene.title]
    else:
        labels = [f"{scene.title}: {lane.label or k}" for k, lane in enumerate(scene.lanes, 1)]
    return [
        CaseDefinition(label, label, lane.chain, scene.duration, velocity=np.array(lane.velocity, dtype=np.float64))
        for label, lane in zip(labels, scene.lanes, strict=True)
    ]


def _draft_gears(ratio: float) -> Chain:
    """Return a chain in which one bead hits ten, with draft gears.

    The precompression makes unit speed equal to `ratio` times the critical speed.
    """
    # The critical speed is proportional to the precompression.
    critical = critical_speed(draft_gear(1.0, 1.0), np.ones(11), 1)
    return one_on(10, draft_gear(1.0, 1.0 / (ratio * critical)))


def _rigid_outcome(beads: int) -> Array:
    return rigid_collision(np.ones(beads), 1)


CASE_DEFINITIONS: tuple[CaseDefinition, ...] = (
    CaseDefinition(
        "one-on-4", "one on 4, alpha = 1/10", lambda: one_on(4, power_law(1.0, 1 / 10)),
        truth=lambda: np.array(ONE_ON_FOUR), source="quadruple precision", aims={1e-6: 0.12, 1e-9: 0.22},
    ),
    CaseDefinition(
        "one-on-5", "one on 5, alpha = 1/14", lambda: one_on(5, power_law(1.0, 1 / 14)), aims={1e-6: 0.2, 1e-9: 0.6}
    ),
    CaseDefinition(
        "one-on-10", "one on 10, alpha = 1/30", lambda: one_on(10, power_law(1.0, 1 / 30)), aims={1e-6: 0.4, 1e-9: 0.9},
        truth=lambda: np.array(ONE_ON_TEN), source="collocation in extended precision", uncertainty=5.5e-11,
    ),
    CaseDefinition(
        "hertz-100", "Hertz, one on 100, t = 200", lambda: one_on(100, hertz(1.0)), 200.0, aims={1e-6: 1.0, 1e-9: 2.2},
    ),
    CaseDefinition(
        "gear-below", "draft gear, one on 10, 0.8 critical", lambda: _draft_gears(0.8), truth=lambda: _rigid_outcome(11),
        source=RIGID_SOURCE, aims={1e-6: 0.05, 1e-9: 0.1},
    ),
    CaseDefinition("gear-above", "draft gear, one on 10, 3x critical", lambda: _draft_gears(3.0), aims={1e-6: 0.05, 1e-9: 0.1}),
    CaseDefinition(
        "step-force", "step force, one on 10", lambda: one_on(10, step_force(1.0)), truth=lambda: _rigid_outcome(11),
        source=RIGID_SOURCE,
    ),
)  # fmt: skip
