"""A card a lane: the method that moves it, and the badge that says how far it can be trusted."""

from __future__ import annotations

import math

import pygame
import pygame_gui
from pygame_gui.elements import UIDropDownMenu
from softcradle.physics import METHODS
from softcradle.sandbox.draw.number_format import scientific
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, FOREGROUND, GOOD, MUTED, Colour, mix
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.session.health import BAD, FAIR, Health
from softcradle.sandbox.session.health import GOOD as GOOD_LEVEL
from softcradle.sandbox.session.inputs import SetMethod
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.window_page import Host

RED: Colour = (176, 18, 38)
AMBER: Colour = (158, 98, 0)
AUTO = "auto"
HIGH, HIGH_OF_TWO = 186.0, 137.0  # design pixels of a card
SECONDS_BETWEEN_READINGS = 0.2
SUMMARIES = {method.name: method.summary for method in METHODS}


class Cards:
    """The cards of all lanes; `apply` hands a SetMethod to the session and says whether it was taken."""

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        self.rects: list[pygame.Rect] = []
        self.menus: list[UIDropDownMenu] = []
        self.health: list[Health] = []
        self._waited = math.inf

    def build(self, rect: pygame.Rect) -> pygame.Rect:
        """Make the menus at the top of `rect`; returns what is left of it."""
        unit = self.host.unit
        high = round((HIGH if len(self.session.lanes) == 1 else HIGH_OF_TWO) * unit)
        lanes = range(len(self.session.lanes)) if rect.width else range(0)
        self.rects = [pygame.Rect(rect.left, rect.top + k * (high + round(8 * unit)), rect.width, high) for k in lanes]
        self.menus = [self._menu(k) for k in lanes]
        used = len(self.rects) * (high + round(8 * unit))
        return pygame.Rect(rect.left, rect.top + used, rect.width, rect.height - used)

    def _menu(self, lane: int) -> UIDropDownMenu:
        unit, rect = self.host.unit, self.rects[lane]
        wide = round(132 * unit)
        place = pygame.Rect(rect.right - wide - round(8 * unit), rect.top + round(8 * unit), wide, round(26 * unit))
        return UIDropDownMenu([AUTO, *(m.name for m in METHODS)], self.method(lane), place, self.host.manager)

    def method(self, lane: int) -> str:
        """The entry of the menu that holds now."""
        setup = self.session.lanes[lane].setup
        return AUTO if setup.automatic else setup.method

    def next_method(self) -> str:
        """The method after the one of the first lane."""
        names = [AUTO, *(m.name for m in METHODS)]
        return names[(names.index(self.method(0)) + 1) % len(names)]

    def handle(self, event: pygame.Event) -> SetMethod | None:
        """The input that a chosen entry means."""
        if event.type == pygame_gui.UI_DROP_DOWN_MENU_CHANGED and event.ui_element in self.menus:
            return SetMethod(self.menus.index(event.ui_element), event.text)
        return None

    def update(self, seconds: float) -> None:
        """Look after the health of every lane, now and then."""
        self._waited += seconds
        if self._waited >= SECONDS_BETWEEN_READINGS:
            self._waited = 0.0
            self.read()

    def read(self) -> None:
        """Look now."""
        self.health = [self.session.health(lane) for lane in range(len(self.session.lanes))]

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the badges."""
        for number, (rect, health) in enumerate(zip(self.rects, self.health, strict=False)):
            self._card(surface, rect, health, number)

    def _card(self, surface: pygame.Surface, rect: pygame.Rect, health: Health, number: int) -> None:
        unit, label = self.host.unit, self.session.lanes[number].label
        tint = RED if health.level == BAD else AMBER if health.level == FAIR else GOOD
        pygame.draw.rect(surface, mix(BACKGROUND, tint, 0.16 if health.level == BAD else 0.05), rect, border_radius=6)
        pygame.draw.rect(
            surface, tint if health.level != "good" else FAINT, rect, max(1, round(1.5 * unit)), border_radius=6
        )
        x, y = rect.left + 10 * unit, rect.top + 12 * unit
        room = rect.width - 160 * unit
        title = label if len(self.session.lanes) > 1 and label else "method"
        write(surface, shortened(title, 14 * unit, room, bold=True), (x, y), 14 * unit, FOREGROUND, bold=True)
        setup = self.session.lanes[number].setup
        step = setup.step_for(self.session.setup.frame_time)
        how = f"{setup.method}, step {scientific(step)} s" if step else f"{setup.method}, adaptive"
        y += 26 * unit
        write(surface, how, (x, y), 12 * unit, MUTED)
        y += 17 * unit
        if len(self.rects) == 1:
            summary = SUMMARIES[setup.method]
            write(surface, shortened(summary, 12 * unit, rect.width - 20 * unit), (x, y), 12 * unit, MUTED)
            y += 19 * unit
        y = self._numbers(surface, rect, _numbers(health), y)
        mark = "✓" if health.level == GOOD_LEVEL else "!"
        write(surface, mark, (x, y + 2 * unit), 13 * unit, tint, bold=True)
        lines = wrapped(health.sentence, 12 * unit, rect.width - 34 * unit)
        most = int((rect.bottom - y) // (15 * unit))
        for k, line in enumerate(lines[:most]):
            text = shortened(line + " …", 12 * unit, rect.width - 34 * unit) if k == most - 1 < len(lines) - 1 else line
            write(surface, text, (x + 15 * unit, y + (2 + 15 * k) * unit), 12 * unit, tint)

    def _numbers(self, surface: pygame.Surface, rect: pygame.Rect, numbers: list[tuple[str, str]], y: float) -> float:
        """One a line; two where there are two cards. Returns where the next line is."""
        unit, columns = self.host.unit, 1 if len(self.rects) == 1 else 2
        wide = (rect.width - 20 * unit) / columns
        for k, (name, text) in enumerate(numbers):
            x = rect.left + 10 * unit + (k % columns) * wide
            short = name.split()[0] if columns == 2 else name
            write(surface, short, (x, y), 12.5 * unit, MUTED)
            write(
                surface,
                text,
                (x + wide - (8 * unit if columns == 2 and k % 2 == 0 else 0), y),
                12.5 * unit,
                FOREGROUND,
                align=(1, 0),
            )
            y += 16.5 * unit if k % columns == columns - 1 else 0.0
        return y


def _numbers(health: Health) -> list[tuple[str, str]]:
    """Names and values of the badge."""
    return [
        ("energy error", _error(health.energy_error)),
        ("momentum error", _error(health.momentum_error)),
        ("chatter", f"{health.chatter:.1f}" if health.chatter < 1e4 else scientific(health.chatter)),
        ("physics a frame", f"{health.milliseconds:.2f} ms"),
    ][:4]


def _error(error: float | None) -> str:
    if error is None:
        return "wall or bed takes it"
    return scientific(error) if error >= 1e-17 else "0"
