"""Benchmark of films: the processor time to draw and encode a frame, as in `python -m benchmarks render`."""

from __future__ import annotations

from benchmarks.render import measure


class Film:
    """Film of the scene one-on-four as mp4 with 1280x720 pixels, encoded in parallel segments."""

    timeout = 600
    unit = "ms"

    def track_frame(self) -> float:
        return float(measure("one-on-four", (1280, 720), rounds=3)["segments_ms"])
