"""What rigid clusters would do: the share of the struck contact's force that each contact would have, Eq. (5)."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence


def rigid_shares(mass: Sequence[float], velocity: Sequence[float]) -> tuple[int, tuple[float, ...]]:
    """The contact at which two clusters meet, and the share of its force that each contact would have if both were rigid.

    The share is that of the cluster's mass beyond the contact, Eq. (5). All are 0 where no cluster has two beads, where
    no clusters meet, or where a bead is a wall.
    """
    closing = [left - right for left, right in itertools.pairwise(velocity)]
    meeting = closing.index(max(closing))
    clusters = mass[: meeting + 1], mass[meeting + 1 :]
    if max(closing) <= 0.0 or math.inf in mass or len(mass) == 2:
        return meeting, (0.0,) * len(closing)
    behind = [sum(mass[: i + 1]) / sum(clusters[0]) for i in range(meeting + 1)]
    return meeting, (*behind, *(sum(mass[i + 1 :]) / sum(clusters[1]) for i in range(meeting + 1, len(closing))))
