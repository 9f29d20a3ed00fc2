"""The paper's chains and their runs for figures and claims, each computed once: cases, solvers and shared quantities."""

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
Parameters = Mapping[str, float]  # parameters of a case by name: n, 1/alpha and others
Samples = int | tuple[float, ...]  # number of samples, or their times [s]

N = 4  # targets in Figs. 1 and 2
ALPHA = 1.0 / 10.0  # exponent in Figs. 1b, 1c and 2
SOFTER_ALPHA = 1.0 / 14.0  # exponent in Fig. 1d
OWN = {"n": 4.0, "1/alpha": 10.0}  # the same case as parameters
DRIVE = 1.0  # steady force on the first bead of a driven cluster, in units of f0
LATER = 1.25  # ratio of neighbouring 1/alpha for a local rate

SAMPLES = 1001  # samples of a figure
TOLERANCE = 1e-8  # tolerance of a figure
# Smallest swing that counts, in units of the striker's speed or of f0: a hundredth of the discrepancy in Fig. 2c.
SWING = 1e-5

# warnings of a run that determines nothing
INCOMPLETE = (WarningCode.GAVE_UP, WarningCode.UNCONVERGED, WarningCode.LOG_FULL)
KEPT_ENDS = 4096  # number of cached motions with their final state only
KEPT_MOTIONS = 64  # number of cached motions with samples; each takes up to some megabytes


class NotSolvedError(Exception):
    """A run gave up, so its measure is not determined."""


@dataclass(frozen=True)
class MethodFineness:
    """A method with its step (fixed-step methods) or tolerance (adaptive methods)."""

    method: str
    step: float | None = None
    tolerance: float = 1e-9

    def motion(
        self, chain: Chain, velocity: tuple[float, ...], duration: float | None = None, samples: Samples = 2
    ) -> Trajectory:
        """Solve the full equations, Eq. (3); raise NotSolvedError if the method gave up."""
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
        """Solve the mode-coupling model, Eqs. (8), (A3)."""
        return _model(self, chain, velocity, duration, samples)


MEASURING = MethodFineness(TOLD)
SECOND = MethodFineness(KEEPING, 1e-4)  # its error, of the order of the discrepancies shown, is the error bar
FINER_SECOND = MethodFineness(KEEPING, 1e-5)  # for differences of times and for small spreads
FINEST_SECOND = MethodFineness(KEEPING, 1e-6)  # for oscillations with a period of about 1e-4
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
    with (
        warnings.catch_warnings()
    ):  # error bars of claims show how far a motion is determined; figures pass warnings on
        warnings.simplefilter("ignore", RuntimeWarning)
        return mode_coupling(
            chain, velocity, duration, solver.method, solver.step, _argument(samples), solver.tolerance
        )


def _argument(samples: Samples) -> int | Array:
    return samples if isinstance(samples, int) else np.array(samples)


def soft_chain(n: int, alpha: float) -> Chain:
    """Return the homogeneous chain of one bead on `n` beads, with unit masses, unit strengths and one exponent."""
    return one_on(n, power_law(1.0, alpha))


def chain_of(case: Parameters) -> Chain:
    """Return the homogeneous chain of a case with n and 1/alpha."""
    return soft_chain(round(case["n"]), 1.0 / case["1/alpha"])


def start(chain: Chain, strikers: int = 1, speed: float = 1.0) -> tuple[float, ...]:
    """Return the initial velocities: `speed` for the strikers, 0 for all others."""
    return (speed,) * strikers + (0.0,) * (chain.contacts + 1 - strikers)


def driven_chain(n: int, alpha: float) -> Chain:
    """Return `n` unit beads that just touch, with the steady force on the first one, Sec. V.

    Its mode-coupling model has one overlap. For unit strength, ``psi'' = F/m1 - (1/m1 + 1/M) psi**alpha``; its energy
    gives amplitude and period.
    """
    return Chain([1.0] * n, power_law(1.0, alpha), drive=[DRIVE] + [0.0] * (n - 1))


def driven_amplitude(n: int, alpha: float) -> float:
    """Return the largest psi of the model of the driven cluster, ``((1 + alpha) F (n-1)/n)**(1/alpha)``."""
    return float(((1.0 + alpha) * DRIVE * (n - 1) / n) ** (1.0 / alpha))


def driven_period(n: int, alpha: float) -> float:
    """Return the period of the model of the driven cluster, ``sqrt(2 psi_max / F) B(1/(2 alpha), 1/2) / alpha``."""
    x = 0.5 / alpha
    beta = math.sqrt(math.pi) * math.exp(math.lgamma(x) - math.lgamma(x + 0.5))  # B(x, 1/2)
    return math.sqrt(2.0 * driven_amplitude(n, alpha) / DRIVE) * beta / alpha


STRIKER_CONTACT = power_law(1.0, 1.0 / 30.0)  # in front of a cluster under prestress
SPRING_PRESTRESS = 20.0  # force on springs, which stay compressed all the time


def pressed_cluster(n: int, inner: Contact, prestress: float) -> Chain:
    """Return a striker and `n` targets at rest whose ends are pressed together by the force `prestress`, of unit
    masses.

    Linear contacts under a prestress that they never lose act, about their rest, like springs that push and pull.
    """
    contacts = (STRIKER_CONTACT, *(inner,) * (n - 1))
    if not prestress:
        return one_on(n, contacts)
    gap = [0.0, *[-float(inner.overlap(prestress))] * (n - 1)]
    return Chain([1.0] * (n + 1), contacts, gap, [0.0, prestress, *[0.0] * (n - 2), -prestress])


