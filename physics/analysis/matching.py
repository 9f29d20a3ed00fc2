"""Matching of contact laws. For a given draft gear, find the power law that acts most similarly in one collision. For a
given power law, find the most similar draft gear.

The paper states: "The above form of f(delta) resembles the power-law form, f0 delta^alpha, with alpha << 1" (Appendix
C). The best f0 and alpha depend on the collision and on the measure of distance. Two distances can be minimised:

    force     sqrt(integral (f - g)^2 dt / integral f^2 dt) over the force of the struck contact, from the first touch
              until both collisions are over
    outcome   sqrt(mean ((v_i - w_i) / V)^2 + ln(T / S)^2) over the final velocities of all beads, V the closing speed
              at the start, and the contact times T, S of the struck contact

The quantities f, v, T belong to the given contact, and g, w, S to the other contact. All contacts of the chain are
replaced. If both clusters move as rigid bodies, the outcome is nearly the same for all small alpha, but the force is
not. Below its critical speed, a draft gear moves the clusters as rigid bodies for any parameters. The outcome is then
constant, and a search that starts below the critical speed does not move. Therefore the search starts from several
contacts, with different V/v_c or alpha. Each of them keeps two rigid bodies in contact for a given time T:

    draft gear   T = (2/w) atan(x), x = V/(w D) = (V/v_c) sqrt(1/r^2 - 1)
    power law    Contact.by_contact_time
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import optimize
from softcradle.physics.analysis.closed_forms import rigid_masses, rigid_stroke, speed_ratio
from softcradle.physics.analysis.collision import struck_contact
from softcradle.physics.chain import Chain, mass_shares
from softcradle.physics.contact import Contact, draft_gear, power_law
from softcradle.physics.simulation import solve

Array = NDArray[np.float64]
Family = Literal["power_law", "draft_gear"]
Distance = Literal["force", "outcome"]

NEAR = 0.1  # Largest distance of contacts that count as similar. The force curves of such contacts differ by 10 %.
ALPHAS = (1.0 / 50.0, 3.0)  # Range of the exponents in the search.
# Range of the precompressions in the search, as a multiple of the largest overlap of the given contact.
PRECOMPRESSIONS = 1e-4, 1e4
FORCES = (1e-3, 1e3)  # Range of the forces in the search, as a multiple of the first guess.
LOGARITHM_TOLERANCE = 1e-5  # Change of the logarithms of both parameters below which the search ends.
AT_END = 1e-3  # Distance of a logarithm from the end of its range below which the parameter counts as lying at the end.
# Sizes of the initial simplex in the logarithms of the parameters. The search restarts with each size until the result
# no longer changes.
SIMPLEX_SIZES = (0.3, 0.1, 0.03)
MOST_COLLISIONS = 150  # Largest number of collisions in one local search. A search with two parameters needs about 60.
# Number of local searches, each from one of the nearest starts. The outcome has several local minima, the force has
# one.
DESCENTS = {"force": 1, "outcome": 3}
# Tolerance of the simulated collisions, far below any distance of interest. With a smaller tolerance, very soft chains
# would need thousands of steps.
TOLERANCE = 1e-6
FAR = 1e3  # Distance assigned to a contact whose collision cannot be simulated.
# Sample times as fractions of the contact time. The times are dense near both ends of the contact, because forces jump
# at the ends. The ends themselves are left out, because the force has two values there.
GRADED = np.clip(0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 801)), 1e-9, 1.0 - 1e-9)

RATIOS = tuple(np.geomspace(0.3, 30.0, 33).tolist())  # Ratios V/v_c of the draft gears from which a search starts.
EXPONENTS = tuple(np.geomspace(0.025, 2.5, 17).tolist())  # Exponents of the power laws from which a search starts.


@dataclass(frozen=True)
class Match:
    """Nearest contact of a family, and its distance.

    Attributes
    ----------
    given, contact : Contact
        The given contact, and the nearest contact of the other family.
    distance : str
        Name of the distance that was minimised.
    residual : float
        Smallest distance found. The distance is 0.1 for force curves whose root mean square difference is 10 %.
    near : bool
        True if the residual is at most 0.1.
    outcome : float
        Difference of final velocities and contact time. This value is computed for any `distance`, because similar
        forces do not imply similar outcomes.
    speed_ratio : float or None
        Ratio V/v_c of the closing speed to the critical speed of the draft gear. Below 1 the clusters stay exactly
        rigid.
    ends : tuple of str
        Parameters that lie at an end of their search range. A nearer contact may exist beyond the range.
    evaluations : int
        Number of collisions computed.
    """

    given: Contact
    contact: Contact
    distance: Distance
    residual: float
    near: bool
    outcome: float
    speed_ratio: float | None
    ends: tuple[str, ...]
    evaluations: int


def match(
    chain: Chain,
    velocity: ArrayLike,
    distance: Distance = "force",
    family: Family | None = None,
    start: Contact | None = None,
    progress: Callable[[int], None] | None = None,
) -> Match:
    """Find the contact of `family` nearest to the contact of `chain`, in the collision that `velocity` starts.

    Parameters
    ----------
    chain : Chain
        Chain of equal contacts. The contact law must be a power law (preload 0) or a draft gear (exponent 1).
    velocity : array_like
        (n+1,) initial velocities [m/s].
    distance : {"force", "outcome"}
        Distance to minimise.
    family : {"power_law", "draft_gear"}, optional
        Family to search. None means the family to which the given contact does not belong.
    start : Contact, optional
        First contact of the search. None means the contact with the same force as the given one at half and at full
        depth.
    progress : callable, optional
        Function that is called after each simulated collision, with the number of collisions so far.

    Returns
    -------
    Match
        The nearest contact and its distance.

    Raises
    ------
    ValueError
        If the contacts differ or belong to neither family, if nothing collides, or if the chain has a drive or two
        walls.

    >>> from softcradle import hooke, one_on
    >>> match(one_on(1, hooke(4.0)), [1.0, 0.0], family="power_law").contact.exponent.__round__(4)
    1.0
    """
    given = only_contact(chain)
    if distance not in DESCENTS:
        raise ValueError(f"unknown distance {distance!r}; there are {', '.join(DESCENTS)}")
    speeds = np.asarray(velocity, dtype=np.float64)
    struck = struck_contact(speeds)
    sought: Family = family or ("power_law" if given.preload > 0.0 else "draft_gear")
    closing = float(speeds[struck] - speeds[struck + 1])
    depth, time, _ = rigid_stroke(given, chain.mass, struck + 1, closing)
    guess = start or _first_guess(given, sought, depth)
    by_outcome = outcome_distance(chain, speeds, struck)
    apart = force_distance(chain, speeds, struck) if distance == "force" else by_outcome
    starts_of = laws_of_all_exponents if sought == "power_law" else gears_of_all_speeds
    starts = [guess, *starts_of(chain, struck, closing, time)]
    place, residual, ends, evaluations = _search(sought, starts, depth, apart, DESCENTS[distance], progress)
    gear = given if sought == "power_law" else place
    ratio = speed_ratio(_with(chain, gear), struck, closing)
    return Match(given, place, distance, residual, residual <= NEAR, by_outcome(place), ratio, ends, evaluations)


def _search(
    family: Family,
    starts: Sequence[Contact],
    depth: float,
    apart: Callable[[Contact], float],
    descents: int,
    progress: Callable[[int], None] | None,
) -> tuple[Contact, float, tuple[str, ...], int]:
    """Search for the nearest contact, starting from several contacts.

    Return the nearest contact, its distance, the parameters at an end of their range, and the number of collisions.
    Compute the distance of all `starts` first. Then run the Nelder-Mead method from the nearest starts, in the
    logarithms of both parameters.
    """
    low, high = np.log(_ranges(family, starts[0], depth)).T
    evaluations = 0

    def objective(logarithms: Array) -> float:
        nonlocal evaluations
        evaluations += 1
        found = apart(_contact(family, np.exp(np.clip(logarithms, low, high)), depth))
        if progress is not None:
            progress(evaluations)
        return found if math.isfinite(found) else FAR

    places = [np.clip(np.log(_numbers(start, family, depth)), low, high) for start in starts]
    order = np.argsort([objective(place) for place in places], kind="stable")
    ends_of_search = [_descend(objective, places[k], low, high) for k in order[:descents]]
    place, least = min(ends_of_search, key=lambda found: found[1])
    names = ("f0", "alpha") if family == "power_law" else ("stiffness", "precompression")
    ends = tuple(n for n, x, a, b in zip(names, place, low, high, strict=True) if min(x - a, b - x) < AT_END)
    return _contact(family, np.exp(place), depth), least, ends, evaluations


def _descend(objective: Callable[[Array], float], place: Array, low: Array, high: Array) -> tuple[Array, float]:
    """Return the parameters of a local minimum of `objective` near `place`, and the value of `objective` there.

    The Nelder-Mead method is restarted until the result no longer changes.
    """
    least = math.inf
    for size in SIMPLEX_SIZES:
        found = optimize.minimize(
            objective,
            place,
            method="Nelder-Mead",
            bounds=list(zip(low, high, strict=True)),
            options={
                # The simplex is reversed at the upper end of the range.
                "initial_simplex": place + size * np.eye(3, 2, -1),
                "xatol": LOGARITHM_TOLERANCE,
                "fatol": 1e-9,
                "maxfev": MOST_COLLISIONS,
            },
        )
        unchanged = least - found.fun < 1e-4 * found.fun + 1e-7
        place, least = (found.x, float(found.fun)) if found.fun < least else (place, least)
        if unchanged:
            break
    return place, least


def only_contact(chain: Chain) -> Contact:
    """Return the common contact law of `chain`. Raise ValueError as in :func:`match` if the contacts cannot be matched."""
    given = chain.power_laws[0]
    if any(contact != given for contact in chain.power_laws):
        raise ValueError("matching needs a chain whose contacts are all alike")
    if not (given.preload == 0.0 or (given.exponent == 1.0 and given.stiffness > 0.0)):
        raise ValueError("matching is between power laws (preload 0) and draft gears (exponent 1)")
    if chain.dissipative:
        raise ValueError("matching needs elastic contacts and a bed without friction")
    if chain.walls > 1 or chain.driven:
        raise ValueError("matching needs a collision that ends: no drive and no second wall")
    return given


def _first_guess(given: Contact, family: Family, depth: float) -> Contact:
    """Return the contact of `family` that has the same force as `given` at half of `depth` and at `depth`."""
    half, full = (float(given.force(part * depth)) for part in (0.5, 1.0))
    if family == "power_law":
        alpha = min(max(math.log2(full / half), 2.0 * ALPHAS[0]), ALPHAS[1])
        return power_law(full / depth**alpha, alpha)
    stiffness = max((full - half) / (0.5 * depth), 1e-3 * full / depth)
    return draft_gear(stiffness, max(full / stiffness - depth, 1e-2 * depth))


def _numbers(contact: Contact, family: Family, depth: float) -> tuple[float, float]:
    """Return the two search parameters of a contact.

    The first is the force at half of `depth`. The second is alpha or the precompression. The first parameter hardly
    depends on the second one. With f0 or the stiffness as a parameter, the minimum would lie in a narrow valley.
    """
    force = float(contact.force(0.5 * depth))
    return force, contact.exponent if family == "power_law" else contact.preload / contact.stiffness


def _contact(family: Family, numbers: Array, depth: float) -> Contact:
    """Return the contact with the given search parameters, see :func:`_numbers`."""
    force, second = numbers.tolist()
    if family == "power_law":
        return power_law(force / (0.5 * depth) ** second, second)
    return draft_gear(force / (second + 0.5 * depth), second)


def _ranges(family: Family, guess: Contact, depth: float) -> Array:
    """Return the lower and upper limits (2, 2) of the two search parameters, see :func:`_numbers`."""
    force = float(guess.force(0.5 * depth))
    second = ALPHAS if family == "power_law" else tuple(depth * factor for factor in PRECOMPRESSIONS)
    return np.array([[force * factor for factor in FORCES], second])


def _with(chain: Chain, contact: Contact) -> Chain:
    return replace(chain, contact=(contact,) * chain.contacts)


def force_distance(chain: Chain, velocity: Array, struck: int) -> Callable[[Contact], float]:
    """Return a function that maps a contact law to its distance from the law of `chain`.

    The distance compares the forces of contact `struck` in the collision.
    """

    def curve(contact: Contact) -> tuple[Array, Array]:
        """Return the force of the struck contact from its first touch to its last opening.

        Also return the times, counted from the first touch.
        """
        candidate = _with(chain, contact)
        spans = solve(candidate, velocity, samples=2, tolerance=TOLERANCE).contact_intervals[struck]
        touched, opened = spans[0][0], spans[-1][1]
        time = touched + (opened - touched) * GRADED
        return time - touched, solve(candidate, velocity, opened, samples=time, tolerance=TOLERANCE).force[:, struck]

    given = curve(chain.power_laws[0])
    whole = np.trapezoid(given[1] ** 2, given[0])
    return lambda contact: math.sqrt(squared_difference(*given, *curve(contact)) / whole)


def squared_difference(time: Array, curve: Array, other_time: Array, other: Array) -> float:
    """Integrate (f - g)^2 of two sampled curves f and g over time, starting at 0.

    The curves are sampled at times (T,) and (S,). Each curve is 0 after its last time.

    >>> one = np.ones(2)
    >>> squared_difference(np.array([0.0, 2.0]), one, np.array([0.0, 3.0]), 2.0 * one)
    6.0
    """
    first = min(time[-1], other_time[-1])
    both = np.unique(np.concatenate((time[time <= first], other_time[other_time <= first])))
    off = np.interp(both, time, curve) - np.interp(both, other_time, other)
    total = float(np.trapezoid(off**2, both))
    for times, values in ((time, curve), (other_time, other)):
        rest = np.concatenate(([first], times[times > first]))
        total += float(np.trapezoid(np.interp(rest, times, values) ** 2, rest))
    return total


def outcome_distance(chain: Chain, velocity: Array, struck: int) -> Callable[[Contact], float]:
    """Return a function that maps a contact law to its distance from the law of `chain`.

    The distance compares final velocities and the contact time of contact `struck`.
    """
    closing = float(velocity[struck] - velocity[struck + 1])

    def outcome(contact: Contact) -> tuple[Array, float]:
        found = solve(_with(chain, contact), velocity, samples=2, tolerance=TOLERANCE)
        closed = sum(opened - touched for touched, opened in found.contact_intervals[struck])
        return found.final_velocity / closing, math.log(closed)

    speeds, logarithm = outcome(chain.power_laws[0])

    def apart(contact: Contact) -> float:
        others, other = outcome(contact)
        return math.sqrt(float(np.mean((others - speeds) ** 2)) + (other - logarithm) ** 2)

    return apart


def gears_of_all_speeds(chain: Chain, struck: int, speed: float, time: float) -> list[Contact]:
    """Return one draft gear for each V/v_c in RATIOS. Between rigid bodies, each has the contact time `time` [s].

    The result is empty for one bead on one bead.
    """
    first, second = rigid_masses(chain.mass, struck + 1)
    carried = float(np.delete(mass_shares(chain.mass, struck), struck).max(initial=0.0))
    if not 0.0 < carried < 1.0:
        return []
    found = []
    for ratio in RATIOS:
        x = ratio * math.sqrt(1.0 / carried**2 - 1.0)
        frequency = 2.0 * math.atan(x) / time
        found.append(draft_gear(frequency**2 / (1.0 / first + 1.0 / second), speed / (frequency * x)))
    return found


def laws_of_all_exponents(chain: Chain, struck: int, speed: float, time: float) -> list[Contact]:
    """Return one power law for each exponent in EXPONENTS. Between rigid bodies, each has the contact time `time` [s]."""
    first, second = rigid_masses(chain.mass, struck + 1)
    reduced = 1.0 / (1.0 / first + 1.0 / second)
    return [Contact.by_contact_time(time, reduced, speed, exponent) for exponent in EXPONENTS]
