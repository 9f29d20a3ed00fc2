"""The chains of the paper and their simulations, shared by figures and claims.

The module contains cases, solvers and quantities. Each simulation is computed only once.
"""

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, Contact, Trajectory, one_on, power_law
from softcradle.physics.analysis.measures import loads, rigidity
from softcradle.physics.analysis.mode_coupling import ModeCoupling, mode_coupling
from softcradle.physics.simulation import solve
from softcradle.physics.status import CodedWarning, WarningCode
from softcradle.sandbox.scene_runs import KEEPING, TOLD

Array = NDArray[np.float64]
Parameters = Mapping[str, float]  # Parameters of a case by name: n, 1/alpha and others.
Samples = int | tuple[float, ...]  # Number of samples, or their times [s].

N = 4  # Number of targets in Figs. 1 and 2.
ALPHA = 1.0 / 10.0  # Exponent in Figs. 1b, 1c and 2.
SOFTER_ALPHA = 1.0 / 14.0  # Exponent in Fig. 1d.
OWN = {"n": 4.0, "1/alpha": 10.0}  # Parameters of the case in Figs. 1 and 2.
DRIVE = 1.0  # Steady force on the first bead of a driven cluster, in units of f0.
LATER = 1.25  # Ratio of the two values of 1/alpha from which a local rate is computed.

SAMPLES = 1001  # Number of samples for a figure.
TOLERANCE = 1e-8  # Tolerance of the simulations for a figure.
# Smallest oscillation that counts as one, in units of the striker's speed or of f0. This size is a hundredth of the
# discrepancy in Fig. 2c.
SWING = 1e-5

# Warnings after which no quantity of a simulation is determined.
INCOMPLETE = (WarningCode.GAVE_UP, WarningCode.UNCONVERGED, WarningCode.LOG_FULL)
KEPT_ENDS = 4096  # Number of cached simulations that contain only the final state.
KEPT_MOTIONS = 64  # Number of cached simulations that contain samples. Each simulation takes up to some megabytes.


class NotSolvedError(Exception):
    """Raised if a quantity is undetermined because a simulation gave up."""


@dataclass(frozen=True)
class MethodFineness:
    """A method with its accuracy: the step for fixed-step methods, or the tolerance for adaptive methods."""

    method: str
    step: float | None = None
    tolerance: float = 1e-9

    def motion(
        self, chain: Chain, velocity: tuple[float, ...], duration: float | None = None, samples: Samples = 2
    ) -> Trajectory:
        """Solve the full equations, Eq. (3). Raise NotSolvedError if the method gave up."""
        found = _run(self, chain, velocity, duration, samples)
        for warning in found.warnings:
            if warning.code in INCOMPLETE:
                raise NotSolvedError(f"{self.method}: {warning.code.value}")
        if found.status.gave_up:
            raise NotSolvedError(f"{self.method}: {found.status.name.lower()}")
        return found

    def model(
        self, chain: Chain, velocity: tuple[float, ...], duration: float | None = None, samples: Samples = 2
    ) -> ModeCoupling:
        """Solve the mode-coupling model, Eqs. (8) and (A3)."""
        return _model(self, chain, velocity, duration, samples)


MEASURING = MethodFineness(TOLD)
# Second method for error bars. The error of this method is of the order of the discrepancies in the figures.
SECOND = MethodFineness(KEEPING, 1e-4)
FINER_SECOND = MethodFineness(KEEPING, 1e-5)  # Second method for differences of times and for small spreads.
FINEST_SECOND = MethodFineness(KEEPING, 1e-6)  # Second method for oscillations with a period of about 1e-4.
REFERENCE = MethodFineness("scipy")


def _run(
    solver: MethodFineness, chain: Chain, velocity: tuple[float, ...], duration: float | None, samples: Samples
) -> Trajectory:
    return (_end if samples == 2 else _sampled)(solver, chain, velocity, duration, samples)


def _solved(
    solver: MethodFineness, chain: Chain, velocity: tuple[float, ...], duration: float | None, samples: Samples
) -> Trajectory:
    return solve(chain, velocity, duration, solver.method, solver.step, _argument(samples), solver.tolerance)


_end = lru_cache(maxsize=KEPT_ENDS)(_solved)
_sampled = lru_cache(maxsize=KEPT_MOTIONS)(_solved)


@lru_cache(maxsize=KEPT_MOTIONS)
def _model(
    solver: MethodFineness, chain: Chain, velocity: tuple[float, ...], duration: float | None, samples: Samples
) -> ModeCoupling:
    with warnings.catch_warnings():  # Claims have error bars instead of warnings. Figures pass warnings on.
        warnings.simplefilter("ignore", RuntimeWarning)
        return mode_coupling(
            chain, velocity, duration, solver.method, solver.step, _argument(samples), solver.tolerance
        )


def _argument(samples: Samples) -> int | Array:
    return samples if isinstance(samples, int) else np.array(samples)


