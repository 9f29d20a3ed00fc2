"""The application. It opens pages, passes events to them and draws frames. It also holds the state shared by all pages."""

from __future__ import annotations

import gc
import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from time import perf_counter
from types import FrameType

import pygame
from softcradle.sandbox.draw.palette import THEMES, use_theme
from softcradle.sandbox.draw.surfaces import clear_cached_surfaces
from softcradle.sandbox.languages import ENGLISH, LANGUAGES, _, language, scene_words, use_language
from softcradle.sandbox.session.export import is_shared_text, scene_from_text
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window import theme
from softcradle.sandbox.window.dialog import Choices, Dialog, EntryDialog, FileChooser, Overlay
from softcradle.sandbox.window.display import not_too_small, open_display, toggle_fullscreen
from softcradle.sandbox.window.event_router import NOWHERE, EventRouter, KeyboardFocus
from softcradle.sandbox.window.gallery.page import GalleryPage
from softcradle.sandbox.window.kernel_warmup import KernelWarmup
from softcradle.sandbox.window.keys import paint_help
from softcradle.sandbox.window.messages import Messages
from softcradle.sandbox.window.page import Derived, Page
from softcradle.sandbox.window.settings import SCALES, Settings, system_language
from softcradle.sandbox.window.theme import collect_garbage
from softcradle.sandbox.window.unsaved_scene import UnsavedFile, left_over
from softcradle.scenes import SceneError, load, names, parse

STANDARD_INPUT = "-"
DESIGN = (1280, 720)  # Size in pixels of the window that has one design pixel per pixel.
# Smallest sizes in design pixels, in the Lab and in Explore. Every page fits into a window of this size. A larger scale
# is reduced until the page fits.
LEAST, LEAST_EXPLORED = (850, 500), (640, 400)
FRAMES_A_SECOND = 60
# Longest time step of a frame in seconds of wall time. A window that was suspended does not make up for the lost time.
LONGEST_FRAME = 0.25
# Longest time to wait for an event in milliseconds. It limits the delay of results from the background thread.
LONGEST_WAIT = 500
# Seconds after the last event during which frames are still drawn, because tooltips and buttons change with a delay.
SETTLED = 1.5
# Names of the signals that end the program. Some of them do not exist on some systems.
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")


