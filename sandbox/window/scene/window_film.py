"""A film of the window: every other picture, from one press of the button to the next."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.languages import _, error_words
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.scene.file_names import shown_path
from softcradle.sandbox.window.window_page import Host

FILM_ENDINGS = (".mp4", ".gif", ".webp")
FRAME_RATE = 30.0  # frames a second of the film: every other picture of the window
MOST_DUE = 2.0  # frames: after a late picture the film does not catch up


class WindowFilm:
    """The film that is being recorded, if there is one.

    Attributes:
        film: it; None where nothing is recorded.
        seconds: how long it is.
    """

    def __init__(self, host: Host) -> None:
        self.host = host
        self.film: Any = None
        self.path, self.seconds = Path(), 0.0
        self._size = (0, 0)
        self._stack: ExitStack | None = None
        self._due = 0.0

    def begin(self, path: Path) -> None:
        """Record from now on, in the window's present size."""
        from softcradle.sandbox.film.film_encoder import open_film

        width, height = self.host.size
        self._size = width - width % 2, height - height % 2
        stack = ExitStack()
        try:
            self.film = stack.enter_context(open_film(path, self._size, FRAME_RATE))
        except (UserError, OSError) as error:
            self.host.messages.show(str(error), warning=True)
            return
        self._stack, self.path, self._due, self.seconds = stack, path, 0.0, 0.0
        self.host.rebuild()  # the button says Stop now

    def end(self) -> None:
        """Write what was recorded."""
        stack, self._stack, self.film = self._stack, None, None
        if stack is None:
            return
        try:
            stack.close()
        except (UserError, OSError, ValueError) as error:
            self.host.messages.show(_("the film is lost: {error}", error=error_words(error)), warning=True)
        else:
            text = _("saved {seconds:.0f} s to {path}", seconds=self.seconds, path=shown_path(self.path))
            self.host.messages.show(text)

    def record(self, surface: pygame.Surface, seconds: float) -> None:
        """Add the finished picture to the film, if one is due after `seconds` more."""
        if self.film is None:
            return
        self.seconds += seconds
        self._due = min(self._due + seconds * FRAME_RATE, MOST_DUE)
        if self._due < 1.0:
            return
        self._due -= 1.0
        try:
            frame = self.film.free_surface()
            _copy_whole(surface, frame)
            self.film.add(frame)
        except (UserError, OSError, ValueError, pygame.error) as error:
            self.host.messages.show(_("the film stopped: {error}", error=error_words(error)), warning=True)
            self.end()

    @property
    def clock(self) -> str:
        """How long the film is, as minutes and seconds."""
        return f"{int(self.seconds) // 60}:{int(self.seconds) % 60:02d}"


def _copy_whole(surface: pygame.Surface, frame: pygame.Surface) -> None:
    """Copy all of `surface` onto `frame`, scaled into its middle where the window has another size now."""
    (width, height), (wide, high) = surface.get_size(), frame.get_size()
    if width - width % 2 == wide and height - height % 2 == high:
        frame.blit(surface, (0, 0))
        return
    scale = min(wide / width, high / height)
    image = pygame.transform.smoothscale(surface, (round(width * scale), round(height * scale)))
    frame.fill(tones.background)
    frame.blit(image, image.get_rect(center=frame.get_rect().center))
