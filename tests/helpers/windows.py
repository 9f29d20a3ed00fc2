"""A driver of the real window: posted events, without a screen."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import nullcontext
from time import process_time
from typing import ClassVar
from unittest.mock import patch

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
os.environ.setdefault("SDL_AUDIODRIVER", "dummy")

import pygame
from softcradle.sandbox.window.app import App
from softcradle.sandbox.window.scene.page import ScenePage

LONGEST = 3600.0  # s: kernels are compiled, beside whatever else the machine does
FRAME = 1.0 / 60.0


LONGEST_WORK = 120.0  # seconds of processor time after which what a test waits for does not come


class Driver:
    """Posts keys and mouse events to an App, and lets its frames pass.

    Attributes:
        app: the window; its clock moves between frames alone, so no frame depends on how busy the machine is.
        time: of that clock [s].
    """

    opened: ClassVar[list[Driver]] = []

    def __init__(
        self, start: str | None = None, size: tuple[int, int] = (1280, 720), wait: bool = True, lab: bool = True
    ) -> None:
        """`wait`: until all kernels are in memory; `lab`: with all controls."""
        self.time = 0.0
        self.opened.append(self)
        self.app = App(size, start, lambda: self.time, lab)
        assert not wait or self.app.warmup.complete.wait(LONGEST)
        self.frames(2)

    @property
    def page(self) -> ScenePage:
        assert isinstance(self.app.page, ScenePage)
        return self.app.page

    @property
    def session(self):
        return self.page.session

    @property
    def messages(self) -> list[str]:
        return [message.text for message in self.app.messages.visible]

    def frames(self, count: int = 1) -> None:
        """So many frames, of which the last two are drawn: what a test looks at is the end."""
        for left in range(count - 1, -1, -1):
            self._frame(drawn=left < 2)

    def _frame(self, drawn: bool = True) -> None:
        with nullcontext() if drawn else patch.object(self.app, "paint", lambda: None):
            self.app.frame(FRAME)
        self.time += FRAME

    def until(self, found: Callable[[], object], most: int = 0) -> None:
        """Frames until `found`, at most `most`; without, for what a thread behind the window does."""
        end, count = process_time() + LONGEST_WORK, 0
        while not found():
            assert count < most if most else process_time() < end, "nothing came"
            count += 1
            self._frame(drawn=False)
            if not most:
                pygame.time.wait(2)
        self.frames()

    def play(self, count: int) -> None:
        """Play so many frames, and pause."""
        self.key(pygame.K_SPACE)
        self.frames(count)
        self.key(pygame.K_SPACE)

    def key(self, code: int, modifiers: int = 0, text: str = "") -> None:
        pygame.event.post(pygame.Event(pygame.KEYDOWN, key=code, mod=modifiers, unicode=text, scancode=0))
        if text:
            pygame.event.post(pygame.Event(pygame.TEXTINPUT, text=text))
        pygame.event.post(pygame.Event(pygame.KEYUP, key=code, mod=modifiers, unicode=text, scancode=0))
        self.frames(2)  # widgets post events of their own

    def type(self, text: str) -> None:
        for letter in text:
            self.key(ord(letter), 0, letter)

    def move(self, point: tuple[float, float], buttons: tuple[int, int, int] = (0, 0, 0)) -> None:
        place = (round(point[0]), round(point[1]))
        pygame.mouse.set_pos(place)
        pygame.event.clear(pygame.MOUSEMOTION)  # of the system, with no button down
        self.app.manager.mouse_position = place
        pygame.event.post(pygame.Event(pygame.MOUSEMOTION, pos=place, rel=(0, 0), buttons=buttons))
        self.frames()

    def press(self, point: tuple[float, float]) -> None:
        self.move(point)
        place = (round(point[0]), round(point[1]))
        pygame.event.post(pygame.Event(pygame.MOUSEBUTTONDOWN, pos=place, button=1))
        self.frames()

    def release(self, point: tuple[float, float]) -> None:
        place = (round(point[0]), round(point[1]))
        pygame.event.post(pygame.Event(pygame.MOUSEBUTTONUP, pos=place, button=1))
        self.frames()

    def click(self, point: tuple[float, float]) -> None:
        self.press(point)
        self.release(point)

    def drag(self, start: tuple[float, float], end: tuple[float, float], steps: int = 8) -> None:
        """Press at `start`, move to `end`; the button stays down."""
        self.press(start)
        for k in range(1, steps + 1):
            share = k / steps
            point = start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])
            self.move(point, (1, 0, 0))

    def bead(self, bead: int, lane: int = 0) -> tuple[float, float]:
        return self.page.view.lanes[lane].centre(bead)

    def drop_file(self, path: object) -> None:
        pygame.event.post(pygame.Event(pygame.DROPFILE, file=str(path)))
        self.frames(2)

    def close(self) -> None:
        self.app.close()
        if self in self.opened:
            self.opened.remove(self)
