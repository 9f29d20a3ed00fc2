"""The collisions of the chart, each with its true answer; the same for any scene that ends by itself or has a duration."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, Trajectory, draft_gear, hertz, one_on, power_law, simulate, step_force
from softcradle.physics.analysis.closed_forms import critical_speed, rigid_collision
from softcradle.scenes import Scene

Array = NDArray[np.float64]

QUANTITIES = ("velocities", "forces", "overlaps")
REACHES = (1e-3, 1e-6, 1e-9)  # errors of final velocities, relative to the closing speed
FINE, CHECK = 1e-12, 3e-12  # tolerances of radau as the truth, and of accurate as its check
MARGIN = 1.001  # a peer that does not know when the collision is over runs this much longer
MOMENTS = 64  # midpoints of the struck contact's first closing, at which forces and overlaps are compared

# final velocities of one on 4, alpha = 1/10, by Taylor series in quadruple precision: see tests/data/README.md
ONE_ON_FOUR = (
    -0.56758562476547303918, 0.17392146672861098151, 0.4540787148354326006, 0.46978361268000769326,
    0.4698018305214217638,
)  # fmt: skip


@dataclass(frozen=True)
class Start:
    """Where a run begins: the chain `early` [s] before the case's own start, in free flight until then."""

    chain: Chain
    velocity: Array
    early: float = 0.0


@dataclass(frozen=True)
class Case:
    """One collision.

    Attributes:
        name, label, chain, velocity: what collides; the name for files and commands, the label for people.
        duration: None until the collision is over, else [s].
        end: when it is over [s].
        truth: (n+1,) final velocities [m/s].
        doubt: how far two ways to the truth lie apart, relative to the closing speed; 0 where it is known better.
        origin: where the truth is from.
        aims: milliseconds wished for, by error reached.
    """

    name: str
    label: str
    chain: Chain
    velocity: Array
    duration: float | None
    end: float
    truth: Array
    doubt: float
    origin: str
    aims: dict[float, float] = field(default_factory=dict)

    @property
    def span(self) -> float:
        """How long a run is that cannot see the end of the collision [s]."""
        return self.end * MARGIN if self.duration is None else self.duration

    @cached_property
    def closing(self) -> float:
        """Closing speed [m/s]."""
        return float(np.ptp(self.velocity)) or 1.0

    def error(self, velocity: Array) -> float:
        """Largest error of any final velocity, relative to the closing speed; inf for what is no number."""
        found = float(np.abs(velocity - self.truth).max() / self.closing)
        return found if np.isfinite(found) else np.inf

    @cached_property
    def fine(self) -> Trajectory:
        """The motion at MOMENTS of the first closing of the contact struck first, by `radau` at its tightest."""
        return _quietly(self.chain, self.velocity, self.span, "radau", FINE, self.moments)

    @cached_property
    def moments(self) -> Array:
        """(MOMENTS,) times [s]."""
        found = _quietly(self.chain, self.velocity, self.span, "radau", 1e-8, 2).contact_intervals
        closed = [interval for intervals in found for interval in intervals[:1]]
        first = min(closed, default=(0.0, self.span))
        last = max(opened for start, opened in closed if start == first[0]) if closed else self.span
        moments: Array = first[0] + (np.arange(MOMENTS) + 0.5) / MOMENTS * (min(last, self.span) - first[0])
        return moments

    def starts(self, gaps: Sequence[float]) -> list[Start]:
        """The case begun each of `gaps` [s] earlier: its end is the same. Itself alone where that cannot be."""
        rate, gap = -np.diff(self.velocity), np.array(self.chain.gap)
        parted = gap + np.outer(gaps, rate)
        if self.chain.drive or (parted < 0.0).any():
            return [Start(self.chain, self.velocity)]
        return [
            Start(replace(self.chain, gap=row), self.velocity, early) for early, row in zip(gaps, parted, strict=True)
        ]


