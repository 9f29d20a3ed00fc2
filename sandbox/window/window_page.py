"""The protocols between the window, its pages, its loop and the routing of its events."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Protocol

import pygame
import pygame_gui
from pygame_gui.core import UIElement
from softcradle.sandbox.window.kernel_warmup import KernelWarmup
from softcradle.sandbox.window.messages import Messages
from softcradle.sandbox.window.settings import Settings


class Host(Protocol):
    """The window as its pages see it.

    Attributes:
        size: pixels.
        unit: pixels that a pixel of the 1280x720 design is.
        manager: of the widgets; a new one after every change of size or unit.
        messages: those on screen.
        warmup: the thread behind the window.
        settings: what is kept from one start to the next.
        surface: what is drawn on.
        clock: wall time [s], by which physics and plots of a frame end when the frame's time is used up.
        explore: whether it is at its first level, with few controls.
    """

    explore: bool
    surface: pygame.Surface
    size: tuple[int, int]
    unit: float
    manager: pygame_gui.UIManager
    messages: Messages
    warmup: KernelWarmup
    settings: Settings
    clock: Callable[[], float]

    @property
    def pointer(self) -> tuple[int, int]:
        """Place of the mouse; on nothing where a dialog lies over the page."""

    def quit(self, killed: bool = False) -> None:
        """End at the end of this frame; what is unsaved is kept for the next start where the window is `killed`."""

    def rebuild(self) -> None:
        """Make all widgets anew."""

    def show(self, page: Page) -> None:
        """Bring `page` on screen."""

    def act(self, action: str | None) -> None:
        """Do an action of the table of keys, if the page or the window has it."""

    def toggle_help(self) -> None:
        """Show or hide the help overlay."""

    def toggle_level(self) -> None:
        """Go from few controls to all of them, or back."""

    def ask(self, title: str, note: str, text: str, take: Callable[[str], None]) -> None:
        """Ask the user for a line of text, beginning with `text`."""

    def put_over(self, modal: Modal) -> None:
        """Put a dialog or a menu over the page, in place of the present one."""

    def choose(self, title: str, note: str, choices: Mapping[str, Callable[[], object]]) -> None:
        """Ask the user a question with a button for each of the choices."""


class Page(Protocol):
    """One of the window's pages. `actions` are those of the table of keys that it offers."""

    actions: dict[str, Callable[[], None]]

    @property
    def title(self) -> str:
        """What the frame of the window calls it; empty for the gallery."""

    @property
    def unsaved(self) -> bool:
        """Whether leaving it loses edits; it then has the action "save_scene"."""

    @property
    def moving(self) -> bool:
        """Whether the next picture differs from this one though nobody does anything."""

    @property
    def typing(self) -> bool:
        """Whether keys go into a text field."""

    def call_unsaved(self) -> None:
        """Call what it shows unsaved, where that can be."""

    def cancel_typing(self) -> None:
        """Drop what is being typed: keys are keys of the window again."""

    def build(self) -> None:
        """Make the widgets for the host's size and unit; the old ones are gone."""

    def follow(self) -> None:
        """Let what is drawn be of the present state: before each event, for the one before it may be of the same frame."""

    def handle(self, event: pygame.Event) -> bool:
        """Take an event that no widget took; whether the page used it."""

    def take_file(self, path: str, point: tuple[int, int]) -> bool:
        """Take a file that was dropped at `point`; False where it is to be opened."""

    def update(self, seconds: float) -> None:
        """Let `seconds` of wall time pass."""

    def paint(self, surface: pygame.Surface) -> None:
        """Draw all but the widgets."""

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw what lies above the widgets."""

    def after_frame(self, surface: pygame.Surface, seconds: float) -> None:
        """Use the finished picture, `seconds` after the last one."""

    def close(self) -> None:
        """Close what is open: the page is being left."""


class Modal(Protocol):
    """What lies over a page and takes its events while it is open."""

    open: bool

    def build(self) -> None:
        """Make the widgets; again when the window has changed."""

    def close(self) -> None:
        """Remove it."""

    def update(self, seconds: float) -> None:
        """Let time pass."""

    def paint(self, surface: pygame.Surface) -> None:
        """Draw it over the page."""

    def handle(self, event: pygame.Event) -> bool:
        """Take an event; whether the page must not get it."""


class Focus(Protocol):
    """What gives keys to the control that has the focus."""

    @property
    def control(self) -> UIElement | None:
        """The control that has the focus."""

    @property
    def typed(self) -> UIElement | None:
        """The line in which is being typed."""

    def hide_tooltip(self, point: tuple[int, int]) -> None:
        """Take away what the control at `point` says of itself."""

    def close_list(self) -> bool:
        """Close the list of a menu; whether one was open."""

    def handle(self, event: pygame.Event) -> bool:
        """Give a key to the control; whether it took it."""


class Reader(Protocol):
    """What speaks for the window."""

    def take_focus(self, focused: bool) -> None:
        """Tell the system whether the window has the keyboard."""


class Window(Host, Protocol):
    """The window as its loop and the routing of its events see it.

    Attributes:
        running: whether the loop goes on.
        minimised: whether nothing is shown.
        help: whether the help overlay is shown.
    """

    running: bool
    minimised: bool
    help: bool

    @property
    def page(self) -> Page:
        """What is on screen."""

    @property
    def reader(self) -> Reader:
        """What speaks for the window."""

    @property
    def focus(self) -> Focus:
        """Which control has the keyboard."""

    @property
    def dialog(self) -> Modal | None:
        """What lies over the page."""

    @property
    def still(self) -> bool:
        """Whether no frame need be drawn before the next event."""

    def frame(self, seconds: float, events: Iterable[pygame.Event] | None = None) -> None:
        """One frame."""

    def pass_time(self, seconds: float) -> None:
        """Let time pass without a frame."""

    def open(self, name_or_path: str) -> None:
        """Open a scene or a file."""

    def fit(self, surface: pygame.Surface | None) -> None:
        """Follow a new size of the display."""

    def close(self) -> None:
        """Close everything."""
