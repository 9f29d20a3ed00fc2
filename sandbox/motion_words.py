"""What has happened in words, to be read or spoken: who hit whom, how long it lasted, who goes where."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from softcradle.sandbox.languages import N_, _, localized, ngettext

if TYPE_CHECKING:
    from softcradle.physics import Trajectory

STILL = 0.01  # of the closing speed: a slower bead is said to stand still
ALIKE = 0.05  # of the closing speed: neighbours whose velocities differ by less go together
MOST_CLUSTERS = 6  # that are named one by one


def describe(label: str, trajectory: Trajectory) -> str:
    """Some sentences about a whole motion."""
    speeds = trajectory.velocity[0]
    scale = float(speeds.max() - speeds.min()) or float(abs(trajectory.final_velocity).max())
    sentences = [
        f"{label}:" if label else "",
        _hits(trajectory, scale),
        clusters_in_words(trajectory.final_velocity.tolist(), scale),
    ]
    if trajectory.status.gave_up:
        sentences.append(_("The method gave up there, so this is not the end."))
    return " ".join(sentence for sentence in sentences if sentence)


def _hits(trajectory: Trajectory, scale: float) -> str:
    """The first hit, and until when contacts were closed."""
    closings = [(intervals[0][0], k) for k, intervals in enumerate(trajectory.contact_intervals) if intervals]
    if not closings:
        return _("No contact closes until {time}.", time=seconds_in_words(trajectory.time[-1]))
    openings = [intervals[-1][1] for intervals in trajectory.contact_intervals if intervals]
    closed = sum(math.isinf(opening) for opening in openings)
    if closed:
        after = ngettext(
            "At {time} {n} of {all} contacts is closed.",
            "At {time} {n} of {all} contacts are closed.",
            closed,
            time=seconds_in_words(trajectory.time[-1]),
            all=trajectory.chain.contacts,
        )
    else:
        after = _("No contact is closed after {time}.", time=seconds_in_words(max(openings)))
    hits = [(time, -speed, k) for time, k in closings if (speed := _approach(trajectory, k, time)) > STILL * scale]
    if not hits:  # contacts that are pressed, or touch, close without one
        return after
    time, speed, contact = min(hits)  # of those at the same time, with which the others only begin to push, the fastest
    return f"{hit_in_words(contact, time, -speed)} {after}"


def _approach(trajectory: Trajectory, contact: int, time: float) -> float:
    """How fast the beads of a contact approached each other before `time` [m/s]."""
    row = max(int((trajectory.time <= time).sum()) - 1, 0)
    return float(trajectory.rate[row, contact])


def hit_in_words(contact: int, time: float, speed: float) -> str:
    """That the beads of a contact hit each other."""
    return _(
        "Bead {left} hit bead {right} at {time} with {speed}.",
        left=contact,
        right=contact + 1,
        time=seconds_in_words(time),
        speed=speed_in_words(speed),
    )


def clusters_in_words(velocities: Sequence[float], scale: float, brief: bool = False) -> str:
    """Neighbours that go together, and how fast; `scale` is the closing speed [m/s]. A `brief` speed is read, not spoken."""
    clusters: list[list[int]] = [[0]]
    for bead in range(1, len(velocities)):
        if _alike(velocities[bead], velocities[clusters[-1][0]], scale):
            clusters[-1].append(bead)
        else:
            clusters.append([bead])
    said = [_cluster(cluster, velocities, scale, brief) for cluster in clusters[:MOST_CLUSTERS]]
    rest = len(clusters) - MOST_CLUSTERS
    return " ".join([*said, *([ngettext("And {n} more group.", "And {n} more groups.", rest)] if rest > 0 else [])])


def _alike(one: float, other: float, scale: float) -> bool:
    """Whether two beads stay together: slow ones may differ by less than fast ones, for what they have gone tells them apart."""
    faster = max(abs(one), abs(other))
    return abs(one - other) < ALIKE * min(scale, 2.0 * faster) or faster < STILL * scale


def _cluster(cluster: list[int], velocities: Sequence[float], scale: float, brief: bool) -> str:
    mean = math.fsum(velocities[bead] for bead in cluster) / len(cluster)
    one, still = len(cluster) == 1, abs(mean) < STILL * scale
    between = N_("{first} and {last}") if len(cluster) == 2 else N_("{first} to {last}")
    beads = str(cluster[0]) if one else _(between, first=cluster[0], last=cluster[-1])
    if still:
        text = N_("Bead {beads} stands still.") if one else N_("Beads {beads} stand still.")
    elif mean > 0.0:
        text = (
            N_("Bead {beads} goes to the right at {speed}.")
            if one
            else N_("Beads {beads} go together to the right at {speed}.")
        )
    else:
        text = (
            N_("Bead {beads} goes to the left at {speed}.")
            if one
            else N_("Beads {beads} go together to the left at {speed}.")
        )
    speed = localized(f"{abs(mean):.2g} m/s") if brief else speed_in_words(abs(mean))
    return _(text, beads=beads, speed=speed)


def seconds_in_words(time: float) -> str:
    """A time [s] with its unit."""
    return ngettext("{value} second", "{value} seconds", _counted(time), value=number_in_words(time))


def speed_in_words(speed: float) -> str:
    """A speed [m/s] with its unit."""
    return ngettext("{value} metre a second", "{value} metres a second", _counted(speed), value=number_in_words(speed))


def _counted(value: float) -> int:
    """The number whose plural form a decimal number takes: 1 is singular, 1.5 only where 0 is (French), 2.5 as 2."""
    shown = float(f"{value:.3g}")
    return 0 if 1.0 < shown < 2.0 else int(shown)


def number_in_words(value: float) -> str:
    """Three digits, as people say them."""
    return localized(f"{value:.3g}")
