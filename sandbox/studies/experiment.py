"""Simulation of the paper's experiment (App. C), and the part of its losses that friction explains.

In the experiment, one bead hits three beads, or two beads hit two, on a bed of straws. The paper states masses, spring,
precompression, and "relative deficits in the momentum and energy upon collision" of 5-10 % and 10-20 %. The paper
states neither the launch speed nor the time over which the deficits were measured. This module measures the deficits
from the first touch to the last opening of a contact.

Three statements of the paper limit the speed. A target cluster that leaves as one body needs less than the critical
speed (1.01 m/s for one on three). A kymograph with bars of 100 ms and 12 cm shows slopes well below the diagonal of its
bars, 1.2 m/s. The beads still move 100 ms later, on a bed that costs 5-10 % in each collision. The speed is therefore
0.25 to 1 m/s. We use 0.5 m/s if one number is needed.

If the pistons have mass, energy is lost but momentum is not. The spring presses a particle's piston against the head of
its cylinder. The neighbouring particle hits the piston, which moves with the neighbour at once. When the spring has
pushed the two particles apart, the head stops the piston. For one on three, each stop costs about the fraction m_p/(m +
m_p) of the energy. The piston mass m_p of 20 g is our assumption. The paper gives the mass m of the whole particle.

As in the paper, deficits are fitted "by analysing the trajectory". Straight lines are fitted to the positions of each
bead at the frames of the camera. One window of time ends at the first touch, and another begins at the detachment. The
length of the windows is our choice, and is reported.
"""

from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from softcradle.physics import Chain, draft_gear, simulate
from softcradle.physics.analysis.closed_forms import critical_speed
from softcradle.physics.chain import GRAVITY
from softcradle.sandbox.scene_runs import KEEPING
from softcradle.sandbox.studies.fitting.design_scene import design
from softcradle.sandbox.sweeps import grid
from softcradle.sandbox.sweeps.measure_table import Run, find_measure
from softcradle.sandbox.sweeps.run_sweep import Progress, map_points
from softcradle.sandbox.sweeps.scene_points import LaneStart
from softcradle.scenes import Lane, Scene

MASS = (0.3945, 0.3980, 0.3967, 0.3938)  # Masses of the particles [kg].
STIFFNESS = 770.0  # Stiffness of the springs [N/m].
PRECOMPRESSION = 0.0177  # Precompression of the springs [m].
STRIKERS = {"one on three": 1, "two on two": 2}  # Number of strikers in each experiment.
SPEEDS = (0.25, 0.5, 0.75, 1.0)  # Launch speeds that the paper's text allows [m/s].
MOMENTUM_DEFICIT = (0.05, 0.10)  # Relative momentum deficit that the paper states.
ENERGY_DEFICIT = (0.10, 0.20)  # Relative energy deficit that the paper states.
LARGEST_FRICTION = 1.0  # Upper end of the search for the friction coefficient.
FRICTION_GUESS = 0.05  # Start of the search for the friction coefficient.
PISTON = 0.020  # Mass of a piston [kg]. It is our assumption.
FRAMES = 2052.0  # Frames per second of the camera, as stated in the paper.
WINDOWS = (0.01, 0.02, 0.04, 0.08)  # Durations over which a line is fitted to the positions [s].
STIFFNESS_ERROR = 5.0  # Error of the stiffness [N/m]: half a unit of the last digit of 7.7e2.
PRECOMPRESSION_ERROR = 5e-5  # Error of the precompression [m]: half a unit of the last digit of 1.77e-2.
MASS_ERROR = 5e-5  # Error of a mass [kg]: half a unit of the last digit.


@dataclass(frozen=True)
class Deficits:
    """Fractions of momentum and energy that a collision has lost, and the time [s] from first touch to last opening."""

    momentum: float
    energy: float
    time: float


@dataclass(frozen=True)
class Fit:
    """Fitted friction of the bed at a launch speed [m/s], and the resulting deficits for draft gears without loss."""

    experiment: str
    speed: float
    friction: float
    deficits: Deficits


