"""The quiet end of a motion: where contacts have opened for so long that no film can wait for the next to close.

A run without a duration goes on until no contact can close again. Remnants of a collision may approach each other a million
times slower than the beads that collided, by round-off or the chatter of an explicit method, and meet after years.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from softcradle.physics import Trajectory
from softcradle.physics.scales import closing_speed

PATIENCE = 100.0  # times what has been seen so far: a longer pause is the end of what a film shows


def quiet_end(trajectories: Sequence[Trajectory]) -> tuple[float, str]:
    """When `trajectories`, the lanes of a scene, are over [s], and a sentence where more would follow after a long pause.

    What has been seen so far lasts from the start to the last opening, the flight over all gaps at the closing speed included:
    beads that are far apart have all the time that they need.
    """
    end = max(float(found.time[-1]) for found in trajectories)
    spans = sorted(span for found in trajectories for spans in found.contact_intervals for span in spans)
    flight = max(_flight_time(found) for found in trajectories)
    until = spans[0][0] if spans else end
    for closed, opened in [*spans, (end, end)]:
        if closed > PATIENCE * (until + flight) and until > 0.0:
            sentence = (
                f"the motion is shown up to t = {until:.4g} s, when its last contact has opened for long: slow beads would meet "
                f"again at t = {closed:.3g} s; give the scene a duration to see more, or less"
            )
            return until, sentence
        until = max(until, min(opened, end))
    return end, ""


def _flight_time(found: Trajectory) -> float:
    """Time [s] in which the closing speed of the start crosses all gaps of a chain."""
    gaps = float(np.maximum(found.chain.gap, 0.0).sum())
    return gaps / closing_speed(found.velocity[0])
