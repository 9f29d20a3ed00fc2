"""Keeping what happens on a page: scene, session, history, screenshot, film, and the click of impacts."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pygame
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.output_files import output_file
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.scene.lane_cards import RED
from softcradle.sandbox.window.sound import Clicks

if TYPE_CHECKING:
    from softcradle.sandbox.window.scene.scene_page import Play

FILM_RATE = 30.0  # frames a second of a film of the window: every other one


class Keeping:
    """Files and sounds that come from a page."""

    def __init__(self, page: Play) -> None:
        self.page = page
        self.film: Any = None
        self.film_path = ""
        self._stack: ExitStack | None = None
        self._owed = 0.0
        self.clicks: Clicks | None = None
        self.actions: dict[str, Callable[[], None]] = {
            "save_scene": self.ask_scene,
            "save_session": self.ask_session,
            "export": self.ask_export,
            "screenshot": self.screenshot,
            "film": self.toggle_film,
            "sound": self.toggle_sound,
        }

    @property
    def session(self) -> Session:
        """The page's session."""
        return self.page.session

    @property
    def stem(self) -> str:
        """A file name that tells which scene it is from."""
        return re.sub(r"[^a-z0-9]+", "-", self.session.scene.title.lower()).strip("-")[:40] or "scene"

    def _ask(self, title: str, note: str, suffix: str, take: Callable[[str], None]) -> None:
        self.page.host.ask(title, note, str(free_name(Path(f"{self.stem}{suffix}"))), take)

    def _done(self, work: Callable[[], object], said: str) -> None:
        """Do it and say so; what goes wrong is said instead."""
        try:
            work()
        except (UserError, OSError, ValueError) as error:
            self.page.host.messages.say(str(error), trouble=True)
        else:
            self.page.host.messages.say(said)

    def ask_scene(self) -> None:
        """Save the scene with all edits."""
        self._ask("Save the scene", "a .toml file, to be opened here, rendered or run", "-edited.toml", self.save_scene)

    def save_scene(self, path: str) -> None:
        """Write the scene file."""
        path = path if path.endswith(".toml") else f"{path}.toml"
        self._done(lambda: self.session.save_scene(path), f"saved {path}")

    def ask_session(self) -> None:
        """Save the session."""
        note = "an .npz file: drop it here, and everything happens again"
        self._ask("Save the session", note, "-session.npz", self.save_session)

    def save_session(self, path: str) -> None:
        """Write the recording."""
        path = path if path.endswith(".npz") else f"{path}.npz"
        self._done(lambda: self.session.save_recording(path), f"saved {path}")

    def ask_export(self) -> None:
        """Export the history."""
        self._ask("Export the history", ".npz (everything) or .csv (a table); a file a lane", ".csv", self.export)

    def export(self, path: str) -> None:
        """Write the trajectories."""
        self._done(lambda: self.session.export(path), f"saved the history to {path}")

    def screenshot(self) -> None:
        """The window as it is, as a PNG file in the working folder."""
        path = free_name(Path(f"{self.stem}.png"))

        def work() -> None:
            with output_file(path) as temporary:
                pygame.image.save(self.page.host.surface, str(temporary))

        self._done(work, f"saved {path}")

    # ---- film

    def toggle_film(self) -> None:
        """Begin a film of the window, or end it."""
        if self._stack is not None:
            self.end_film()
            return
        path = str(free_name(Path(f"{self.stem}.mp4")))
        self.begin_film(path)

    def begin_film(self, path: str) -> None:
        """Record every other frame from now on."""
        from softcradle.sandbox.film.writer import open_film

        size = self.page.host.size
        even = size[0] - size[0] % 2, size[1] - size[1] % 2
        stack = ExitStack()
        try:
            self.film = stack.enter_context(open_film(path, even, FILM_RATE))
        except (UserError, OSError) as error:
            self.page.host.messages.say(str(error), trouble=True)
            return
        self._stack, self.film_path, self._size, self._owed = stack, path, even, 0.0
        self.page.host.messages.say(f"recording to {path}: the same key ends it")

    def end_film(self) -> None:
        """Write what was recorded."""
        stack, self._stack, self.film = self._stack, None, None
        if stack is not None:
            self._done(stack.close, f"saved {self.film_path}")

    def record(self, surface: pygame.Surface, seconds: float) -> None:
        """Take the finished picture into the film, when one is due."""
        if self.film is None:
            return
        self._owed = min(self._owed + seconds * FILM_RATE, 2.0)
        if self._owed < 1.0:
            return
        self._owed -= 1.0
        try:
            frame = self.film.free_surface()
            frame.blit(surface, (0, 0))
            self.film.add(frame)
        except (UserError, OSError, ValueError, pygame.error) as error:
            self.film = None
            self.page.host.messages.say(f"the film stopped: {error}", trouble=True)

    # ---- sound

    def toggle_sound(self) -> None:
        """Clicks on or off; they are off until someone asks."""
        if self.clicks is not None:
            self.clicks.close()
            self.clicks = None
            self.page.host.messages.say("clicks off")
            return
        try:
            self.clicks = Clicks()
        except pygame.error as error:
            self.page.host.messages.say(f"there is no sound here: {error}", trouble=True)
        else:
            self.page.host.messages.say("clicks on")

    def update(self, seconds: float) -> None:
        """Click for the impacts of the last frame."""
        if self.clicks is not None and self.session.playing:
            speed = max(lane.setup.speed for lane in self.session.lanes)
            for impact in self.session.impacts[:4]:
                self.clicks.click(impact.speed / speed, impact.contact)

    def paint(self, surface: pygame.Surface) -> None:
        """A red dot while a film is being recorded; it is not in the film's way: it stands in the bar above."""
        if self.film is not None:
            unit, top = self.page.host.unit, self.page.places.top
            x = self.page.places.side.left - 20 * unit if self.page.side else top.right - 60 * unit
            pygame.draw.circle(surface, RED, (x, top.bottom + 14 * unit), 6 * unit)
            write(surface, "rec", (x - 10 * unit, top.bottom + 14 * unit), 12 * unit, RED, bold=True, align=(1, 0.5))

    def close(self) -> None:
        """The page is being left: end what is open."""
        self.end_film()
        if self.clicks is not None:
            self.clicks.close()
            self.clicks = None


def free_name(path: Path) -> Path:
    """`path`, with a number before its suffix where it is taken."""
    number = 1
    found = path
    while found.exists():
        number += 1
        found = path.with_name(f"{path.stem}-{number}{path.suffix}")
    return found
