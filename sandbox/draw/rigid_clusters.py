"""What rigid clusters would do: the force that each contact inside a cluster would have, from those at its ends, Eq. (5)."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

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