def soft_chain(n: int, alpha: float) -> Chain:
    """Return the homogeneous chain in which one bead hits `n` beads.

    Masses and contact strengths are 1, and all contacts have the exponent `alpha`.
    """
    return one_on(n, power_law(1.0, alpha))


def chain_of(case: Parameters) -> Chain:
    """Return the homogeneous chain of a case with the parameters n and 1/alpha."""
    return soft_chain(round(case["n"]), 1.0 / case["1/alpha"])


def start(chain: Chain, strikers: int = 1, speed: float = 1.0) -> tuple[float, ...]:
    """Return the initial velocities: `speed` for the strikers, and 0 for all other beads."""
    return (speed,) * strikers + (0.0,) * (chain.contacts + 1 - strikers)


def driven_chain(n: int, alpha: float) -> Chain:
    """Return `n` unit beads that just touch, with a steady force on the first bead (Sec. V).

    The mode-coupling model of this chain has one overlap. For unit strength, its equation is ``psi'' = F/m1 - (1/m1 +
    1/M) psi**alpha``. The energy of the model gives the amplitude and the period.
    """
    return Chain([1.0] * n, power_law(1.0, alpha), drive=[DRIVE] + [0.0] * (n - 1))


def driven_amplitude(n: int, alpha: float) -> float:
    """Return the largest psi in the model of the driven cluster, ``((1 + alpha) F (n-1)/n)**(1/alpha)``."""
    return float(((1.0 + alpha) * DRIVE * (n - 1) / n) ** (1.0 / alpha))


def driven_period(n: int, alpha: float) -> float:
    """Return the period in the model of the driven cluster, ``sqrt(2 psi_max / F) B(1/(2 alpha), 1/2) / alpha``."""
    x = 0.5 / alpha
    beta = math.sqrt(math.pi) * math.exp(math.lgamma(x) - math.lgamma(x + 0.5))  # This is the beta function B(x, 1/2).
    return math.sqrt(2.0 * driven_amplitude(n, alpha) / DRIVE) * beta / alpha


STRIKER_CONTACT = power_law(1.0, 1.0 / 30.0)  # Contact of the striker that hits a cluster under prestress.
SPRING_PRESTRESS = 20.0  # Force on the springs. The force keeps the springs compressed all the time.


def pressed_cluster(n: int, inner: Contact, prestress: float) -> Chain:
    """Return a chain of a striker and `n` targets at rest. All masses are 1.

    The ends of the targets are pressed together by the force `prestress`. Linear contacts can have a prestress that
    they never lose. Around their rest position they act like springs that push and pull.
    """
    contacts = (STRIKER_CONTACT, *(inner,) * (n - 1))
    if not prestress:
        return one_on(n, contacts)
    gap = [0.0, *[-float(inner.overlap(prestress))] * (n - 1)]
    return Chain([1.0] * (n + 1), contacts, gap, [0.0, prestress, *[0.0] * (n - 2), -prestress])


def random_beads(random: np.random.Generator, targets: int, width: float) -> tuple[Array, Array]:
    """Return random masses of a striker and `targets` beads, and random strengths of their contacts.

    The numbers are between 1/width and width. The logarithms of the numbers have a uniform distribution.
    """
    mass, strength = (width ** random.uniform(-1.0, 1.0, count) for count in (targets + 1, targets))
    return mass, strength


def power_laws(strength: Sequence[float] | Array, exponent: Sequence[float] | Array) -> list[Contact]:
    """Return soft contacts with the given strengths and exponents."""
    return [Contact(0.0, f0, alpha) for f0, alpha in zip(strength, exponent, strict=True)]


def spread_by_mass(mass: Array, velocity: Array) -> float:
    """Return the spread of the targets' velocities relative to their mean, weighted by mass.

    The spread is the root mean square deviation from the mean.
    """
    mean = np.average(velocity, weights=mass)
    return float(np.sqrt(np.average((velocity - mean) ** 2, weights=mass)) / mean)


def psi_limit(n: float, alpha: float) -> float:
    """Return ``n/(2(n+1)) ((n-1)/n)**(1/alpha)``, the limit of max psi for small alpha.

    For large n, the paper's exp(-1/(n alpha)) has the same rate. The overlap Phi reaches n/(2(n+1)) against a force of
    1. The inner force f12 is (n-1)/n of that force.
    """
    return float(n / (2.0 * (n + 1.0)) * ((n - 1) / n) ** (1.0 / alpha))


def full_motion(
    chain: Chain,
    velocity: tuple[float, ...],
    duration: float | None = None,
    samples: Samples = SAMPLES,
    tolerance: float = TOLERANCE,
    step: float | None = None,
) -> Trajectory:
    """Solve the full equations, Eq. (3), for a figure.

    If `step` is given, use the conserving method, which prevents a drift of the energy. Problems of the simulation are
    reported as warnings.
    """
    found = _run(_figure_solver(tolerance, step), chain, velocity, duration, samples)
    _pass_on(found.warnings)
    return found


