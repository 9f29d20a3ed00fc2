"""The main loop: frames while something moves, waiting for events while nothing does, and a proper end at a signal."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

import pygame
from softcradle.sandbox.window.window_page import Window

FRAMES_A_SECOND = 60
LONGEST_FRAME = 0.25  # seconds of wall time: a window that was suspended does not catch up
LONGEST_WAIT = 500  # milliseconds: results of the thread behind the window are taken no later
SETTLED = 1.5  # seconds after the last event, for tooltips and buttons, until frames end
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")  # each is there on some systems only


def run(app: Window) -> None:
    """Frames until the user quits; films and sounds are closed whatever ends the loop."""
    clock = pygame.time.Clock()
    seconds = 1.0 / FRAMES_A_SECOND
    with _ending_at_signals(app):
        try:
            while app.running:
                events = _wait() if app.still else None
                if events is None or events or not app.still:
                    app.frame(seconds, events)
                else:
                    app.pass_time(LONGEST_WAIT / 1000.0)
                seconds = min(clock.tick(FRAMES_A_SECOND) / 1000.0, LONGEST_FRAME)
        finally:
            app.close()


def _wait() -> list[pygame.Event]:
    """The events that come within LONGEST_WAIT."""
    first = pygame.event.wait(LONGEST_WAIT)
    return [] if first.type == pygame.NOEVENT else [first, *pygame.event.get()]


@contextmanager
def _ending_at_signals(app: Window) -> Iterator[None]:
    """At a signal that asks the process to end, end the loop: an open film is then written."""

    def end(number: int, frame: FrameType | None) -> None:
        app.quit(killed=True)

    before = {}
    for name in SIGNALS:
        number = getattr(signal, name, None)
        if number is not None:
            before[number] = signal.signal(number, end)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