def random_beads(random: np.random.Generator, targets: int, width: float) -> tuple[Array, Array]:
    """Return masses of one on `targets` and strengths of its contacts, from 1/width to width, uniform in their
    logarithm.
    """
    mass, strength = (width ** random.uniform(-1.0, 1.0, count) for count in (targets + 1, targets))
    return mass, strength


def power_laws(strength: Sequence[float] | Array, exponent: Sequence[float] | Array) -> list[Contact]:
    """Return soft contacts with these strengths and exponents."""
    return [Contact(0.0, f0, alpha) for f0, alpha in zip(strength, exponent, strict=True)]


def spread_by_mass(mass: Array, velocity: Array) -> float:
    """Return the mass-weighted root mean square deviation of the targets' velocities, relative to their mean."""
    mean = np.average(velocity, weights=mass)
    return float(np.sqrt(np.average((velocity - mean) ** 2, weights=mass)) / mean)


def psi_limit(n: float, alpha: float) -> float:
    """Return ``n/(2(n+1)) ((n-1)/n)**(1/alpha)``, the limit of max psi; the paper's exp(-1/(n alpha)) has the same rate
    for large n.

    The overlap Phi reaches n/(2(n+1)) against a force of 1, of which f12 is (n-1)/n.
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
    """Solve the full equations, Eq. (3), for a figure; with a `step`, use the conserving method, so that the energy
    does not drift.

    Faults of the run are warnings.
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
    """Solve the mode-coupling model, Eqs. (8), (A3), for a figure, like `full_motion`."""
    found = _model(_figure_solver(tolerance, step), chain, velocity, duration, samples)
    _pass_on(found.reduced.warnings)
    return found


def _figure_solver(tolerance: float, step: float | None) -> MethodFineness:
    return MethodFineness(TOLD if step is None else KEEPING, step, tolerance)


def _pass_on(found: Sequence[CodedWarning]) -> None:
    for warning in found:
        warnings.warn(str(warning), RuntimeWarning, stacklevel=3)


def soft_start(n: int, alpha: float) -> tuple[Chain, tuple[float, ...]]:
    """Return the homogeneous chain, and the velocities with which its striker hits the others."""
    chain = soft_chain(n, alpha)
    return chain, start(chain)


def opening_time(n: int, alpha: float, contact: int = 0) -> float:
    """Return the time [s] at which `contact` of one on `n` first opens."""
    return full_motion(*soft_start(n, alpha), samples=2).contact_intervals[contact][0][1]


def first_opening(found: Trajectory, contact: int = 0) -> float:
    """Return the time at which `contact` first opens; raise NotSolvedError if it never closes and opens again."""
    spans = found.contact_intervals[contact]
    if not spans or not np.isfinite(spans[0][1]):
        raise NotSolvedError(f"contact {contact} does not open")
    return spans[0][1]


def merged_times(*parts: Sequence[float] | Array) -> tuple[float, ...]:
    """Return the sample times of all `parts`, sorted, without repetition."""
    return tuple(np.unique(np.concatenate([np.asarray(part, dtype=np.float64) for part in parts])).tolist())


def crest(time: Array, curve: Array) -> tuple[float, float]:
    """Return time and height of the vertex of the parabola through the three samples around the largest of `curve`
    (T,).
    """
    k = int(np.argmax(curve))
    a, b, c = np.polyfit(time[k - 1 : k + 2] - time[k], curve[k - 1 : k + 2], 2)
    return float(time[k] - 0.5 * b / a), float(c - 0.25 * b * b / a)


def by_load(cases: Sequence[Parameters], chain: Callable[[Parameters], Chain]) -> list[Parameters]:
    """Return the cases with the largest load of an inner contact of their chains."""
    return [{**case, "load": float(loads(chain(case))[1:].max())} for case in cases]


def n_alpha(case: Parameters) -> float:
    """Return n times alpha, by which most claims are sorted."""
    return case["n"] / case["1/alpha"]


def later(case: Parameters) -> Parameters:
    """Return the same case at LATER times 1/alpha."""
    return {**case, "1/alpha": LATER * case["1/alpha"]}


def local_rate(case: Parameters, low: float, high: float) -> float:
    """Return the slope of the logarithm of a quantity against 1/(n alpha), from its values at 1/alpha and LATER times
    1/alpha.
    """
    return math.log(high / low) * case["n"] / ((LATER - 1.0) * case["1/alpha"])


def outcome(case: Parameters, solver: MethodFineness) -> Array:
    """Return the (n+1,) velocities after every contact has opened."""
    chain = chain_of(case)
    return solver.motion(chain, start(chain)).final_velocity


def spread(case: Parameters, solver: MethodFineness) -> float:
    """Return the largest minus the smallest target velocity, divided by their mean, after every contact has opened."""
    return float(rigidity(outcome(case, solver)[1:]))


def detachment(case: Parameters, solver: MethodFineness) -> float:
    """Return the time at which the striker's contact first opens."""
    chain = chain_of(case)
    return first_opening(solver.motion(chain, start(chain)))


def while_struck(case: Parameters, solver: MethodFineness, samples: int, part: float = 1.0) -> Trajectory:
    """Return the motion from the touch of the striker to the first opening of one of the first two contacts, or a part
    of it.
    """
    chain = chain_of(case)
    whole = solver.motion(chain, start(chain))
    end = part * min(first_opening(whole, 0), first_opening(whole, 1))
    return solver.motion(chain, start(chain), end, samples)


def at_fractions(case: Parameters, solver: MethodFineness, fractions: tuple[float, ...]) -> Trajectory:
    """Return the motion at these fractions of the striker's contact time."""
    chain, end = chain_of(case), detachment(case, solver)
    times = tuple(end * part for part in fractions)
    return solver.motion(chain, start(chain), times[-1], times)
