"""The difference of two lanes: the second minus the first, bead by bead or contact by contact."""

from __future__ import annotations

import numpy as np
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.session.history_slices import history_slices, slice_at
from softcradle.sandbox.window.plots.live_plots import Plot


class DifferencePlot(Plot):
    """Curves of the second lane minus those of the first, where both have as many beads."""

    def samples(self, first: int, last: int) -> list[tuple[Array, Array]]:
        """See `Plot.samples`."""
        values = self.content.values
        slices = (history_slices(self.history, lane, *self.frames(first, last)) for lane in (0, 1))
        pairs = zip(*slices, strict=False)
        return [(a.time, values(b) - values(a)) for a, b in pairs if _comparable(a, b)]

    def values_at(self, frame: int) -> Array:
        """See `Plot.values_at`."""
        a, b = (slice_at(self.history, lane, frame) for lane in (0, 1))
        return (self.content.values(b) - self.content.values(a))[0] if _comparable(a, b) else np.zeros(0)


def _comparable(a: Motion, b: Motion) -> bool:
    """Whether two lanes have as many beads, at as many frames."""
    return a.overlap.shape == b.overlap.shape