@dataclass(frozen=True)
class Recipe:
    """A case before its truth is computed.

    Attributes:
        name, label: as in Case.
        build: makes the chain.
        velocity: None: bead 0 strikes at unit speed.
        duration: as in Case.
        known: (n+1,) final velocities where they are known better than computed here, and from where.
        aims: as in Case.
    """

    name: str
    label: str
    build: Callable[[], Chain]
    duration: float | None = None
    known: Callable[[], Array] | None = None
    origin: str = ""
    velocity: Array | None = None
    aims: dict[float, float] = field(default_factory=dict)

    def cook(self) -> Case:
        """Compute, or look up, the truth."""
        chain = self.build()
        velocity = np.eye(1, chain.contacts + 1)[0] if self.velocity is None else self.velocity
        fine = _quietly(chain, velocity, self.duration, "radau", FINE, 2)
        truth, doubt, origin = fine.final_velocity, 0.0, self.origin
        if self.known is not None:
            truth = self.known()
        else:
            check = _quietly(chain, velocity, self.duration, "accurate", CHECK, 2)
            doubt = float(np.abs(truth - check.final_velocity).max() / (np.ptp(velocity) or 1.0))
            origin = f"radau at {FINE:g}, accurate at {CHECK:g} within {doubt:.0e}"
        end = float(fine.time[-1])
        return Case(self.name, self.label, chain, velocity, self.duration, end, truth, doubt, origin, self.aims)


def recipes_of(scene: Scene) -> list[Recipe]:
    """One recipe a lane of `scene`."""
    names = [scene.title, *(f"{scene.title}: {lane.label or k + 1}" for k, lane in enumerate(scene.lanes))]
    labels = names[:1] if len(scene.lanes) == 1 else names[1:]
    return [
        Recipe(label, label, lane.chain, scene.duration, velocity=np.array(lane.velocity, dtype=np.float64))
        for label, lane in zip(labels, scene.lanes, strict=True)
    ]


def _quietly(
    chain: Chain, velocity: Array, duration: float | None, method: str, tolerance: float, samples: int | Array
) -> Trajectory:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # rescued Newton steps at the limit of round-off
        return simulate(chain, velocity, duration, method=method, tolerance=tolerance, samples=samples)


def _gears(ratio: float) -> Chain:
    """One on ten draft gears whose precompression is such that unit speed is `ratio` times critical."""
    unit = critical_speed(draft_gear(1.0, 1.0), np.ones(11), 1)
    return one_on(10, draft_gear(1.0, 1.0 / (ratio * unit)))


def _rigid(beads: int) -> Array:
    return rigid_collision(np.ones(beads), 1)


RIGID = "two rigid bodies, exact"
RECIPES: tuple[Recipe, ...] = (
    Recipe(
        "one-on-4", "one on 4, alpha = 1/10", lambda: one_on(4, power_law(1.0, 1 / 10)),
        known=lambda: np.array(ONE_ON_FOUR), origin="quadruple precision", aims={1e-6: 0.4, 1e-9: 0.7},
    ),
    Recipe("one-on-5", "one on 5, alpha = 1/14", lambda: one_on(5, power_law(1.0, 1 / 14)), aims={1e-6: 1.0, 1e-9: 4.0}),
    Recipe("one-on-10", "one on 10, alpha = 1/30", lambda: one_on(10, power_law(1.0, 1 / 30)), aims={1e-6: 2.0, 1e-9: 8.0}),
    Recipe("hertz-100", "Hertz, one on 100, t = 200", lambda: one_on(100, hertz(1.0)), 200.0, aims={1e-6: 2.0, 1e-9: 9.0}),
    Recipe(
        "gear-below", "draft gear, one on 10, 0.8 critical", lambda: _gears(0.8), known=lambda: _rigid(11), origin=RIGID,
        aims={1e-9: 2.0},
    ),
    Recipe("gear-above", "draft gear, one on 10, 3x critical", lambda: _gears(3.0), aims={1e-9: 2.0}),
    Recipe(
        "step-force", "step force, one on 10", lambda: one_on(10, step_force(1.0)), known=lambda: _rigid(11), origin=RIGID
    ),
)  # fmt: skip
