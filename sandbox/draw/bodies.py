"""What bodies look like, without drawing them: which contacts are gears, how tall bodies are, which masses are written."""

import itertools
import math
from collections.abc import Sequence

from softcradle.physics import Chain, Contact, Coupler
from softcradle.physics.chain import Joint
from softcradle.sandbox.draw.number_format import plain
from softcradle.sandbox.languages import _

CYLINDER_LENGTH = 0.80  # of a draft gear's length; the rest is its piston
CYLINDER_HEIGHT = 0.66  # of a draft gear's length
WALL_HEIGHT = 1.2  # of a bead's length
HEAVY = 1e4  # [kg] masses from here on are written in tonnes
EQUAL_MASSES = 1.02  # ratio of masses up to which beads look alike and no masses are written


def is_gear(joint: Joint) -> bool:
    """Whether the contact is drawn as a piston: a preloaded spring, in a coupler or by itself."""
    contact = joint.push if isinstance(joint, Coupler) else joint
    return isinstance(contact, Contact) and contact.preload > 0.0 and contact.stiffness > 0.0


def solid_force(joint: Joint, force: float) -> float:
    """Size of the force [N] from which on the gear of a coupler that pushes, or pulls with `force` < 0, is solid; inf: never."""
    if not isinstance(joint, Coupler) or math.isinf(joint.travel):
        return math.inf
    gear = joint.push if force >= 0.0 else joint.pull
    return math.inf if gear is None else gear.force(joint.travel)


def body_height(chains: Sequence[Chain]) -> float:
    """Height of the tallest body in lengths of a bead; that of all lanes, so that they have one scale."""
    if any(chain.walls for chain in chains):
        return WALL_HEIGHT
    all_gears = all(is_gear(contact) for chain in chains for contact in chain.contact)
    return CYLINDER_HEIGHT if all_gears else 1.0


def mass_labels(chain: Chain) -> tuple[str, ...]:
    """A label for each bead where masses differ visibly, else none."""
    finite = [mass for mass in chain.mass if math.isfinite(mass)]
    if max(finite) <= EQUAL_MASSES * min(finite):
        return ()
    unit, size = ("t", 1e3) if max(finite) >= HEAVY else ("kg", 1.0)
    return tuple(f"{plain(mass / size)} {unit}" if math.isfinite(mass) else _("wall") for mass in chain.mass)


ALIKE = 1e-6  # of the greatest difference of velocities: neighbours that differ by less go together
LEAST_GAP = 1e-9  # of a bead's length: neighbours that are nearer touch, for places are sums that round


def cluster_ends(overlap: Sequence[float], velocity: Sequence[float], length: float) -> tuple[bool, ...]:
    """(n,) whether a cluster ends at each contact, before a collision: it is open, or its beads have other velocities.

    Arguments:
        overlap: (n,) [m].
        velocity: (n+1,) [m/s].
        length: of a bead [m].
    """
    differences = [abs(left - right) for left, right in itertools.pairwise(velocity)]
    most = ALIKE * max(differences)
    return tuple(
        d < -LEAST_GAP * length or difference > most for d, difference in zip(overlap, differences, strict=True)
    )


def has_marks(ends: Sequence[bool]) -> bool:
    """Whether there can be marks: a cluster of two beads, and a contact at which it is struck."""
    return len(ends) > 1 and any(ends) and not all(ends)


def rigid_forces(
    mass: Sequence[float], ends: Sequence[bool], overlap: Sequence[float], force: Sequence[float], length: float
) -> list[float]:
    """(n,) the force [N] that each contact would have if every cluster were rigid; 0 where clusters end, and beside walls.

    A cluster ends at its `ends` and at a contact that is open by now. It moves with one acceleration, so the force at one of
    its ends is carried on by the share of its mass beyond the contact, Eq. (5); those of both ends add up.
    """
    apart = [end or d < -LEAST_GAP * length for end, d in zip(ends, overlap, strict=True)]
    found = [0.0] * len(force)
    first = 0
    for last in [*(i for i, end in enumerate(apart) if end), len(force)]:  # beads first to last are one cluster
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
    """Return the forces of :func:`rigid_forces` (n,) that are marked, and 0 for the other contacts.

    Marks are drawn over contacts that carry more than `least` [N]. A mark over a contact that carries nothing, as behind the wave
    in a row of steel balls, would look like a missing bar.
    """
    rigid = rigid_forces(mass, ends, overlap, force, length)
    return [
        expected if expected > least and abs(carried) > least else 0.0
        for expected, carried in zip(rigid, force, strict=True)
    ]