@cache
def deficits(strikers: int, speed: float, friction: float, loss: float = 0.0, method: str = KEEPING) -> Deficits:
    """Return the deficits of a collision on a bed with friction.

    The first `strikers` beads hit the other beads at `speed` [m/s]. The other beads just touch.
    """
    lane = collision_scene(strikers, speed, friction, loss, method).lanes[0]
    run = Run(LaneStart(lane.chain(), lane.velocity, {"method": method}))
    assert run.opened is not None  # The time is known because the striker detaches.
    momentum, energy = (find_measure(name).function(run) for name in ("missing_momentum", "missing_energy"))
    return Deficits(momentum, energy, float(run.opened.time[-1]))  # type: ignore[arg-type]


def collision_scene(strikers: int, speed: float, friction: float, loss: float = 0.0, method: str = KEEPING) -> Scene:
    """Return a scene in which the first `strikers` beads hit the other beads at `speed` [m/s], on a bed with friction.

    The other beads just touch.
    """
    chain = Chain(MASS, draft_gear(STIFFNESS, PRECOMPRESSION, loss), friction=friction)
    velocity = [speed] * strikers + [0.0] * (len(MASS) - strikers)
    return Scene(title="the experiment of the paper", lanes=(Lane.of(chain, velocity),), method=method)


def friction_for(momentum: float, strikers: int, speed: float) -> float:
    """Return the friction coefficient at which a collision loses the fraction `momentum` of its momentum.

    The draft gears have no loss. A command finds the same coefficient: `softcradle fit SCENE --goal 'missing momentum =
    ...' --free lanes.0.friction`.
    """
    scene = collision_scene(strikers, speed, FRICTION_GUESS)
    found = design(scene, f"missing momentum = {momentum!r}", [f"lanes.0.friction=0..{LARGEST_FRICTION}"])
    return float(found.values[0])


def fit_friction(speed: float) -> list[Fit]:
    """Fit one friction coefficient to both experiments, without any other loss.

    The result is in the middle of the range that the momentum deficits of both experiments allow.
    """
    friction = friction_with_error(speed).value
    return [Fit(name, speed, friction, deficits(k, speed, friction)) for name, k in STRIKERS.items()]


class Apparatus(NamedTuple):
    """Measured quantities that have an error: stiffness [N/m], precompression [m] and friction of the bed."""

    stiffness: float
    precompression: float
    friction: float


class Measured(NamedTuple):
    """A number and its error."""

    value: float
    error: float


@dataclass(frozen=True)
class FittedDeficits:
    """Missing fractions of momentum and energy from lines fitted over a window [s].

    If the window is 0, the velocities at the first touch and at the detachment are used.
    """

    experiment: str
    speed: float
    window: float
    momentum: Measured
    energy: Measured


@cache
def piston_deficits(strikers: int, speed: float, setup: Apparatus, piston: float, window: float) -> tuple[float, float]:
    """Return the deficits of momentum and energy of a collision on a bed, with pistons that have mass.

    The first `strikers` beads hit the other beads at `speed` [m/s].
    """
    mass, struck = np.array(MASS), strikers - 1
    gear = draft_gear(setup.stiffness, setup.precompression)
    velocity = np.where(np.arange(mass.size) < strikers, speed, 0.0)
    velocity[struck] *= mass[struck] / (mass[struck] + piston)  # The struck bead takes the resting piston with it.
    moved = mass.copy()
    moved[[struck, struck + 1]] += [piston, -piston]
    chain = Chain(moved, gear, friction=setup.friction)
    opened = simulate(chain, velocity, method=KEEPING, samples=2).contact_intervals[struck][0][1]
    end = simulate(chain, velocity, opened, method=KEEPING, samples=2)
    after = end.velocity[-1].copy()
    after[struck + 1] = (moved[struck + 1] * after[struck + 1] + piston * after[struck]) / mass[struck + 1]
    before = np.where(np.arange(mass.size) < strikers, speed + 0.5 * setup.friction * GRAVITY * window, 0.0)
    if window:
        after = _fitted(Chain(mass, gear, -end.overlap[-1], friction=setup.friction), after, window)
    return 1.0 - float(mass @ after / (mass @ before)), 1.0 - float(mass @ after**2 / (mass @ before**2))


def _fitted(chain: Chain, velocity: np.ndarray, window: float) -> np.ndarray:
    """Return the (n+1,) slopes of lines fitted to the positions of the beads.

    The positions are taken at the frames of the camera during the next `window` [s].
    """
    times = np.arange(0.0, window, 1.0 / FRAMES)
    position = simulate(chain, velocity, window, KEEPING, samples=times).position
    return np.asarray(np.polyfit(times, position, 1)[0])


