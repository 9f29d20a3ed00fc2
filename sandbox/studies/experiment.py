"""The paper's experiment (App. C): one on three and two on two on a bed of straws, and how much friction explains.

The paper states masses, spring, precompression, and "relative deficits in the momentum and energy upon collision" of
5-10 % and 10-20 %. It states neither the launch speed nor the time over which the deficits were taken. Here they are
taken from the first touch to the last opening.

The text limits the speed. A target cluster that leaves as one body needs less than the critical speed (1.01 m/s for one
on three). A kymograph with bars of 100 ms and 12 cm shows slopes well below the diagonal of its bars, 1.2 m/s. Its
marker still moves 100 ms later, on a bed that costs 5-10 % in each collision. So the speed is 0.25 to 1 m/s, and 0.5
m/s if one number is needed.

If the pistons have mass, energy is lost but momentum is not. The spring presses a particle's piston against the
cylinder's head. The neighbour hits the piston, which moves with it at once; when the spring has pushed the two apart,
the head stops the piston. For one on three, each catch costs about the fraction m_p/(m + m_p) of the energy. The piston
mass of 20 g is our assumption; the paper gives the mass of the whole particle.

Deficits are fitted as in the paper, "by analysing the trajectory": straight lines through each bead's positions at the
camera's frames, over a window that ends at the first touch, and over one that begins at the detachment. The length of
the window is our choice, and is reported.
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

MASS = (0.3945, 0.3980, 0.3967, 0.3938)  # [kg]
STIFFNESS = 770.0  # [N/m]
PRECOMPRESSION = 0.0177  # [m]
STRIKERS = {"one on three": 1, "two on two": 2}  # strikers of each experiment
SPEEDS = (0.25, 0.5, 0.75, 1.0)  # launch speeds that the text allows [m/s]
MOMENTUM_DEFICIT = (0.05, 0.10)  # as stated
ENERGY_DEFICIT = (0.10, 0.20)  # as stated
LARGEST_FRICTION = 1.0  # upper end of the search for the coefficient
FRICTION_GUESS = 0.05  # start of this search
PISTON = 0.020  # [kg], our assumption
FRAMES = 2052.0  # frames per second of the camera, as stated
WINDOWS = (0.01, 0.02, 0.04, 0.08)  # lengths of the fitted line [s]
STIFFNESS_ERROR = 5.0  # [N/m]: half a unit of the last digit of 7.7e2
PRECOMPRESSION_ERROR = 5e-5  # [m]: half a unit of the last digit of 1.77e-2
MASS_ERROR = 5e-5  # [kg]: half a unit of the last digit


@dataclass(frozen=True)
class Deficits:
    """Shares of momentum and energy that a collision has lost, and its time [s] from first touch to last opening."""

    momentum: float
    energy: float
    time: float


@dataclass(frozen=True)
class Fit:
    """Friction of the bed, fitted at a launch speed [m/s], and the deficits that result with gears without loss."""

    experiment: str
    speed: float
    friction: float
    deficits: Deficits


@cache
def deficits(strikers: int, speed: float, friction: float, loss: float = 0.0, method: str = KEEPING) -> Deficits:
    """Return the deficits if `strikers` at `speed` [m/s] hit the others, which just touch, on a bed with friction."""
    lane = collision_scene(strikers, speed, friction, loss, method).lanes[0]
    run = Run(LaneStart(lane.chain(), lane.velocity, {"method": method}))
    assert run.opened is not None  # the striker leaves
    momentum, energy = (find_measure(name).function(run) for name in ("missing_momentum", "missing_energy"))
    return Deficits(momentum, energy, float(run.opened.time[-1]))  # type: ignore[arg-type]


def collision_scene(strikers: int, speed: float, friction: float, loss: float = 0.0, method: str = KEEPING) -> Scene:
    """Return the scene in which `strikers` at `speed` [m/s] hit the others, which just touch, on a bed with friction."""
    chain = Chain(MASS, draft_gear(STIFFNESS, PRECOMPRESSION, loss), friction=friction)
    velocity = [speed] * strikers + [0.0] * (len(MASS) - strikers)
    return Scene(title="the experiment of the paper", lanes=(Lane.of(chain, velocity),), method=method)


def friction_for(momentum: float, strikers: int, speed: float) -> float:
    """Return the friction coefficient at which the collision loses the share `momentum`, with gears without loss.

    The general tool finds it: `softcradle fit SCENE --goal 'missing momentum = ...' --free lanes.0.friction`.
    """
    scene = collision_scene(strikers, speed, FRICTION_GUESS)
    found = design(scene, f"missing momentum = {momentum!r}", [f"lanes.0.friction=0..{LARGEST_FRICTION}"])
    return float(found.values[0])


def fit_friction(speed: float) -> list[Fit]:
    """Fit friction only: one coefficient for both experiments, in the middle of the range that their momentum deficits
    allow.
    """
    friction = friction_with_error(speed).value
    return [Fit(name, speed, friction, deficits(k, speed, friction)) for name, k in STRIKERS.items()]


class Apparatus(NamedTuple):
    """Quantities known with an error: stiffness [N/m], precompression [m], friction of the bed."""

    stiffness: float
    precompression: float
    friction: float


class Measured(NamedTuple):
    """A number and its error."""

    value: float
    error: float


@dataclass(frozen=True)
class FittedDeficits:
    """Missing shares of momentum and energy in lines fitted over a window [s]; 0 uses the moments themselves."""

    experiment: str
    speed: float
    window: float
    momentum: Measured
    energy: Measured


@cache
def piston_deficits(strikers: int, speed: float, setup: Apparatus, piston: float, window: float) -> tuple[float, float]:
    """Return the deficits of momentum and energy if `strikers` at `speed` [m/s] hit the others, on a bed, with pistons."""
    mass, struck = np.array(MASS), strikers - 1
    gear = draft_gear(setup.stiffness, setup.precompression)
    velocity = np.where(np.arange(mass.size) < strikers, speed, 0.0)
    velocity[struck] *= mass[struck] / (mass[struck] + piston)  # the piston is caught
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
    """Return the (n+1,) slopes of the lines through the positions at the camera's frames over the next `window` [s]."""
    times = np.arange(0.0, window, 1.0 / FRAMES)
    position = simulate(chain, velocity, window, KEEPING, samples=times).position
    return np.asarray(np.polyfit(times, position, 1)[0])


