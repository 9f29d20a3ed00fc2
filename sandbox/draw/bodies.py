"""Appearance of bodies, computed without drawing.

The module decides which contacts look like draft gears, how tall bodies are and which masses are written. The module
also computes the force that a contact would carry in a rigid cluster. A mark across the force bar shows this force.
"""

import itertools
import math
from collections.abc import Sequence

from softcradle.physics import Chain, Coupler
from softcradle.physics.chain import Joint
from softcradle.sandbox.languages import _
from softcradle.sandbox.story.bodies import HEAVY, is_gear
from softcradle.sandbox.story.numbers import plain

# Length of the cylinder of a draft gear, relative to the length of the gear. The rest of the length belongs to the
# piston.
CYLINDER_LENGTH = 0.80
CYLINDER_HEIGHT = 0.66  # Height of the cylinder of a draft gear, relative to the length of the gear.
WALL_HEIGHT = 1.2  # Height of a wall, relative to the length of a bead.
EQUAL_MASSES = (
    # Largest ratio between the largest and the smallest mass at which all beads look the same and their masses are not
    # written.
    1.02
)


def solid_force(joint: Joint, force: float) -> float:
    """Return the absolute force [N] above which the draft gear of a coupler is solid. Return infinity if the gear never
    becomes solid.

    The sign of `force` selects the gear. If `force` >= 0, it is the gear for pushing forces, otherwise the gear for
    pulling forces.
    """
    if not isinstance(joint, Coupler) or math.isinf(joint.travel):
        return math.inf
    gear = joint.push if force >= 0.0 else joint.pull
    return math.inf if gear is None else gear.force(joint.travel)


def body_height(chains: Sequence[Chain]) -> float:
    """Return the height of the tallest body of all `chains`, relative to the length of a bead. All lanes use this
    height to compute their common scale.
    """
    if any(chain.walls for chain in chains):
        return WALL_HEIGHT
    all_gears = all(is_gear(contact) for chain in chains for contact in chain.contact)
    return CYLINDER_HEIGHT if all_gears else 1.0


def locomotives(chain: Chain) -> tuple[bool, ...]:
    """Return a tuple (n+1,) that is True for each body of a train that is drawn as a locomotive.

    The heaviest bodies are locomotives. If all masses are equal, all bodies are drawn as wagons.
    """
    finite = [mass for mass in chain.mass if math.isfinite(mass)]
    differ = max(finite) > EQUAL_MASSES * min(finite)
    return tuple(differ and math.isfinite(mass) and mass * EQUAL_MASSES > max(finite) for mass in chain.mass)


def mass_labels(chain: Chain) -> tuple[str, ...]:
    """Return a label with the mass of each bead. Return an empty tuple if all masses are nearly equal."""
    finite = [mass for mass in chain.mass if math.isfinite(mass)]
    if max(finite) <= EQUAL_MASSES * min(finite):
        return ()
    unit, size = ("t", 1e3) if max(finite) >= HEAVY else ("kg", 1.0)
    return tuple(f"{plain(mass / size)} {unit}" if math.isfinite(mass) else _("wall") for mass in chain.mass)


# Largest difference between the velocities of neighbouring beads of one cluster. This limit is a fraction of the
# largest difference between velocities in the chain.
ALIKE = 1e-6
# Largest gap at which neighbouring beads count as touching, relative to the length of a bead. The gap need not be 0
# because positions are sums with rounding errors.
LEAST_GAP = 1e-9


def cluster_ends(overlap: Sequence[float], velocity: Sequence[float], length: float) -> tuple[bool, ...]:
    """Return a tuple (n,) that is True for each contact that separates two clusters before a collision.

    A contact separates two clusters if it is open, or if its two beads have different velocities.

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
    """Return True if a force bar can have a mark. A mark requires a cluster of at least two beads that another body can
    strike.
    """
    return len(ends) > 1 and any(ends) and not all(ends)


def rigid_forces(
    mass: Sequence[float], ends: Sequence[bool], overlap: Sequence[float], force: Sequence[float], length: float
) -> list[float]:
    """Return the (n,) force [N] that each contact would have if every cluster moved as one rigid body.

    Clusters are separated by the contacts that `ends` marks and by the contacts that are open now. The returned force
    is 0 at these contacts. The returned force is also 0 inside a cluster that contains a wall.

    All beads of a rigid cluster have the same acceleration. A contact inside the cluster therefore transmits a share of
    the force at each end of the cluster. The share is the mass beyond the contact divided by the mass of the cluster,
    Eq. (5). The shares of both ends are added.
    """
    apart = [end or d < -LEAST_GAP * length for end, d in zip(ends, overlap, strict=True)]
    found = [0.0] * len(force)
    first = 0
    # The beads from `first` to `last` form one cluster.
    for last in [*(i for i, end in enumerate(apart) if end), len(force)]:
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
    """Return the (n,) forces [N] at which a mark is drawn, or 0 for contacts without a mark. The forces come from
    :func:`rigid_forces`.

    A contact has a mark only if it carries more than `least` [N]. The bars of contacts behind the wave in a chain of
    steel balls are invisible. A mark on such a contact would look as if its bar were missing.
    """
    rigid = rigid_forces(mass, ends, overlap, force, length)
    return [
        expected if expected > least and abs(carried) > least else 0.0
        for expected, carried in zip(rigid, force, strict=True)
    ]
