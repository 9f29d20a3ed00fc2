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
TOGETHER_RIGHT = N_("Beads {first} to {last} go together to the right at {speed} metres a second.")
TOGETHER_LEFT = N_("Beads {first} to {last} go together to the left at {speed} metres a second.")


def describe(label: str, trajectory: Trajectory) -> str:
    """Some sentences about a whole motion."""
    speeds = trajectory.velocity[0]
    scale = float(speeds.max() - speeds.min()) or float(abs(trajectory.final_velocity).max())
    sentences = [
        f"{label}:" if label else "",
        _hits(trajectory),
        clusters_in_words(trajectory.final_velocity.tolist(), scale),
    ]
    if trajectory.status.gave_up:
        sentences.append(_("The method gave up there, so this is not the end."))
    return " ".join(sentence for sentence in sentences if sentence)


def _hits(trajectory: Trajectory) -> str:
    """The first hit, and until when contacts were closed."""
    closings = [(intervals[0][0], k) for k, intervals in enumerate(trajectory.contact_intervals) if intervals]
    end = trajectory.time[-1]
    if not closings:
        return _("No contact closes until {time} seconds.", time=number_in_words(end))
    time, contact = min(closings)
    row = max(int((trajectory.time <= time).sum()) - 1, 0)
    said = f"{hit_in_words(contact, time, float(trajectory.rate[row, contact]))}"
    openings = [intervals[-1][1] for intervals in trajectory.contact_intervals if intervals]
    closed = sum(math.isinf(opening) for opening in openings)
    if closed:
        return f"{said} " + ngettext(
            "At {time} seconds {n} of {all} contacts is closed.",
            "At {time} seconds {n} of {all} contacts are closed.",
            closed,
            time=number_in_words(end),
            all=trajectory.chain.contacts,
        )
    after = _("No contact is closed after {time} seconds.", time=number_in_words(max(openings)))
    return f"{said} {after}"


def hit_in_words(contact: int, time: float, speed: float) -> str:
    """That the beads of a contact hit each other."""
    values = {"left": contact, "right": contact + 1, "time": number_in_words(time)}
    if speed <= 0.0:
        return _("Bead {left} hit bead {right} at {time} seconds.", **values)
    with_speed = N_("Bead {left} hit bead {right} at {time} seconds with {speed} metres a second.")
    return _(with_speed, **values, speed=number_in_words(speed))


def clusters_in_words(velocities: Sequence[float], scale: float) -> str:
    """Neighbours that go together, and how fast; `scale` is the closing speed [m/s]."""
    clusters: list[list[int]] = [[0]]
    for bead in range(1, len(velocities)):
        if abs(velocities[bead] - velocities[clusters[-1][0]]) < ALIKE * scale:
            clusters[-1].append(bead)
        else:
            clusters.append([bead])
    said = [_cluster(cluster, velocities, scale) for cluster in clusters[:MOST_CLUSTERS]]
    rest = len(clusters) - MOST_CLUSTERS
    return " ".join([*said, *([ngettext("And {n} more group.", "And {n} more groups.", rest)] if rest > 0 else [])])


def _cluster(cluster: list[int], velocities: Sequence[float], scale: float) -> str:
    mean = math.fsum(velocities[bead] for bead in cluster) / len(cluster)
    one = len(cluster) == 1
    if abs(mean) < STILL * scale:
        text = N_("Bead {first} stands still.") if one else N_("Beads {first} to {last} stand still.")
    elif mean > 0.0:
        text = N_("Bead {first} goes to the right at {speed} metres a second.") if one else TOGETHER_RIGHT
    else:
        text = N_("Bead {first} goes to the left at {speed} metres a second.") if one else TOGETHER_LEFT
    return _(text, first=cluster[0], last=cluster[-1], speed=number_in_words(abs(mean)))


def number_in_words(value: float) -> str:
    """Three digits, as people say them."""
    return localized(f"{value:.3g}")
