"""The window itself: events to pages, frames to the display, and what every page shares."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path

import pygame

from sandbox.window import theme
from sandbox.window.gallery import Gallery
from sandbox.window.helping import paint_help
from sandbox.window.keys import action_of
from sandbox.window.messages import Messages
from sandbox.window.page import Page
from sandbox.window.warm import Warmer

DESIGN = (1280, 720)
SMALLEST = (800, 480)
SCALES = (0.7, 0.8, 0.9, 1.0, 1.15, 1.3, 1.5, 1.75, 2.0)
FRAMES_A_SECOND = 60
LONGEST_FRAME = 0.25  # seconds of wall time that a frame may stand for; a window that was frozen does not jump


class App:
    """The application. `run` is the loop; tests and benchmarks call `frame` themselves.

    Arguments:
        size: of the window [pixels].
        start: name of a scene, or path of a scene or session file, to open; None shows the gallery.
    """

    def __init__(self, size: tuple[int, int] = DESIGN, start: str | None = None) -> None:
        self.surface = open_display(size)
        self.size = self.surface.get_size()
        self.scale, self.running, self.help = 1.0, True, False
        self.messages, self.warmer = Messages(), Warmer()
        self.warmer.start()
        self.unit = self._unit()
        self.manager = theme.manager(self.size, self.unit)
        self.frames = 0
        self.actions: dict[str, Callable[[], None]] = {
            "help": self.toggle_help,
            "fullscreen": self.toggle_fullscreen,
            "larger": lambda: self.rescale(1),
            "smaller": lambda: self.rescale(-1),
            "normal": lambda: self.rescale(0),
            "quit": self.quit,
            "open": self.ask_for_file,
        }
        self.page: Page = self._gallery()
        self.show(self.page)
        if start is not None:
            self.open(start)

    def _gallery(self) -> Gallery:
        return Gallery(self, self.open)

    def _unit(self) -> float:
        fitting = min(self.size[0] / DESIGN[0], self.size[1] / DESIGN[1])
        return self.scale * min(max(fitting, 0.75), 2.5)

    def show(self, page: Page) -> None:
        """Make `page` the one on screen."""
        self.page = page
        self.rebuild()

    def rebuild(self) -> None:
        """Make all widgets anew: the page, the size or the scale has changed."""
        self.unit = self._unit()
        self.manager = theme.manager(self.size, self.unit)
        self.page.build()

    def show_gallery(self) -> None:
        """Back to the gallery."""
        self.show(self._gallery())

    def open(self, name_or_path: str) -> None:
        """Open a scene by name, or a scene or session file; what is wrong with it becomes a message."""

    def ask_for_file(self) -> None:
        """Ask for the path of a file to open."""

    def quit(self) -> None:
        """End at the end of this frame."""
        self.running = False

    def toggle_help(self) -> None:
        """Show or hide the help overlay."""
        self.help = not self.help

    def toggle_fullscreen(self) -> None:
        """Fill the screen, or be a window again."""
        pygame.display.toggle_fullscreen()
        self._fit(pygame.display.get_surface())

    def rescale(self, by: int) -> None:
        """Take the next larger or smaller scale; 0 is the normal one."""
        place = min(range(len(SCALES)), key=lambda k: abs(SCALES[k] - self.scale))
        self.scale = SCALES[min(max(place + by, 0), len(SCALES) - 1)] if by else 1.0
        self.rebuild()
        self.messages.say(f"scale {100 * self.scale:.0f} %")

    def run(self) -> None:
        """Frames until someone quits."""
        clock = pygame.time.Clock()
        seconds = 1.0 / FRAMES_A_SECOND
        while self.running:
            self.frame(seconds)
            seconds = min(clock.tick(FRAMES_A_SECOND) / 1000.0, LONGEST_FRAME)
        self.close()

    def close(self) -> None:
        """Let go of the display and of the thread."""
        self.warmer.stop()
        pygame.display.quit()

    def frame(self, seconds: float, events: Iterable[pygame.Event] | None = None) -> None:
        """One frame: take the events (those of the queue if None), let `seconds` pass, draw, show."""
        for event in pygame.event.get() if events is None else events:
            self.take(event)
        self.page.update(seconds)
        self.messages.update(seconds)
        self.manager.update(seconds)
        self.paint()
        pygame.display.flip()
        self.frames += 1

    def paint(self) -> None:
        """Draw the whole window."""
        self.page.paint(self.surface)
        self.manager.draw_ui(self.surface)
        overlay = getattr(self.page, "paint_over", None)
        if overlay is not None:
            overlay(self.surface)
        self.messages.paint(self.surface, self.size[1] - 84 * self.unit, self.unit)
        if self.help:
            paint_help(self.surface, self.unit)

    def take(self, event: pygame.Event) -> None:
        """Hand one event to whom it concerns."""
        if event.type == pygame.QUIT:
            self.quit()
        elif event.type in (pygame.VIDEORESIZE, pygame.WINDOWSIZECHANGED):
            self._fit(pygame.display.get_surface())
        elif event.type == pygame.DROPFILE:
            self.open(event.file)
        elif self.help:
            self._take_in_help(event)
        elif not self.messages.handle(event):
            self._take_in_page(event)

    def _take_in_help(self, event: pygame.Event) -> None:
        if event.type == pygame.MOUSEBUTTONDOWN:
            self.help = False
        elif event.type == pygame.KEYDOWN:
            action = action_of(event.key, event.mod)
            if action in ("help", "leave"):
                self.help = False
            elif action == "quit":
                self.quit()

    def _take_in_page(self, event: pygame.Event) -> None:
        if self.manager.process_events(event) or self.page.handle(event):
            return
        if event.type == pygame.KEYDOWN:
            self.act(action_of(event.key, event.mod))

    def act(self, action: str | None) -> None:
        """Do an action of the table of keys, where this page or the window has it."""
        do = self.page.actions.get(action or "") or self.actions.get(action or "")
        if do is not None:
            do()

    def _fit(self, surface: pygame.Surface | None) -> None:
        if surface is None:
            return
        self.surface = surface
        if surface.get_size() != self.size:
            self.size = surface.get_size()
            self.rebuild()


def open_display(size: tuple[int, int]) -> pygame.Surface:
    """A resizable window; of pygame only the display and the font are started, which is quick."""
    from sandbox.resources import resource

    os.environ.setdefault("SDL_VIDEO_CENTERED", "1")
    os.environ.setdefault("SDL_MOUSE_FOCUS_CLICKTHROUGH", "1")
    pygame.display.init()
    pygame.font.init()
    icon = resource("icon.png")
    if Path(icon).is_file():
        pygame.display.set_icon(pygame.image.load(str(icon)))
    pygame.display.set_caption("softcradle")
    surface = pygame.display.set_mode(size, pygame.RESIZABLE)
    pygame.key.set_repeat(350, 45)
    return surface
