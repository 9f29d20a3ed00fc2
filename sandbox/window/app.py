"""The application: it passes events to the pages and frames to the display, and holds what all pages share."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterable
from functools import partial

import pygame
from softcradle.sandbox.draw.surface_cache import clear_cached_surfaces
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window import theme
from softcradle.sandbox.window.display import open_display
from softcradle.sandbox.window.gallery.gallery_page import GalleryPage
from softcradle.sandbox.window.hanging.hanging_page import HANGING_NAME, HangingPage
from softcradle.sandbox.window.help_overlay import paint_help
from softcradle.sandbox.window.kernel_warmup import KernelWarmup
from softcradle.sandbox.window.keys import action_of
from softcradle.sandbox.window.messages import Messages
from softcradle.sandbox.window.path_prompt import PathPrompt
from softcradle.sandbox.window.widget_cleanup import collect_garbage
from softcradle.sandbox.window.window_page import Page
from softcradle.scenes import SceneError, load

DESIGN = (1280, 720)  # pixels of a window whose unit is 1
SCALES = (0.7, 0.8, 0.9, 1.0, 1.15, 1.3, 1.5, 1.75, 2.0)
FRAMES_A_SECOND = 60
LONGEST_FRAME = 0.25  # seconds of wall time: a window that was suspended does not catch up


class App:
    """The window and its pages. `run` is the loop; tests and benchmarks call `frame` themselves.

    Arguments:
        size: of the window [pixels].
        start: name of a scene, or path of a scene or session file, to open; None shows the gallery.
    """

    def __init__(self, size: tuple[int, int] = DESIGN, start: str | None = None) -> None:
        self.surface = open_display(size)
        self.size = self.surface.get_size()
        self.scale, self.running, self.help = 1.0, True, False
        self.messages, self.warmup = Messages(), KernelWarmup()
        self.prompt: PathPrompt | None = None
        self.warmup.start()
        self.unit = self._unit()
        self.manager = theme.manager(self.size, self.unit)
        self.frames, self._page_left = 0, False
        self.actions: dict[str, Callable[[], None]] = {
            "help": self.toggle_help,
            "fullscreen": self.toggle_fullscreen,
            "larger": partial(self.rescale, 1),
            "smaller": partial(self.rescale, -1),
            "normal": partial(self.rescale, 0),
            "quit": self.quit,
            "open": self.ask_path,
        }
        self.page: Page = self._gallery()
        self._build()
        if start is not None:
            self.open(start)

    def _gallery(self) -> GalleryPage:
        return GalleryPage(self, self.open)

    def _unit(self) -> float:
        fitting = min(self.size[0] / DESIGN[0], self.size[1] / DESIGN[1])
        return self.scale * min(max(fitting, 0.75), 2.5)

    def show(self, page: Page) -> None:
        """Bring `page` on screen."""
        if page is not self.page:
            self.page.close()
        self.prompt = None
        self.page = page
        clear_cached_surfaces()
        self.rebuild()
        self._page_left = True

    def rebuild(self) -> None:
        """Make all widgets anew: the page, the size or the scale has changed."""
        self.manager.clear_and_reset()
        collect_garbage()  # before new widgets are made, or there would be all surfaces twice
        self._build()
        gc.freeze()  # so that Python does not search the widgets in the middle of play

    def _build(self) -> None:
        before, self.unit = self.unit, self._unit()
        if self.unit == before:  # a new manager would draw the shapes of all widgets again
            self.manager.set_window_resolution(self.size)
        else:
            self.manager = theme.manager(self.size, self.unit)
        self.page.build()
        if self.prompt is not None and self.prompt.open:
            self.prompt.build()

    def show_gallery(self) -> None:
        """Back to the gallery."""
        self.show(self._gallery())

    def open(self, name_or_path: str) -> None:
        """Open a scene by name, or a scene or session file; what is wrong with it is shown."""
        try:
            page = self._opened(name_or_path)
        except (SceneError, UserError, ValueError, OSError) as error:
            self.messages.show(str(error), warning=True)
            return
        self.show(page)

    def _opened(self, name_or_path: str) -> Page:
        from softcradle.sandbox.window.scene.scene_page import ScenePage

        if name_or_path == HANGING_NAME:
            return HangingPage(self, self.show_gallery)
        if name_or_path.lower().endswith(".npz"):
            from softcradle.sandbox.session.replay import Replay

            replay = Replay.load(name_or_path)
            return ScenePage(self, replay.session, self.show_gallery, replay)
        from softcradle.sandbox.session.session import Session

        return ScenePage(self, Session(load(name_or_path)), self.show_gallery)

    def ask_path(self) -> None:
        """Ask for the path of a file to open."""
        self.ask("Open", "a scene (.toml), a session (.npz), or the name of a scene", "", self.open)

    def ask(self, title: str, note: str, text: str, take: Callable[[str], None]) -> None:
        """Ask for a line of text in a box over the page."""
        if self.prompt is not None and self.prompt.open:
            self.prompt.close()
        self.prompt = PathPrompt(self, title, note, text, take)

    def quit(self) -> None:
        """End at the end of this frame."""
        self.running = False

    def toggle_help(self) -> None:
        """Show or hide the help overlay."""
        self.help = not self.help

    def toggle_fullscreen(self) -> None:
        """Switch between the full screen and a window."""
        pygame.display.toggle_fullscreen()
        self._fit(pygame.display.get_surface())

    def rescale(self, by: int) -> None:
        """Take the next larger or smaller scale; 0 is the normal one."""
        place = min(range(len(SCALES)), key=lambda k: abs(SCALES[k] - self.scale))
        self.scale = SCALES[min(max(place + by, 0), len(SCALES) - 1)] if by else 1.0
        self.rebuild()
        self.messages.show(f"scale {100 * self.scale:.0f} %")

    def run(self) -> None:
        """Frames until the user quits."""
        clock = pygame.time.Clock()
        seconds = 1.0 / FRAMES_A_SECOND
        while self.running:
            self.frame(seconds)
            seconds = min(clock.tick(FRAMES_A_SECOND) / 1000.0, LONGEST_FRAME)
        self.close()

    def close(self) -> None:
        """Close the page, the thread and the display."""
        self.page.close()
        self.warmup.stop()
        gc.unfreeze()
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
        self.page.after_frame(self.surface, seconds)
        self.frames += 1
        if self._page_left:  # only now does no pressed button refer to the page that was left
            self._page_left = False
            collect_garbage()

    def paint(self) -> None:
        """Draw the whole window."""
        self.page.paint(self.surface)
        if self.prompt is None or not self.prompt.open:
            self.manager.draw_ui(self.surface)
            self.page.paint_over(self.surface)
        else:
            self.page.paint_over(self.surface)
            self.prompt.paint(self.surface)
            self.manager.draw_ui(self.surface)
        self.messages.paint(self.surface, self.size[1] - 84 * self.unit, self.unit)
        if self.help:
            paint_help(self.surface, self.unit)

    def take(self, event: pygame.Event) -> None:
        """Pass one event on: to the window, the help, the messages, or the page."""
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
        prompt = self.prompt if self.prompt is not None and self.prompt.open else None
        if prompt is not None and prompt.handle(event):
            return
        if self.page.typing and event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE:
            self.manager.set_focus_set(None)
            return
        if self.manager.process_events(event) or self.page.handle(event) or self.page.typing:
            return
        if event.type == pygame.KEYDOWN:
            self.act(action_of(event.key, event.mod))

    def act(self, action: str | None) -> None:
        """Do an action of the table of keys, if the page or the window has it."""
        perform = self.page.actions.get(action or "") or self.actions.get(action or "")
        if perform is not None:
            perform()

    def _fit(self, surface: pygame.Surface | None) -> None:
        if surface is None:
            return
        self.surface = surface
        if surface.get_size() != self.size:
            self.size = surface.get_size()
            self.rebuild()
