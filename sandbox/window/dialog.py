"""Dialogs: a box over the dimmed page; a question with buttons, or one line to type."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import pygame
import pygame_gui
from pygame_gui.core import UIElement
from pygame_gui.elements import UIButton, UITextEntryLine
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import width, wrapped, write
from softcradle.sandbox.languages import _
from softcradle.sandbox.window.overlay import Overlay
from softcradle.sandbox.window.window_page import Host

WIDTH = 560.0  # design pixels
STACKED = 36.0  # design pixels of a row of a choice, where they do not fit beside each other
LINE = 18.0  # design pixels of a line of the note
SHADE_OPACITY = 110  # of 255, over the page
ENTRY_ROOM = 44.0  # design pixels of the line to type
RECENT = 26.0  # design pixels of a recent file
Choices = Mapping[str, Callable[[], object]]


class Dialog(Overlay):
    """A question. Each choice closes the box and is then called; Enter takes the first, Esc calls none.

    Attributes:
        buttons: by text.
        focus: number of the button that Enter presses.
    """

    body = 0.0  # design pixels between the note and the buttons

    def __init__(self, host: Host, title: str, note: str, choices: Choices) -> None:
        self.title, self.note, self.choices, self.focus = title, note, choices, 0
        self.buttons: dict[str, UIButton] = {}
        super().__init__(host)

    def _lines(self) -> list[str]:
        return wrapped(self.note, 12.5 * self.host.unit, (WIDTH - 40.0) * self.host.unit)

    def make_widgets(self) -> None:
        """Take a place in the middle of the page and make the buttons, the first choice on the right."""
        unit, (page_width, height) = self.host.unit, self.host.size
        widths = [max(90.0 * unit, width(text, 13 * unit) + 26 * unit) for text in self.choices]
        stacked = sum(widths) + 8 * unit * len(widths) > (WIDTH - 40.0) * unit
        rows = LINE * len(self._lines()) + self.body + (STACKED * (len(widths) - 1) if stacked else 0.0)
        self.box = pygame.Rect(0, 0, round(WIDTH * unit), round((96.0 + rows) * unit))
        self.box.center = (page_width // 2, round(0.4 * height))
        self.box.clamp_ip(pygame.Rect((0, 0), self.host.size))
        right, y = self.box.right - round(20 * unit), self.box.bottom - round(44 * unit)
        y -= round(STACKED * unit) * (len(widths) - 1) if stacked else 0
        for k, (text, command) in enumerate(self.choices.items()):
            wide = self.box.width - round(40 * unit) if stacked else round(widths[k])
            place = pygame.Rect(right - wide, y, wide, round(30 * unit))
            style = "#primary" if k == 0 and not stacked else None
            self.buttons[text] = UIButton(
                place, text, self.manager, object_id=style, command=partial(self.choose, command)
            )
            if stacked:
                y += round(STACKED * unit)
            else:
                right -= wide + round(8 * unit)

    def widgets(self) -> Sequence[UIElement]:
        """The buttons."""
        return list(self.buttons.values())

    def choose(self, command: Callable[[], object]) -> None:
        """Close the box and do what was chosen."""
        self.close()
        command()

    def key(self, event: pygame.Event) -> None:
        """Arrows and Tab move, Enter takes, Esc closes."""
        commands = list(self.choices.values())
        if event.key == pygame.K_ESCAPE:
            self.close()
        elif event.key in (pygame.K_RETURN, pygame.K_KP_ENTER, pygame.K_SPACE):
            self.choose(commands[self.focus])
        elif event.key in (pygame.K_TAB, pygame.K_LEFT, pygame.K_DOWN):
            self.focus = (self.focus + 1) % len(commands)
        elif event.key in (pygame.K_RIGHT, pygame.K_UP):
            self.focus = (self.focus - 1) % len(commands)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the shade, the box, its widgets, and the ring of the button that Enter presses."""
        unit = self.host.unit
        shade = pygame.Surface(surface.get_size())
        shade.fill(tones.shadow)
        shade.set_alpha(SHADE_OPACITY)
        surface.blit(shade, (0, 0))
        pygame.draw.rect(surface, tones.background, self.box, border_radius=round(8 * unit))
        pygame.draw.rect(surface, tones.faint, self.box, max(1, round(2 * unit)), border_radius=round(8 * unit))
        x, y = self.box.left + 20 * unit, self.box.top + 12 * unit
        write(surface, self.title, (x, y), 17 * unit, tones.foreground, bold=True)
        for k, line in enumerate(self._lines()):
            write(surface, line, (x, y + (26 + LINE * k) * unit), 12.5 * unit, tones.muted)
        super().paint(surface)
        self.paint_ring(surface)

    def paint_ring(self, surface: pygame.Surface) -> None:
        """Draw the ring of the button that Enter presses."""
        button = list(self.buttons.values())[self.focus]
        pygame.draw.rect(surface, tones.foreground, button.rect.inflate(6, 6), 2, border_radius=6)


