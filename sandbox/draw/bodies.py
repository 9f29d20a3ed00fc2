"""Appearance of bodies, computed without drawing.

The module decides which contacts look like draft gears, how tall bodies are and which masses are written. It also
computes the force of a rigid cluster, which a mark across a force bar shows.
"""

import itertools
import math
from collections.abc import Sequence

from softcradle.physics import Chain, Coupler
from softcradle.physics.chain import Joint
from softcradle.sandbox.languages import _
from softcradle.sandbox.story.bodies import HEAVY, is_gear
from softcradle.sandbox.story.numbers import plain

CYLINDER_LENGTH = 0.80  # Length of the cylinder, relative to the length of the draft gear. The piston takes the rest.
CYLINDER_HEIGHT = 0.66  # Height of the cylinder, relative to the length of the draft gear.
WALL_HEIGHT = 1.2  # Height of a wall, relative to the length of a bead.
EQUAL_MASSES = (
    1.02  # Ratio of the largest to the smallest mass up to which beads look the same and their masses are not written.
)


def solid_force(joint: Joint, force: float) -> float:
    """Return the absolute force [N] above which the draft gear of a coupler is solid; infinity if it never is.

    The sign of `force` selects the gear: the gear that pushes for `force` >= 0, the gear that pulls for `force` < 0.
    """
    if not isinstance(joint, Coupler) or math.isinf(joint.travel):
        return math.inf
    gear = joint.push if force >= 0.0 else joint.pull
    return math.inf if gear is None else gear.force(joint.travel)


def body_height(chains: Sequence[Chain]) -> float:
    """Return the height of the tallest body of all `chains`, relative to the length of a bead. All lanes use it for
    their common scale.
    """
    if any(chain.walls for chain in chains):
        return WALL_HEIGHT
    all_gears = all(is_gear(contact) for chain in chains for contact in chain.contact)
    return CYLINDER_HEIGHT if all_gears else 1.0


def locomotives(chain: Chain) -> tuple[bool, ...]:
    """Return (n+1,) True for each body of a train that is drawn as a locomotive: the heaviest ones, if masses differ."""
    finite = [mass for mass in chain.mass if math.isfinite(mass)]
    differ = max(finite) > EQUAL_MASSES * min(finite)
    return tuple(differ and math.isfinite(mass) and mass * EQUAL_MASSES > max(finite) for mass in chain.mass)


def mass_labels(chain: Chain) -> tuple[str, ...]:
    """Return a label with the mass for each bead, or an empty tuple if all masses look the same."""
    finite = [mass for mass in chain.mass if math.isfinite(mass)]
    if max(finite) <= EQUAL_MASSES * min(finite):
        return ()
    unit, size = ("t", 1e3) if max(finite) >= HEAVY else ("kg", 1.0)
    return tuple(f"{plain(mass / size)} {unit}" if math.isfinite(mass) else _("wall") for mass in chain.mass)


# Two neighbours belong to one cluster if their velocities differ by less than this fraction of the largest difference
# in the chain.
ALIKE = 1e-6
# Gap, relative to the length of a bead, below which neighbours count as touching. Positions are sums, so they have
# rounding errors.
LEAST_GAP = 1e-9


def cluster_ends(overlap: Sequence[float], velocity: Sequence[float], length: float) -> tuple[bool, ...]:
    """Return (n,) True for each contact that separates two clusters before a collision.

    A contact separates clusters if it is open, or if its two beads have different velocities.

    Arguments:
        overlap: (n,) overlaps [m].
        velocity: (n+1,) velocities [m/s].
        length: length of a bead [m].
    """
    differences = [abs(left - right) for left, right in itertools.pairwise(velocity)]
    most = ALIKE * max(differences)
    return tuple(
        d < -LEAST_GAP * length or difference > most for d, difference in zip(overlap, differences, strict=True)
    )


def has_marks(ends: Sequence[bool]) -> bool:
    """Return True if a bar can have a mark, that is if a cluster has two or more beads and a contact at which it is
    struck.
    """
    return len(ends) > 1 and any(ends) and not all(ends)


def rigid_forces(
    mass: Sequence[float], ends: Sequence[bool], overlap: Sequence[float], force: Sequence[float], length: float
) -> list[float]:
    """Return the (n,) force [N] that each contact would have if every cluster moved as one rigid body.

    A cluster ends at the contacts marked in `ends` and at contacts that are open now. The force is 0 at these contacts
    and inside a cluster with a wall.

    A rigid cluster has one acceleration. A contact inside it therefore transmits a share of the force at each end of
    the cluster. The share is the fraction of the mass of the cluster beyond the contact, Eq. (5). The shares from the
    two ends add up.
    """
    apart = [end or d < -LEAST_GAP * length for end, d in zip(ends, overlap, strict=True)]
    found = [0.0] * len(force)
    first = 0
    for last in [*(i for i, end in enumerate(apart) if end), len(force)]:  # Beads `first` to `last` form one cluster.
        whole = sum(mass[first : last + 1])
        left = force[first - 1] if first > 0 else 0.0
        right = force[last] if last < len(force) else 0.0
        for i in range(first, last) if math.isfinite(whole) else ():
            beyond = sum(mass[i + 1 : last + 1]) / whole
            found[i] = left * beyond + right * (1.0 - beyond)
        first = last + 1
    return found


def visible_marks(
    mass: Sequence[float],
    ends: Sequence[bool],
    overlap: Sequence[float],
    force: Sequence[float],
    length: float,
    least: float,
) -> list[float]:
    """Return the (n,) forces [N] at which a mark is drawn, from :func:`rigid_forces`; 0 for contacts without a mark.

    A contact has a mark only if it carries more than `least` [N]. Without a bar, as behind the wave in a row of steel
    balls, the mark would look like a missing bar.
    """
    rigid = rigid_forces(mass, ends, overlap, force, length)
    return [
        expected if expected > least and abs(carried) > least else 0.0
        for expected, carried in zip(rigid, force, strict=True)
    ]
