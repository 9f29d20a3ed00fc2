"""What has happened in words, to be read or spoken: who hit whom, how long it lasted, who goes where."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

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
        _hits(trajectory),
        clusters_in_words(trajectory.final_velocity.tolist(), scale),
    ]
    if trajectory.status.gave_up:
        sentences.append("The method gave up there, so this is not the end.")
    return " ".join(sentence for sentence in sentences if sentence)


def _hits(trajectory: Trajectory) -> str:
    """The first hit, and until when contacts were closed."""
    closings = [(intervals[0][0], k) for k, intervals in enumerate(trajectory.contact_intervals) if intervals]
    end = trajectory.time[-1]
    if not closings:
        return f"No contact closes until {number_in_words(end)} seconds."
    time, contact = min(closings)
    row = max(int((trajectory.time <= time).sum()) - 1, 0)
    said = f"{hit_in_words(contact, time, float(trajectory.rate[row, contact]))}"
    openings = [intervals[-1][1] for intervals in trajectory.contact_intervals if intervals]
    closed = sum(math.isinf(opening) for opening in openings)
    if closed:
        of = trajectory.chain.contacts
        return f"{said} At {number_in_words(end)} seconds {closed} of {of} contacts are closed."
    return f"{said} No contact is closed after {number_in_words(max(openings))} seconds."


def hit_in_words(contact: int, time: float, speed: float) -> str:
    """That the beads of a contact hit each other."""
    with_speed = f" with {number_in_words(speed)} metres a second" if speed > 0.0 else ""
    return f"Bead {contact} hit bead {contact + 1} at {number_in_words(time)} seconds{with_speed}."


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
    return " ".join(said) + (f" And {rest} more groups." if rest > 0 else "")


def _cluster(cluster: list[int], velocities: Sequence[float], scale: float) -> str:
    name = f"Bead {cluster[0]}" if len(cluster) == 1 else f"Beads {cluster[0]} to {cluster[-1]}"
    mean = math.fsum(velocities[bead] for bead in cluster) / len(cluster)
    verb = ("stands", "goes") if len(cluster) == 1 else ("stand", "go together")
    if abs(mean) < STILL * scale:
        return f"{name} {verb[0]} still."
    side = "right" if mean > 0.0 else "left"
    return f"{name} {verb[1]} to the {side} at {number_in_words(abs(mean))} metres a second."


def number_in_words(value: float) -> str:
    """Three digits, as people say them."""
    return f"{value:.3g}"