def with_error(quantity: Callable[[Apparatus], float], friction: Measured) -> Measured:
    """Return a quantity and its error from the errors of stiffness, precompression and friction.

    The three errors are assumed to be independent.
    """
    middle = Apparatus(STIFFNESS, PRECOMPRESSION, friction.value)
    errors = Apparatus(STIFFNESS_ERROR, PRECOMPRESSION_ERROR, friction.error)
    value, squares = quantity(middle), 0.0
    for name, error in errors._asdict().items():
        if error:
            up, down = (
                quantity(middle._replace(**{name: getattr(middle, name) + sign * error})) for sign in (1.0, -1.0)
            )
            squares += (0.5 * (up - down)) ** 2
    return Measured(value, squares**0.5)


def fitted_deficits(
    experiment: str, strikers: int, speed: float, friction: Measured, piston: float = PISTON, window: float = 0.0
) -> FittedDeficits:
    """Return the deficits of momentum and energy, each with its error."""
    momentum, energy = (
        with_error(lambda setup, k=k: piston_deficits(strikers, speed, setup, piston, window)[k], friction)  # type: ignore[misc]
        for k in (0, 1)
    )
    return FittedDeficits(experiment, speed, window, momentum, energy)


def critical_speed_with_error(strikers: int) -> Measured:
    """Return the critical speed [m/s] for the measured masses. The error of the speed includes the errors of the
    masses.
    """

    def at(setup: Apparatus, mass: tuple[float, ...] = MASS) -> float:
        return critical_speed(draft_gear(setup.stiffness, setup.precompression), mass, strikers)

    found = with_error(at, Measured(0.0, 0.0))
    middle, squares = Apparatus(STIFFNESS, PRECOMPRESSION, 0.0), found.error**2
    for k in range(len(MASS)):
        changed = tuple(m + MASS_ERROR * (i == k) for i, m in enumerate(MASS))
        squares += (at(middle, changed) - found.value) ** 2
    return Measured(found.value, squares**0.5)


def friction_with_error(speed: float) -> Measured:
    """Return the friction of the bed that gives both experiments their momentum deficits at `speed`.

    The value is the middle of the allowed range, and its error is half the width of this range.
    """
    lows, highs = ([friction_for(part, k, speed) for k in STRIKERS.values()] for part in MOMENTUM_DEFICIT)
    low, high = max(lows), min(highs)
    return Measured(0.5 * (low + high), 0.5 * (high - low))


# The window 0 uses the velocities at the first touch and at the detachment.
PISTON_CASES = [(name, window) for name in STRIKERS for window in (0.0, *WINDOWS)]


def compute_experiment(
    speeds: Sequence[float] = SPEEDS, progress: Progress | None = None, workers: int | None = None
) -> tuple[list[Fit], list[FittedDeficits]]:
    """Fit the friction of the bed, and compute the deficits with pistons.

    Both experiments are computed at each of the launch speeds [m/s].
    """
    found = map_points(speed_numbers, grid({"speed": list(speeds)}), None, progress, workers)
    fits, pistons = list[Fit](), list[FittedDeficits]()
    for speed, numbers in zip(speeds, found, strict=True):
        for name, (friction, *lost) in zip(STRIKERS, numbers["fits"].tolist(), strict=True):
            fits.append(Fit(name, speed, friction, Deficits(*lost)))
        for (name, window), row in zip(PISTON_CASES, numbers["pistons"].tolist(), strict=True):
            pistons.append(FittedDeficits(name, speed, window, Measured(*row[:2]), Measured(*row[2:])))
    return fits, pistons


def speed_numbers(speed: float) -> dict[str, list[list[float]]]:
    """Return the numbers for one launch speed.

    There is one row for each experiment. With pistons there is also a row for each window of each experiment.
    """
    friction = friction_with_error(speed)
    fits = [[fit.friction, *astuple(fit.deficits)] for fit in fit_friction(speed)]
    pistons = [fitted_deficits(name, STRIKERS[name], speed, friction, window=window) for name, window in PISTON_CASES]
    return {"fits": fits, "pistons": [[*found.momentum, *found.energy] for found in pistons]}