class PathDialog(Dialog):
    """A box with a line to type, most often a path; `take(text)` is called with what was typed.

    Below the line are `recent` paths to choose from.
    """

    def __init__(
        self,
        host: Host,
        title: str,
        note: str,
        text: str,
        take: Callable[[str], None],
        recent: Sequence[str] = (),
    ) -> None:
        self.text, self.take, self.recent = text, take, tuple(recent)
        self.rows: list[UIButton] = []
        self.body = ENTRY_ROOM + RECENT * len(self.recent)
        super().__init__(host, title, note, {_("OK"): self._finish, _("Cancel"): lambda: None})

    def make_widgets(self) -> None:
        """The buttons, and the line above them."""
        super().make_widgets()
        unit, left = self.host.unit, self.box.left + round(20 * self.host.unit)
        wide, row = self.box.width - round(40 * unit), round(RECENT * unit)
        y = self.box.bottom - round(88 * unit) - row * len(self.recent)
        place = pygame.Rect(left, y, wide, round(30 * unit))
        self.rows = [
            UIButton(
                pygame.Rect(left, place.bottom + round(6 * unit) + k * row, wide, row),
                shortened_path(path, 13 * unit, wide - 20 * unit),
                self.manager,
                object_id="#menu_row",
                tool_tip_text=path,
                command=partial(self.choose, partial(self.take, path)),
            )
            for k, path in enumerate(self.recent)
        ]
        self.entry = UITextEntryLine(place, self.manager, initial_text=self.text)
        self.entry.focus()
        self.manager.set_focus_set({self.entry})

    def widgets(self) -> Sequence[UIElement]:
        """The buttons, the line and the recent files."""
        return [*super().widgets(), self.entry, *self.rows]

    def handle(self, event: pygame.Event) -> bool:
        """Take every key and click, and the end of typing."""
        if event.type == pygame_gui.UI_TEXT_ENTRY_FINISHED and event.ui_element is self.entry:
            self.choose(self._finish)
            return True
        taken = super().handle(event)
        self.text = self.entry.get_text()
        return taken

    def key(self, event: pygame.Event) -> None:
        """Type; arrows up and down put recent files into the line; Esc closes."""
        if event.key == pygame.K_ESCAPE:
            self.close()
        elif event.key in (pygame.K_UP, pygame.K_DOWN) and self.recent:
            by = 1 if event.key == pygame.K_DOWN else -1
            present = self.recent.index(self.text) + by if self.text in self.recent else (0 if by > 0 else -1)
            self.text = self.recent[present % len(self.recent)]
            self.entry.set_text(self.text)
        else:
            self.manager.process_events(event)

    def _finish(self) -> None:
        text = self.entry.get_text().strip()
        if text:
            self.take(text)

    def paint_ring(self, surface: pygame.Surface) -> None:
        """The line to type has the focus."""


def shortened_path(path: str, size: float, room: float) -> str:
    """`path` without its first letters where it is wider than `room` pixels: its end tells files apart."""
    if width(path, size) <= room:
        return path
    kept = path
    while kept and width("…" + kept, size) > room:
        kept = kept[1:]
    return "…" + kept