def with_error(quantity: Callable[[Apparatus], float], friction: Measured) -> Measured:
    """Return a quantity at the stated values, with its error from independent errors of stiffness, precompression and
    friction.
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
    """Return both deficits with their errors."""
    momentum, energy = (
        with_error(lambda setup, k=k: piston_deficits(strikers, speed, setup, piston, window)[k], friction)  # type: ignore[misc]
        for k in (0, 1)
    )
    return FittedDeficits(experiment, speed, window, momentum, energy)


def critical_speed_with_error(strikers: int) -> Measured:
    """Return the critical speed [m/s] of the measured masses; its error includes their errors."""

    def at(setup: Apparatus, mass: tuple[float, ...] = MASS) -> float:
        return critical_speed(draft_gear(setup.stiffness, setup.precompression), mass, strikers)

    found = with_error(at, Measured(0.0, 0.0))
    middle, squares = Apparatus(STIFFNESS, PRECOMPRESSION, 0.0), found.error**2
    for k in range(len(MASS)):
        changed = tuple(m + MASS_ERROR * (i == k) for i, m in enumerate(MASS))
        squares += (at(middle, changed) - found.value) ** 2
    return Measured(found.value, squares**0.5)


def friction_with_error(speed: float) -> Measured:
    """Return the bed friction that gives both experiments their momentum deficits at that speed: middle and half of the
    range.
    """
    lows, highs = ([friction_for(part, k, speed) for k in STRIKERS.values()] for part in MOMENTUM_DEFICIT)
    low, high = max(lows), min(highs)
    return Measured(0.5 * (low + high), 0.5 * (high - low))


PISTON_CASES = [(name, window) for name in STRIKERS for window in (0.0, *WINDOWS)]  # first at the moments themselves


def compute_experiment(
    speeds: Sequence[float] = SPEEDS, progress: Progress | None = None, workers: int | None = None
) -> tuple[list[Fit], list[FittedDeficits]]:
    """Fit the friction of the bed, and compute the deficits with pistons, for both experiments at these speeds [m/s]."""
    found = map_points(speed_numbers, grid({"speed": list(speeds)}), None, progress, workers)
    fits, pistons = list[Fit](), list[FittedDeficits]()
    for speed, numbers in zip(speeds, found, strict=True):
        for name, (friction, *lost) in zip(STRIKERS, numbers["fits"].tolist(), strict=True):
            fits.append(Fit(name, speed, friction, Deficits(*lost)))
        for (name, window), row in zip(PISTON_CASES, numbers["pistons"].tolist(), strict=True):
            pistons.append(FittedDeficits(name, speed, window, Measured(*row[:2]), Measured(*row[2:])))
    return fits, pistons


def speed_numbers(speed: float) -> dict[str, list[list[float]]]:
    """Return the numbers of one launch speed: a row for each experiment and, with pistons, a row for each of its
    windows.
    """
    friction = friction_with_error(speed)
    fits = [[fit.friction, *astuple(fit.deficits)] for fit in fit_friction(speed)]
    pistons = [fitted_deficits(name, STRIKERS[name], speed, friction, window=window) for name, window in PISTON_CASES]
    return {"fits": fits, "pistons": [[*found.momentum, *found.energy] for found in pistons]}
