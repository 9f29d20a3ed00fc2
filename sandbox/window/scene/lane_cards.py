"""The cards of the lanes: for each the method that moves it, and the badge that says how far it can be trusted."""

from __future__ import annotations

import math

import pygame
import pygame_gui
from pygame_gui.elements import UIDropDownMenu
from softcradle.physics import METHODS
from softcradle.sandbox.draw.number_format import scientific
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, FOREGROUND, GOOD, MUTED, Colour, mix
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.session import health
from softcradle.sandbox.session.health import Health
from softcradle.sandbox.session.inputs import SetMethod
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.scene.scene_editor import AUTO
from softcradle.sandbox.window.window_page import Host

RED: Colour = (176, 18, 38)
AMBER: Colour = (158, 98, 0)
TINTS = {health.GOOD: GOOD, health.FAIR: AMBER, health.BAD: RED}
HEIGHT = 186.0  # design pixels of the only card
HEIGHT_OF_TWO = 137.0  # design pixels of each of two cards
SECONDS_BETWEEN_READINGS = 0.2
SUMMARIES = {method.name: method.summary for method in METHODS}


class LaneCards:
    """The cards of all lanes.

    Attributes:
        rects: their rectangles.
        menus: their menus of methods.
        health: what was last read of each lane.
    """

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        self.rects: list[pygame.Rect] = []
        self.menus: list[UIDropDownMenu] = []
        self.health: list[Health] = []
        self._seconds = math.inf  # since the health was last read

    def build(self, rect: pygame.Rect) -> pygame.Rect:
        """Make the menus at the top of `rect`; returns what is left of it."""
        unit = self.host.unit
        height = round((HEIGHT if len(self.session.lanes) == 1 else HEIGHT_OF_TWO) * unit)
        pitch = height + round(8 * unit)
        lanes = range(len(self.session.lanes)) if rect.width else range(0)
        self.rects = [pygame.Rect(rect.left, rect.top + k * pitch, rect.width, height) for k in lanes]
        self.menus = [self._menu(k) for k in lanes]
        used = len(self.rects) * pitch
        return pygame.Rect(rect.left, rect.top + used, rect.width, rect.height - used)

    def _menu(self, lane: int) -> UIDropDownMenu:
        unit, rect = self.host.unit, self.rects[lane]
        width = round(132 * unit)
        place = pygame.Rect(rect.right - width - round(8 * unit), rect.top + round(8 * unit), width, round(26 * unit))
        return UIDropDownMenu([AUTO, *SUMMARIES], self.method(lane), place, self.host.manager)

    def method(self, lane: int) -> str:
        """The present entry of the menu."""
        setup = self.session.lanes[lane].setup
        return AUTO if setup.automatic else setup.method

    def next_method(self) -> str:
        """The entry after that of the first lane."""
        names = [AUTO, *SUMMARIES]
        return names[(names.index(self.method(0)) + 1) % len(names)]

    def handle(self, event: pygame.Event) -> SetMethod | None:
        """The input that a chosen entry means."""
        if event.type == pygame_gui.UI_DROP_DOWN_MENU_CHANGED and event.ui_element in self.menus:
            return SetMethod(self.menus.index(event.ui_element), event.text)
        return None

    def update(self, seconds: float) -> None:
        """Read the health of every lane now and then."""
        self._seconds += seconds
        if self._seconds >= SECONDS_BETWEEN_READINGS:
            self._seconds = 0.0
            self.health = [self.session.health(lane) for lane in range(len(self.session.lanes))]

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the badges."""
        for number, (rect, state) in enumerate(zip(self.rects, self.health, strict=False)):
            self._card(surface, rect, state, number)

    def _card(self, surface: pygame.Surface, rect: pygame.Rect, state: Health, number: int) -> None:
        unit, tint = self.host.unit, TINTS[state.level]
        fill = mix(BACKGROUND, tint, 0.16 if state.level == health.BAD else 0.05)
        pygame.draw.rect(surface, fill, rect, border_radius=6)
        border = FAINT if state.level == health.GOOD else tint
        pygame.draw.rect(surface, border, rect, max(1, round(1.5 * unit)), border_radius=6)
        y = self._method_lines(surface, rect, number)
        y = self._numbers(surface, rect, _numbers(state), y)
        self._sentence(surface, rect, state, y)

    def _method_lines(self, surface: pygame.Surface, rect: pygame.Rect, number: int) -> float:
        """The title, method and step, and on the only card a summary; returns where the next line is."""
        unit, lane = self.host.unit, self.session.lanes[number]
        x, y = rect.left + 10 * unit, rect.top + 12 * unit
        title = lane.label if len(self.session.lanes) > 1 and lane.label else "method"
        title = shortened(title, 14 * unit, rect.width - 160 * unit, bold=True)
        write(surface, title, (x, y), 14 * unit, FOREGROUND, bold=True)
        step = lane.setup.step_for(self.session.setup.frame_time)
        method = lane.setup.method
        line = f"{method}, step {scientific(step)} s" if step else f"{method}, adaptive"
        write(surface, line, (x, y + 26 * unit), 12 * unit, MUTED)
        y += 43 * unit
        if len(self.rects) == 1:
            summary = shortened(SUMMARIES[method], 12 * unit, rect.width - 20 * unit)
            write(surface, summary, (x, y), 12 * unit, MUTED)
            y += 19 * unit
        return y

    def _numbers(self, surface: pygame.Surface, rect: pygame.Rect, numbers: list[tuple[str, str]], y: float) -> float:
        """One a line, two where there are two cards; returns where the next line is."""
        unit, columns = self.host.unit, 1 if len(self.rects) == 1 else 2
        width = (rect.width - 20 * unit) / columns
        for k, (name, text) in enumerate(numbers):
            x = rect.left + 10 * unit + (k % columns) * width
            short = name.split()[0] if columns == 2 else name
            write(surface, short, (x, y), 12.5 * unit, MUTED)
            right = x + width - (8 * unit if columns == 2 and k % 2 == 0 else 0)
            write(surface, text, (right, y), 12.5 * unit, FOREGROUND, align=(1, 0))
            y += 16.5 * unit if k % columns == columns - 1 else 0.0
        return y

    def _sentence(self, surface: pygame.Surface, rect: pygame.Rect, state: Health, y: float) -> None:
        """A mark and as many lines of the sentence as there is room for."""
        unit, tint, x = self.host.unit, TINTS[state.level], rect.left + 10 * self.host.unit
        mark = "✓" if state.level == health.GOOD else "!"
        write(surface, mark, (x, y + 2 * unit), 13 * unit, tint, bold=True)
        room = rect.width - 34 * unit
        lines = wrapped(state.sentence, 12 * unit, room)
        most = int((rect.bottom - y) // (15 * unit))
        for k, line in enumerate(lines[:most]):
            text = shortened(line + " …", 12 * unit, room) if k == most - 1 < len(lines) - 1 else line
            write(surface, text, (x + 15 * unit, y + (2 + 15 * k) * unit), 12 * unit, tint)


def _numbers(state: Health) -> list[tuple[str, str]]:
    """Names and values of the badge."""
    return [
        ("energy error", _error(state.energy_error)),
        ("momentum error", _error(state.momentum_error)),
        ("chatter", f"{state.chatter:.1f}" if state.chatter < 1e4 else scientific(state.chatter)),
        ("physics a frame", f"{state.milliseconds:.2f} ms"),
    ]


def _error(error: float | None) -> str:
    if error is None:
        return "wall or bed takes it"
    return scientific(error) if error >= 1e-17 else "0"