class App:
    """The window and its pages. `run` contains the main loop; tests and benchmarks call `frame` directly.

    Arguments:
        size: size of the window [pixels].
        start: name of a scene, or path of a scene or session file, to open; None shows the gallery.
        lab: if True, start with all controls (Lab), whichever level the settings file contains.
        clock: function that returns the wall time [s]. When the time for a frame is used
            up, its computation ends.
    """

    def __init__(
        self,
        size: tuple[int, int] = DESIGN,
        start: str | None = None,
        clock: Callable[[], float] = perf_counter,
        lab: bool = False,
    ) -> None:
        self.clock = clock
        self.surface = open_display(size)
        self.size = self._window_size = self.surface.get_size()
        self.running, self.help, self.help_scroll = True, False, 0.0
        self.messages, self.warmup, self.settings = Messages(), KernelWarmup(), Settings.load()
        self.scale, self.explore = self.settings.scale, self.settings.explore and not lab
        use_theme(self.settings.theme)
        use_language(self.settings.language or system_language())
        self.dialog: Overlay | None = None
        self.gallery: GalleryPage | None = None
        self.minimised, self._quiet = False, 0.0
        self.page: Page = Page()
        self.focus = KeyboardFocus(self)
        self.router = EventRouter(self)
        self.unsaved_file, self._left_over = UnsavedFile(), left_over()
        self._quit_by_hand = False
        self.warmup.start()
        self._shapes = Derived(lambda: self.look[1:], self._begin_shapes)
        self._shapes.follow()
        self.frames, self._page_left = 0, False
        self.actions: dict[str, Callable[[], None]] = {
            "help": self.toggle_help,
            "fullscreen": self.toggle_fullscreen,
            "larger": partial(self.rescale, 1),
            "smaller": partial(self.rescale, -1),
            "normal": partial(self.rescale, 0),
            "quit": partial(self.ask_before_loss, self.quit),
            "open": self.ask_path,
            "paste": self.paste,
            "theme": self.toggle_theme,
            "level": self.toggle_level,
            "language": self.next_language,
            "next_control": partial(self.focus.move, 1),
            "previous_control": partial(self.focus.move, -1),
        }
        self.widgets = Derived(self._made_of, self.rebuild)
        self.page = self._first_page(start)
        self._build()
        if (found := self._left_over) is not None:
            choices: Choices = {_("Open it"): partial(self._open_unsaved, found), _("Discard it"): found.forget}
            self.choose(_("An unsaved scene"), _("softcradle closed before your changes were saved."), choices)

    def _open_unsaved(self, found: UnsavedFile) -> None:
        """Open the unsaved scene of a window that crashed or was killed. This window then owns the backup file of the
        scene.
        """
        page = self._opened(str(found.path))
        if page is not None:
            page.call_unsaved()
            self.show(page)
            self.unsaved_file.release()
            self.unsaved_file, self._left_over = found, None

    def _first_page(self, start: str | None) -> Page:
        page = None if start is None else self._opened(start)
        return self._gallery() if page is None else page

    def _gallery(self) -> GalleryPage:
        """Return the gallery page. The page is made only once, so it keeps its state while other pages are visible."""
        if self.gallery is None:
            self.gallery = GalleryPage(self, self.open)
        return self.gallery

    @property
    def _usual_unit(self) -> float:
        """Number of pixels per design pixel at a scale of 100 %."""
        return min(max(min(self.size[0] / DESIGN[0], self.size[1] / DESIGN[1]), 0.75), 2.5)

    def _unit(self) -> float:
        wide, high = LEAST_EXPLORED if self.explore else LEAST
        return min(self.scale * self._usual_unit, self.size[0] / wide, self.size[1] / max(high, self.page.least_height))

    @property
    def look(self) -> tuple[object, ...]:
        """The window properties that determine the appearance of all drawn surfaces."""
        return self.size, self._unit(), self.explore, self.settings.theme, language()

    def _made_of(self) -> object:
        return self.page, self.look, self.page.made_of()

    def follow(self) -> None:
        """Update the widgets and the drawings of the page if their underlying state has changed."""
        self.widgets.follow()
        self.page.follow()

    def show(self, page: Page) -> None:
        """Replace the current page by `page`."""
        if page is not self.page:
            self.messages.leave_page()
            self.page.close()
        self.dialog = self.focus.place = None
        self.page = page
        clear_cached_surfaces()
        self.rebuild()
        self._page_left = True

    def rebuild(self) -> None:
        """Remove all widgets and create them again."""
        self.manager.clear_and_reset()
        # Free the old widgets before new ones are made. Otherwise all surfaces would exist twice for a moment.
        collect_garbage()
        self._build()
        # Exclude the widgets from later garbage collections, because a collection would interrupt the motion.
        gc.freeze()

    def _build(self) -> None:
        if not self._shapes.follow():
            self.manager.set_window_resolution(self.size)
        pygame.display.set_caption(f"{scene_words(self.page.title)} - softcradle" if self.page.title else "softcradle")
        self.page.build()
        # Update disabled widgets once, so that they look disabled. Below a dialog they receive no further updates.
        self.manager.ui_group.update(0.0)
        self.focus.hide_tooltips()
        if self.dialog is not None and self.dialog.open:
            self.dialog.build()
        self.widgets.note()

    def _begin_shapes(self) -> None:
        """Create a new widget manager. It draws the shapes of all widgets again."""
        clear_cached_surfaces()
        self.unit = self._unit()
        self.manager = theme.manager(self.size, self.unit)

    def toggle_theme(self) -> None:
        """Switch to the other theme and store it in the settings."""
        names = list(THEMES)
        self.settings.keep(theme=names[(names.index(self.settings.theme) + 1) % len(names)])
        use_theme(self.settings.theme)

    def toggle_level(self) -> None:
        """Switch between Explore (few controls) and Lab (all controls) and store the choice in the settings."""
        self.explore = not self.explore
        self.settings.keep(explore=self.explore)
        # The cards of the gallery look the same at both levels, so a message has to show the change.
        if self.page is self.gallery:
            shown = _("Explore: few controls") if self.explore else _("Lab: all controls")
            self.messages.show(shown, subject="level")

    def next_language(self) -> None:
        """Switch to the next language and store it in the settings."""
        codes = list(LANGUAGES)
        self.settings.keep(language=codes[(codes.index(language()) + 1) % len(codes)])
        use_language(self.settings.language)
        self.messages.show(LANGUAGES[language()].name, subject="language")

    def show_gallery(self) -> None:
        """Return to the gallery."""
        self.show(self._gallery())

    def open(self, name_or_path: str) -> None:
        """Open a scene by name, or open a scene or session file. Show a message if it cannot be opened."""
        page = self._opened(name_or_path)
        if page is not None:
            self.settings.remember(name_or_path)
            self.ask_before_loss(partial(self.show, page))

    def _opened(self, name_or_path: str) -> Page | None:
        try:
            return page_of(self, name_or_path, partial(self.ask_before_loss, self.show_gallery))
        except (SceneError, UserError, ValueError, OSError) as error:
            self.messages.show(str(error), warning=True)
            return None

    def paste(self) -> None:
        """Open the scene or the path on the clipboard."""
        text = pygame.scrap.get_text().strip()
        if text:
            self.open(text)
        else:
            self.messages.show(_("the clipboard is empty: Ctrl+C copies a scene"), warning=True)

    def ask_path(self) -> None:
        """Ask the user for the path of a file to open."""
        note = _("a scene (.toml), a session (.npz), or the name of a scene")
        more: Choices = {_("Choose a file ..."): self._choose_file}
        take, title = self._take_line(self.open), _("Open")
        self.put_over(EntryDialog(self, title, note, {title: ""}, take, self.settings.recent, more))

    def _choose_file(self) -> None:
        self.put_over(FileChooser(self, _("Open"), {".toml", ".npz"}, self.open))

    def _take_line(self, take: Callable[[str], None]) -> Callable[[dict[str, str]], None]:
        return lambda texts: take(next(iter(texts.values())))

    def ask(self, title: str, note: str, text: str, take: Callable[[str], None]) -> None:
        """Ask the user for a line of text, in a dialog over the page."""
        self.put_over(EntryDialog(self, title, note, {title: text}, self._take_line(take)))

    def choose(self, title: str, note: str, choices: Choices, neutral: bool = False) -> None:
        """Ask a question with one button for each choice. If `neutral`, no button is preselected."""
        self.put_over(Dialog(self, title, note, choices, neutral))

    def put_over(self, modal: Overlay) -> None:
        """Show a dialog or a menu over the page. An open dialog or menu is closed first."""
        self.focus.hide_tooltips()
        if self.dialog is not None and self.dialog.open:
            self.dialog.close()
        self.dialog = modal

    def ask_before_loss(self, go_on: Callable[[], object]) -> None:
        """Leave the page by calling `go_on`. If the page has unsaved edits, ask the user first."""
        if not self.page.unsaved:
            go_on()
            return
        choices: Choices = {
            _("Save ..."): self.page.actions["save_scene"],
            _("Don't save"): partial(self._discard, go_on),
            _("Stay"): lambda: None,
        }
        self.choose(_("Save your changes?"), _("This scene has changes that are not saved."), choices)

    def _discard(self, go_on: Callable[[], object]) -> None:
        self.unsaved_file.forget()
        go_on()

    def quit(self, killed: bool = False) -> None:
        """End the main loop after this frame.

        If the process is being `killed`, keep the backup of an unsaved scene for the next start of the program.
        """
        self.running, self._quit_by_hand = False, not killed

    def toggle_help(self) -> None:
        """Show or hide the help overlay."""
        self.help, self.help_scroll = not self.help, 0.0

    def toggle_fullscreen(self) -> None:
        """Switch between full screen and a window."""
        if not pygame.display.is_fullscreen():
            self._window_size = self.size
        self.fit(toggle_fullscreen(self._window_size))

    def rescale(self, by: int) -> None:
        """Switch to the next larger scale if `by` is 1, or to the next smaller one if it is -1. 0 restores 100 %."""
        place = min(range(len(SCALES)), key=lambda k: abs(SCALES[k] - self.scale))
        self.scale = SCALES[min(max(place + by, 0), len(SCALES) - 1)] if by else 1.0
        self.settings.keep(scale=self.scale)
        shown = self._unit() / self._usual_unit
        if shown < self.scale - 0.005:
            text = _("scale {percent:.0f} %: this window is too small for a larger scale", percent=100 * shown)
            self.messages.hint(text, subject="scale")
        else:
            self.messages.show(_("scale {percent:.0f} %", percent=100 * shown), subject="scale")

    def run(self) -> None:
        """Draw frames until the user quits. Films and sounds are closed even if the loop ends with an exception."""
        clock = pygame.time.Clock()
        seconds = 1.0 / FRAMES_A_SECOND
        with _ending_at_signals(self):
            try:
                while self.running:
                    events = _wait() if self.still else None
                    if events is None or events or not self.still:
                        self.frame(seconds, events)
                    else:
                        self.pass_time(LONGEST_WAIT / 1000.0)
                    seconds = min(clock.tick(FRAMES_A_SECOND) / 1000.0, LONGEST_FRAME)
            finally:
                self.close()

    def close(self) -> None:
        """Close the page, the background thread and the window."""
        self.page.close()
        if self._quit_by_hand:
            self.unsaved_file.forget()
        for file in (self.unsaved_file, self._left_over):
            if file is not None:
                file.release()
        self.warmup.stop()
        use_language(ENGLISH)  # Restore English, because code that runs after the window has closed expects it.
        gc.unfreeze()
        pygame.display.quit()

    @property
    def still(self) -> bool:
        """True if no frame has to be drawn until the next event arrives."""
        return self.minimised or (not self.page.moving and not self.page.typing and self._quiet > SETTLED)

    def pass_time(self, seconds: float) -> None:
        """Advance the time by `seconds` without drawing a frame. Messages expire, and results of the background thread
        are delivered.
        """
        shown = len(self.messages.visible)
        self.messages.update(seconds)
        if self.warmup.deliver() or len(self.messages.visible) != shown:
            self._quiet = 0.0

    def frame(self, seconds: float, events: Iterable[pygame.Event] | None = None) -> None:
        """Compute and show one frame. It handles the events, advances the page by `seconds`, and draws the window.

        If `events` is None, the events are taken from pygame's queue.
        """
        self._quiet += seconds
        for event in pygame.event.get() if events is None else events:
            self._quiet = 0.0
            self.follow()  # An earlier event of the same frame may have changed the state.
            self.router.take(event)
        if self.minimised:
            return
        self.warmup.deliver()
        self.follow()
        self.page.update(seconds)
        self.follow()
        self.messages.update(seconds)
        if self.dialog is not None and self.dialog.open:
            self.dialog.update(seconds)
            # Show and hide the widgets below the dialog, but do not let them react to the pointer.
            self.manager.ui_group.update_visibility()
        else:
            self.manager.update(seconds)
        self.focus.follow()
        self.paint()
        pygame.display.flip()
        self.page.after_frame(self.surface, seconds)
        self.frames += 1
        # After this frame no pressed button refers to the previous page, so its objects can be freed.
        if self._page_left:
            self._page_left = False
            collect_garbage()

    def paint(self) -> None:
        """Draw the whole window."""
        self.page.paint(self.surface)
        self.manager.draw_ui(self.surface)
        self.page.paint_over(self.surface)
        self.focus.paint(self.surface)
        if self.dialog is not None and self.dialog.open:
            self.dialog.paint(self.surface)
        self.messages.paint(self.surface, self.page.message_place(self.size, self.unit), self.unit)
        if self.help:
            self.help_scroll = paint_help(self.surface, self.unit, self.help_scroll)

    @property
    def pointer(self) -> tuple[int, int]:
        """Position of the mouse. It is NOWHERE if a dialog covers the page."""
        covered = self.dialog is not None and self.dialog.open
        return NOWHERE if covered else pygame.mouse.get_pos()

    def act(self, action: str | None) -> None:
        """Perform an action of the key table, if the page or the window offers it."""
        perform = self.page.actions.get(action or "") or self.actions.get(action or "")
        if perform is not None:
            perform()

    def fit(self, surface: pygame.Surface | None) -> None:
        """Adapt the window to a new size of its display surface."""
        if surface is None:
            return
        self.surface = not_too_small(surface)
        self.size = self.surface.get_size()


