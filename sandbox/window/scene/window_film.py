"""A film of the window: every other picture, from one press of the key to the next."""

from __future__ import annotations

from contextlib import ExitStack
from typing import Any

import pygame
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.scene.lane_cards import RED
from softcradle.sandbox.window.scene.save_dialogs import free_path, report
from softcradle.sandbox.window.window_page import Host

FRAME_RATE = 30.0  # frames a second of the film: every other picture of the window
MOST_DUE = 2.0  # frames: after a late picture the film does not catch up


class WindowFilm:
    """The film that is being recorded, if there is one."""

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        self.film: Any = None
        self.path = ""
        self._stack: ExitStack | None = None
        self._due = 0.0

    def toggle(self) -> None:
        """Begin a film, or end it."""
        if self._stack is not None:
            self.end()
        else:
            self.begin(str(free_path(self.session, ".mp4")))

    def begin(self, path: str) -> None:
        """Record from now on."""
        from softcradle.sandbox.film.writer import open_film

        width, height = self.host.size
        stack = ExitStack()
        try:
            self.film = stack.enter_context(open_film(path, (width - width % 2, height - height % 2), FRAME_RATE))
        except (UserError, OSError) as error:
            self.host.messages.show(str(error), warning=True)
            return
        self._stack, self.path, self._due = stack, path, 0.0
        self.host.messages.show(f"recording to {path}: the same key ends it")

    def end(self) -> None:
        """Write what was recorded."""
        stack, self._stack, self.film = self._stack, None, None
        if stack is not None:
            report(self.host.messages, stack.close, f"saved {self.path}")

    def record(self, surface: pygame.Surface, seconds: float) -> None:
        """Add the finished picture to the film, if one is due after `seconds` more."""
        if self.film is None:
            return
        self._due = min(self._due + seconds * FRAME_RATE, MOST_DUE)
        if self._due < 1.0:
            return
        self._due -= 1.0
        try:
            frame = self.film.free_surface()
            frame.blit(surface, (0, 0))
            self.film.add(frame)
        except (UserError, OSError, ValueError, pygame.error) as error:
            self.film = None
            self.host.messages.show(f"the film stopped: {error}", warning=True)

    def paint(self, surface: pygame.Surface, right: float, top: float) -> None:
        """Draw a red dot while recording, left of `right` and below `top`."""
        if self.film is not None:
            unit = self.host.unit
            x, y = right, top + 14 * unit
            pygame.draw.circle(surface, RED, (x, y), 6 * unit)
            write(surface, "rec", (x - 10 * unit, y), 12 * unit, RED, bold=True, align=(1, 0.5))
