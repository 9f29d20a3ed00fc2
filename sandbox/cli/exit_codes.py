"""The exit codes of the command beside 0."""

from __future__ import annotations

MISTAKE = 2  # what the user asked for cannot be done
GAVE_UP = 3  # a run gave up before its end: what was printed and written is not the whole motion
POINTS_LOST = 4  # a sweep is done, but at some of its points every process died
INTERRUPTED = 130
CLOSED_PIPE = 141
TERMINATED = 143