def page_of(host: App, name_or_path: str, leave: Callable[[], None]) -> Page:
    """Return the page for a scene or a session file. A scene is given by its name, its file, or its text.

    Raise SceneError, UserError, ValueError or OSError if no page can be made. The message is one sentence for the user.
    """
    from softcradle.sandbox.session.replay import Replay
    from softcradle.sandbox.session.session import Session
    from softcradle.sandbox.window.scene.page import ScenePage
    from softcradle.sandbox.window.scene.tools import beside_other_balls, worth_comparing

    wanted = name_or_path if name_or_path in names() else os.path.expanduser(name_or_path)
    text = sys.stdin.read() if name_or_path == STANDARD_INPUT else name_or_path
    if is_shared_text(text):
        scene = scene_from_text(text)
    elif name_or_path == STANDARD_INPUT:
        scene = parse(text, _("standard input"))
    elif wanted.lower().endswith(".npz"):
        replay = Replay.load(wanted, host.clock)
        return ScenePage(host, replay.session, leave, replay)
    else:
        scene = load(wanted)
    session = Session(scene, clock=host.clock)
    if host.explore and host.settings.beside and worth_comparing(session):
        return ScenePage(host, Session(beside_other_balls(session), clock=host.clock), leave, alone=scene)
    return ScenePage(host, session, leave)


def _wait() -> list[pygame.Event]:
    """Return the events that arrive within LONGEST_WAIT milliseconds, or an empty list."""
    first = pygame.event.wait(LONGEST_WAIT)
    return [] if first.type == pygame.NOEVENT else [first, *pygame.event.get()]


@contextmanager
def _ending_at_signals(app: App) -> Iterator[None]:
    """End the main loop when the process receives a signal to stop. A film that is being recorded is still written."""

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