def model_motion(
    chain: Chain,
    velocity: tuple[float, ...],
    duration: float | None = None,
    samples: Samples = SAMPLES,
    tolerance: float = TOLERANCE,
    step: float | None = None,
) -> ModeCoupling:
    """Solve the mode-coupling model, Eqs. (8) and (A3), for a figure. The arguments are those of `full_motion`."""
    found = _model(_figure_solver(tolerance, step), chain, velocity, duration, samples)
    _pass_on(found.reduced.warnings)
    return found


def _figure_solver(tolerance: float, step: float | None) -> MethodFineness:
    return MethodFineness(TOLD if step is None else KEEPING, step, tolerance)


def _pass_on(found: Sequence[CodedWarning]) -> None:
    for warning in found:
        warnings.warn(str(warning), RuntimeWarning, stacklevel=3)


def soft_start(n: int, alpha: float) -> tuple[Chain, tuple[float, ...]]:
    """Return the homogeneous chain and the velocities with which its striker hits the other beads."""
    chain = soft_chain(n, alpha)
    return chain, start(chain)


def opening_time(n: int, alpha: float, contact: int = 0) -> float:
    """Return the time [s] at which `contact` first opens when one bead hits `n` beads."""
    return full_motion(*soft_start(n, alpha), samples=2).contact_intervals[contact][0][1]


def first_opening(found: Trajectory, contact: int = 0) -> float:
    """Return the time at which `contact` first opens.

    Raise NotSolvedError if the contact never closes or never opens again.
    """
    spans = found.contact_intervals[contact]
    if not spans or not np.isfinite(spans[0][1]):
        raise NotSolvedError(f"contact {contact} does not open")
    return spans[0][1]


def merged_times(*parts: Sequence[float] | Array) -> tuple[float, ...]:
    """Return the sample times of all `parts`, sorted and without duplicates."""
    return tuple(np.unique(np.concatenate([np.asarray(part, dtype=np.float64) for part in parts])).tolist())


def crest(time: Array, curve: Array) -> tuple[float, float]:
    """Return the time and the height of the maximum of `curve` (T,).

    The maximum is the vertex of a parabola through the largest sample and its two neighbours.
    """
    k = int(np.argmax(curve))
    a, b, c = np.polyfit(time[k - 1 : k + 2] - time[k], curve[k - 1 : k + 2], 2)
    return float(time[k] - 0.5 * b / a), float(c - 0.25 * b * b / a)


def by_load(cases: Sequence[Parameters], chain: Callable[[Parameters], Chain]) -> list[Parameters]:
    """Return the cases with a parameter "load", the largest load of an inner contact of their chains."""
    return [{**case, "load": float(loads(chain(case))[1:].max())} for case in cases]


def n_alpha(case: Parameters) -> float:
    """Return the product of n and alpha. Most claims are sorted by this number."""
    return case["n"] / case["1/alpha"]


def later(case: Parameters) -> Parameters:
    """Return the same case with 1/alpha multiplied by LATER."""
    return {**case, "1/alpha": LATER * case["1/alpha"]}


def local_rate(case: Parameters, low: float, high: float) -> float:
    """Return the slope of the logarithm of a quantity against 1/(n alpha).

    The quantity is `low` at the 1/alpha of the case, and `high` at LATER times this value.
    """
    return math.log(high / low) * case["n"] / ((LATER - 1.0) * case["1/alpha"])


def outcome(case: Parameters, solver: MethodFineness) -> Array:
    """Return the (n+1,) velocities after every contact has opened."""
    chain = chain_of(case)
    return solver.motion(chain, start(chain)).final_velocity


def spread(case: Parameters, solver: MethodFineness) -> float:
    """Return the difference between the largest and the smallest target velocity, divided by their mean.

    The velocities are taken after every contact has opened.
    """
    return float(rigidity(outcome(case, solver)[1:]))


def detachment(case: Parameters, solver: MethodFineness) -> float:
    """Return the time at which the contact of the striker first opens."""
    chain = chain_of(case)
    return first_opening(solver.motion(chain, start(chain)))


def while_struck(case: Parameters, solver: MethodFineness, samples: int, part: float = 1.0) -> Trajectory:
    """Return the motion from the first touch of the striker until one of the first two contacts opens.

    If `part` is below 1, return only this fraction of the motion.
    """
    chain = chain_of(case)
    whole = solver.motion(chain, start(chain))
    end = part * min(first_opening(whole, 0), first_opening(whole, 1))
    return solver.motion(chain, start(chain), end, samples)


def at_fractions(case: Parameters, solver: MethodFineness, fractions: tuple[float, ...]) -> Trajectory:
    """Return the motion at the given fractions of the striker's contact time."""
    chain, end = chain_of(case), detachment(case, solver)
    times = tuple(end * part for part in fractions)
    return solver.motion(chain, start(chain), times[-1], times)
