"""A driver that operates the real window with posted events and without a screen. The module also checks the layout of
the widgets.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable
from contextlib import nullcontext
from time import process_time
from typing import ClassVar
from unittest.mock import patch

import pygame
import pygame_gui
from pygame_gui.core import UIElement
from pygame_gui.elements import UIButton, UIDropDownMenu, UITextEntryLine, UITooltip
from softcradle.sandbox.window.app import App
from softcradle.sandbox.window.scene.editor import Pick
from softcradle.sandbox.window.scene.page import ScenePage
from softcradle.sandbox.window.settings import Settings
from softcradle.sandbox.window.widgets import Slider

from tests.helpers.drawn_text import DrawnText, drawn_texts

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
os.environ.setdefault("SDL_AUDIODRIVER", "dummy")

LONGEST = 3600.0  # Longest time [s] to wait for the compilation of kernels on a busy machine.
FRAME = 1.0 / 60.0
LONGEST_WORK = 120.0  # Processor time [s] after which a waiting test fails.


def rarely(collect: Callable[[], None], every: int = 20) -> Callable[[], None]:
    """Return a function that calls `collect` only every 20th time. Tests have a large heap, so garbage collections
    would take half of the time.
    """
    calls = itertools.count(1)
    return lambda: None if next(calls) % every else collect()


class Driver:
    """Posts keys and mouse events to an App and runs the frames of the App.

    Attributes:
        app: the window. Its clock advances only between frames, so no frame depends on the load of the machine.
        time: time of this clock [s].
    """

    opened: ClassVar[list[Driver]] = []

    def __init__(
        self,
        start: str | None = None,
        size: tuple[int, int] = (1280, 720),
        wait: bool = True,
        lab: bool = True,
        beside: bool = False,
    ) -> None:
        """Open the window. If `wait` is true, wait until all kernels are in memory. If `lab` is true, show all
        controls. If `beside` is true, the view Explore shows soft beads next to steel balls.
        """
        self.time = 0.0
        if not lab:
            Settings.load().keep(beside=beside)
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
        """Run `count` frames. Draw only the last two frames, because tests check only the end."""
        for left in range(count - 1, -1, -1):
            self._frame(drawn=left < 2)

    def _frame(self, drawn: bool = True) -> None:
        with nullcontext() if drawn else patch.object(self.app, "paint", lambda: None):
            self.app.frame(FRAME)
        self.time += FRAME

    def until(self, found: Callable[[], object], most: int = 0) -> None:
        """Run frames until `found` is true, but at most `most` frames. If `most` is 0, wait for a background thread of
        the window.
        """
        end, count = process_time() + LONGEST_WORK, 0
        while not found():
            assert count < most if most else process_time() < end, "nothing came"
            count += 1
            self._frame(drawn=False)
            if not most:
                pygame.time.wait(2)
        self.frames()

    def run(self, count: int) -> None:
        """Press the space bar to play or pause. Then run `count` frames."""
        self.key(pygame.K_SPACE)
        self.frames(count)

    def play(self, count: int) -> None:
        """Play `count` frames, then pause."""
        self.run(count)
        self.key(pygame.K_SPACE)

    def play_to_the_end(self) -> None:
        """Play until the card with the outcome appears below the beads."""
        if not self.session.playing:
            self.key(pygame.K_SPACE)
        self.until(lambda: self.page.outcome.text, most=900)
        self.frames(2)

    def choose(self, menu: UIDropDownMenu, text: str) -> None:
        self.post(pygame_gui.UI_DROP_DOWN_MENU_CHANGED, ui_element=menu, text=text)

    def key(self, code: int, modifiers: int = 0, text: str = "", times: int = 1) -> None:
        for _ in range(times):
            for event in pressed(code, modifiers, text):
                pygame.event.post(event)
            self.frames(2)  # Run two frames, because widgets post events themselves.

    def type(self, text: str) -> None:
        for letter in text:
            self.key(ord(letter), 0, letter)

    def move(self, point: tuple[float, float], buttons: tuple[int, int, int] = (0, 0, 0)) -> None:
        place = (round(point[0]), round(point[1]))
        pygame.mouse.set_pos(place)
        pygame.event.clear(pygame.MOUSEMOTION)  # The event that the system posts has wrong mouse buttons.
        self.app.manager.mouse_position = place
        pygame.event.post(pygame.Event(pygame.MOUSEMOTION, pos=place, rel=(0, 0), buttons=buttons))
        self.frames()

    def press(self, point: tuple[float, float]) -> None:
        self.move(point)
        self._turn(pygame.MOUSEBUTTONDOWN, point)

    def release(self, point: tuple[float, float]) -> None:
        self._turn(pygame.MOUSEBUTTONUP, point)

    def _turn(self, kind: int, point: tuple[float, float]) -> None:
        pygame.event.post(pygame.Event(kind, pos=(round(point[0]), round(point[1])), button=1))
        self.frames()

    def click(self, point: tuple[float, float]) -> None:
        self.press(point)
        self.release(point)
        self.frames(2)

    def select(self, kind: str, index: int, lane: int = 0) -> None:
        self.page.editor.selection = Pick(lane, kind, index)
        self.frames(2)

    def drag(self, start: tuple[float, float], end: tuple[float, float], steps: int = 8) -> None:
        """Press the mouse button at `start` and move the pointer to `end`. The button stays down."""
        self.press(start)
        for share in (k / steps for k in range(1, steps + 1)):
            self.move(pygame.Vector2(start).lerp(end, share), (1, 0, 0))

    def pull(self, start: tuple[float, float], end: tuple[float, float], steps: int = 8) -> None:
        self.drag(start, end, steps)
        self.release(end)

    def wheel(self, point: tuple[float, float], turn: int, buttons: tuple[int, int, int] = (0, 0, 0)) -> None:
        self.move(point, buttons)
        self.post(pygame.MOUSEWHEEL, x=0, y=turn, precise_x=0.0, precise_y=float(turn), flipped=False)

    def resize(self, size: tuple[int, int]) -> None:
        pygame.display.set_mode(size, pygame.RESIZABLE)
        self.post(pygame.VIDEORESIZE, size=size, w=size[0], h=size[1])

    def post(self, kind: int, **values: object) -> None:
        pygame.event.post(pygame.Event(kind, **values))
        self.frames(2)

    def enter(self, key: str, text: str) -> None:
        """Type `text` into the box of the number `key` in the panel and press Enter."""
        entry = (self.page.explore.controls or self.page.inspector.controls)[key].entry
        self.click(entry.rect.center)
        entry.set_text("")
        self.type(text)
        self.key(pygame.K_RETURN)

    def answer(self, text: str) -> None:
        """Type `text` into the text line of the open dialog and press Enter."""
        self.app.dialog.entry.set_text(text)
        self.key(pygame.K_RETURN)

    def texts(self) -> list[DrawnText]:
        """Return all texts that the window shows now."""
        if hasattr(self.app.page, "view"):
            self.app.page.view.backdrop.forget()
        with drawn_texts(self.app.size) as found:
            self.app.paint()
        return found

    def said(self) -> str:
        return " ".join(one.text for one in self.texts())

    def bead(self, bead: int, lane: int = 0) -> tuple[float, float]:
        return self.page.view.lanes[lane].centre(bead)

    def drop_file(self, path: object) -> None:
        self.post(pygame.DROPFILE, file=str(path))

    def close(self) -> None:
        self.app.close()
        if self in self.opened:
            self.opened.remove(self)


def pressed(code: int, modifiers: int = 0, text: str = "", times: int = 1) -> list[pygame.Event]:
    """Return the events of a key press. `times` is the number of key-down events. If `times` is more than one, the key
    is held.
    """
    values = {"key": code, "mod": modifiers, "unicode": text, "scancode": 0}
    typed = [pygame.Event(pygame.TEXTINPUT, text=text)] if text else []
    return [*[pygame.Event(pygame.KEYDOWN, values)] * times, *typed, pygame.Event(pygame.KEYUP, values)]


def widgets(driver: Driver) -> list[UIElement]:
    """Return the widgets of the open dialog, or of the page if no dialog is open. Tooltips and open lists are left out,
    because they cover other widgets on purpose.
    """
    dialog = driver.app.dialog
    if dialog is not None and dialog.open:
        found = dialog.manager.get_root_container().elements
        return [one for one in found if one.visible and isinstance(one, UIButton | UITextEntryLine)]
    shown = [one for one in driver.app.manager.get_root_container().elements if one.visible]
    tips = [one for one in shown if isinstance(one, UITooltip)]
    menus = [one.menu_states["expanded"].options_selection_list for one in shown if isinstance(one, UIDropDownMenu)]
    lists = [one for one in menus if one is not None]
    parts = [part for one in lists for part in (one, one.list_and_scroll_bar_container, one.item_list_container)]
    sliders = [one.button_container for one in shown if isinstance(one, Slider)]
    left_out = [*tips, *(tip.text_block for tip in tips), *parts, *sliders]
    return [one for one in shown if one not in left_out]


def faults(driver: Driver) -> list[str]:
    window = pygame.Rect((0, 0), driver.app.size)
    shown = widgets(driver)
    found = [f"{widget_name(one)} leaves the window: {one.rect}" for one in shown if not window.contains(one.rect)]
    alone = [one for one in shown if isinstance(one, UIButton) and one.text and one.tool_tip_text is None]
    clipped = [one for one in alone if one.font.get_rect(one.text).width > one.rect.width]
    found += [f"the text of {widget_name(one)} is clipped" for one in clipped]
    pairs = [(a, b) for a, b in itertools.combinations(shown, 2) if a.rect.colliderect(b.rect)]
    return found + [f"{widget_name(a)} {a.rect} overlaps {widget_name(b)} {b.rect}" for a, b in pairs]


def widget_name(one: UIElement) -> str:
    return f"{type(one).__name__} {getattr(one, 'text', '')!r}"
