"""End of a motion. The module decides whether contacts can still close. The module also decides how much is shown of a
motion with long pauses.

Tests: tests/sandbox/story/test_ending.py
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics.simulation import endless

if TYPE_CHECKING:
    from softcradle.physics import Chain, State, Trajectory

# Largest rate of change of an overlap that counts as a rounding error, as a fraction of the closing speed. Pages use
# the same number.
AT_REST = 1e-9
# Longest pause that is shown, as a multiple of the time seen before the pause.
PATIENCE = 100.0


def is_endless(chain: Chain, state: State) -> bool:
    """Return True if contacts may close again and again. Simulations without a duration use the same rule."""
    return bool(endless(chain, state.velocity(chain)))


def is_over(chain: Chain, state: State, speed: float) -> bool:
    """Return True if no contact can close any more.

    All contacts must be open, and no neighbouring beads may approach each other. On a friction bed, all beads must be
    at rest. `speed` is the closing speed [m/s].
    """
    if is_endless(chain, state) or state.time < max(chain.knots, default=0.0):
        return False
    if chain.on_bed:
        return not state.velocity(chain).any()
    return not state.closed.any() and bool((state.rate <= AT_REST * speed).all())


def quiet_end(trajectories: Sequence[Trajectory]) -> tuple[float, str]:
    """Return the end [s] of the shown motion and a sentence. The sentence is empty unless more motion follows after a
    long pause.

    `trajectories` are the lanes of a scene. A pause is long compared with the time seen before it. The time before a
    pause lasts from the start of the motion until the last contact opens. The time in which the closing speed crosses
    all gaps is added to it, because beads that are far apart need more time to meet.
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
    """Return the time [s] in which a bead with the initial closing speed would cross all gaps of a chain."""
    gaps = float(np.maximum(found.chain.gap, 0.0).sum())
    return gaps / (float(np.ptp(found.velocity[0])) or 1.0)
