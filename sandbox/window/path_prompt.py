"""The path prompt: one line to type; Enter takes it, Esc cancels."""

from __future__ import annotations

from collections.abc import Callable

import pygame
import pygame_gui
from pygame_gui.elements import UIButton, UITextEntryLine
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, FOREGROUND, MUTED
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.window.window_page import Host


class PathPrompt:
    """A box over the page. `take(text)` is called once with what was typed, unless it is cancelled."""

    def __init__(self, host: Host, title: str, note: str, text: str, take: Callable[[str], None]) -> None:
        self.host, self.title, self.note, self.take = host, title, note, take
        self.text, self.open = text, True
        self.build()

    def build(self) -> None:
        """Make the widgets; again when the window has changed."""
        unit, (width, height) = self.host.unit, self.host.size
        self.box = pygame.Rect(0, 0, round(560 * unit), round(150 * unit))
        self.box.center = (width // 2, round(0.4 * height))
        left, y = self.box.left + round(20 * unit), self.box.top + round(66 * unit)
        place = pygame.Rect(left, y, self.box.width - round(40 * unit), round(30 * unit))
        self.entry = UITextEntryLine(place, self.host.manager, initial_text=self.text)
        self.entry.focus()
        self.host.manager.set_focus_set({self.entry})
        y += round(40 * unit)
        right = self.box.right - round(20 * unit)
        wide = round(90 * unit)
        place = pygame.Rect(right - wide, y, wide, round(30 * unit))
        self.ok = UIButton(place, "OK", self.host.manager, object_id="#primary", command=self.finish)
        place = pygame.Rect(right - 2 * wide - round(8 * unit), y, wide, round(30 * unit))
        self.cancel = UIButton(place, "Cancel", self.host.manager, command=self.close)

    def handle(self, event: pygame.Event) -> bool:
        """Take every key and click: the page below gets none."""
        if event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE:
            self.close()
            return True
        if event.type == pygame_gui.UI_TEXT_ENTRY_FINISHED and event.ui_element is self.entry:
            self.finish()
            return True
        if event.type in (pygame.KEYDOWN, pygame.KEYUP, pygame.TEXTINPUT):
            self.host.manager.process_events(event)
            return True
        return event.type in (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP, pygame.MOUSEMOTION, pygame.MOUSEWHEEL)

    def finish(self) -> None:
        """Take what was typed."""
        text = self.entry.get_text().strip()
        self.close()
        if text:
            self.take(text)

    def close(self) -> None:
        """Remove the box."""
        self.open = False
        self.entry.kill()
        self.ok.kill()
        self.cancel.kill()

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the box, below its widgets."""
        unit = self.host.unit
        pygame.draw.rect(surface, BACKGROUND, self.box, border_radius=round(8 * unit))
        pygame.draw.rect(surface, FAINT, self.box, max(1, round(2 * unit)), border_radius=round(8 * unit))
        x, y = self.box.left + 20 * unit, self.box.top + 12 * unit
        write(surface, self.title, (x, y), 17 * unit, FOREGROUND, bold=True)
        write(surface, self.note, (x, y + 26 * unit), 12.5 * unit, MUTED)
