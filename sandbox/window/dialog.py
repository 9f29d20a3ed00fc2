"""Overlays over a page: menus, questions with buttons, and dialogs with text fields."""

from __future__ import annotations

import locale
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import ClassVar

import pygame
import pygame_gui
from pygame_gui.core.utility import set_default_manager
from pygame_gui.elements import UIButton
from pygame_gui.windows import UIFileDialog
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import paragraphs, shortened, width, write
from softcradle.sandbox.languages import _
from softcradle.sandbox.window import theme
from softcradle.sandbox.window.keys import binding_of, hint
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.widgets import PRESS, TextBox, TextEntry

POINTER_EVENTS = (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP, pygame.MOUSEMOTION, pygame.MOUSEWHEEL)
KEY_EVENTS = (pygame.KEYDOWN, pygame.KEYUP, pygame.TEXTINPUT)


class Overlay:
    """A box with widgets. While it is open, it receives every key and click.

    Attributes:
        open: True while the overlay is visible.
        manager: manager of the overlay's widgets.
        box: rectangle of the overlay.
        focus: index of the choice that Enter selects; -1 if none is preselected.
        choice_count: number of choices.
        steps: keys that move the focus, with the number of choices by which each key moves it.
    """

    focus, choice_count = 0, 0
    steps: ClassVar[Mapping[int, int]] = {}

    def __init__(self, host: Host) -> None:
        self.host, self.open = host, True
        self.box = pygame.Rect(0, 0, 0, 0)
        self.build()

    def build(self) -> None:
        """Create the widgets. It is called again when the window has changed."""
        self.manager = theme.manager(self.host.size, self.host.unit)
        self.make_widgets()

    def make_widgets(self) -> None:
        """Set the position of the box and create its widgets."""
        raise NotImplementedError

    def take_choice(self) -> None:
        """Perform the choice that has the focus."""

    def key(self, event: pygame.Event) -> None:
        """Handle a pressed key: arrows and Tab move the focus, Enter selects, Esc closes."""
        step = self.steps.get(event.key)
        if event.key == pygame.K_ESCAPE:
            self.close()
        elif event.key in PRESS and self.focus >= 0:
            self.take_choice()
        elif step is not None:
            self.focus = ((max(self.focus, 0) if step < 0 else self.focus) + step) % self.choice_count

    def handle(self, event: pygame.Event) -> bool:
        """Handle every key and click, so that the page below receives none. Return True if the event was used."""
        if event.type == pygame.KEYDOWN:
            self.key(event)
        elif event.type in (*KEY_EVENTS, *POINTER_EVENTS):
            self.manager.process_events(event)
        return event.type in (*KEY_EVENTS, *POINTER_EVENTS)

    def update(self, seconds: float) -> None:
        """Advance the widgets by `seconds`."""
        self.manager.update(seconds)

    def close(self) -> None:
        """Close the overlay."""
        self.open = False
        # Restore the default manager. Otherwise pygame_gui would keep the manager of the overlay as its default.
        set_default_manager(self.host.manager)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the overlay over the page."""
        self.manager.draw_ui(surface)


LEAST_WIDTH = 200.0  # Smallest width of a menu column in design pixels.
MENU_ROW = 30.0  # Height of a menu entry in design pixels.


class Menu(Overlay):
    """A menu of actions. A click outside or Esc closes the menu.

    The entries are the actions `names`. Entries in `ticked` have a check mark.

    Attributes:
        buttons: the buttons of the entries, from top to bottom.
    """

    steps: ClassVar[Mapping[int, int]] = {pygame.K_DOWN: 1, pygame.K_TAB: 1, pygame.K_UP: -1}

    def __init__(self, host: Host, corner: tuple[int, int], names: Sequence[str], ticked: Sequence[str] = ()) -> None:
        self.corner, self.names, self.ticked, self.choice_count = corner, names, ticked, len(names)
        self.buttons: list[UIButton] = []
        super().__init__(host)

    def make_widgets(self) -> None:
        """Place the menu below its button and create the entries."""
        unit, row, margin = self.host.unit, round(MENU_ROW * self.host.unit), round(6 * self.host.unit)
        columns = max(1, -(-row * len(self.names) // (self.host.size[1] - self.corner[1] - 2 * margin)))
        rows, texts = -(-len(self.names) // columns), [_(binding_of(name).text) for name in self.names]
        needed = (width(hint(name), 13 * unit) + round(70 * unit) for name in self.names)
        wide = min(max(round(LEAST_WIDTH * unit), *needed), self.host.size[0] // columns)
        self.box = pygame.Rect(0, 0, columns * wide, row * rows + 2 * margin)
        self.box.topright = self.corner
        self.box.clamp_ip(pygame.Rect((0, 0), self.host.size))
        left, top = self.box.left + margin, self.box.top + margin
        self.buttons = [
            UIButton(
                pygame.Rect(left + k // rows * wide, top + k % rows * row, wide - 2 * margin, row),
                f"{'✓' if name in self.ticked else '   '}  {text}",
                self.manager,
                object_id="#menu_row",
                command=partial(self.choose, name),
            )
            for k, (name, text) in enumerate(zip(self.names, texts, strict=True))
        ]

    def choose(self, name: str) -> None:
        """Close the menu and perform the action `name`."""
        self.close()
        self.host.act(name)

    def handle(self, event: pygame.Event) -> bool:
        """Close the menu if the mouse is pressed outside. Other events are handled as in every overlay."""
        if event.type == pygame.MOUSEBUTTONDOWN and not self.box.collidepoint(event.pos):
            self.close()
        return super().handle(event)

    def take_choice(self) -> None:
        """Perform the action of the entry that has the focus."""
        self.choose(self.names[self.focus])

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the box, the entries, and the ring around the entry that Enter selects."""
        pygame.draw.rect(surface, tones.background, self.box, border_radius=6)
        pygame.draw.rect(surface, tones.faint, self.box, max(1, round(1.5 * self.host.unit)), border_radius=6)
        super().paint(surface)
        for name, button in zip(self.names, self.buttons, strict=True):
            size, place = 13 * self.host.unit, (button.rect.right - 10 * self.host.unit, button.rect.centery)
            keys = str(binding_of(name).keys[0])
            if width(button.text + keys, size) + 3 * size < button.rect.width:
                write(surface, keys, place, size, tones.muted, align=(1, 0.5))
        pygame.draw.rect(surface, tones.foreground, self.buttons[self.focus].rect, 2, border_radius=4)


WIDTH = 560.0  # Width of a dialog in design pixels.
MARGIN = 24.0  # Margin inside the dialog box in design pixels.
LINE = 22.0  # Height of a line of the note in design pixels.
ROW = 36.0  # Height of a row with a button or a text field, in design pixels.
RECENT = 26.0  # Height of a recent path in design pixels.
LONG = 64.0  # Height of a text field with several lines, in design pixels.
SHADE_OPACITY = 110  # Opacity of the shade over the page, from 0 to 255.
STEPS = {pygame.K_TAB: 1, pygame.K_LEFT: 1, pygame.K_DOWN: 1, pygame.K_RIGHT: -1, pygame.K_UP: -1}
Choices = Mapping[str, Callable[[], object]]


class Dialog(Overlay):
    """A question with buttons. Each button closes the dialog and calls its function. Enter presses the first button;
    Esc only closes.

    Arguments:
        neutral: if True, no button is preselected, and Enter has no effect until an arrow key is pressed.

    Attributes:
        buttons: the buttons, by their text.
    """

    steps: ClassVar[Mapping[int, int]] = STEPS
    body = 0.0  # Height in design pixels that a subclass needs between the note and the buttons.

    def __init__(self, host: Host, title: str, note: str, choices: Choices, neutral: bool = False) -> None:
        self.title, self.note, self.choices, self.neutral = title, note, choices, neutral
        self.focus, self.choice_count = -1 if neutral else 0, len(choices)
        self.buttons: dict[str, UIButton] = {}
        super().__init__(host)

    def _lines(self) -> list[str]:
        return paragraphs(self.note, 16 * self.host.unit, (WIDTH - 2 * MARGIN) * self.host.unit)

    def make_widgets(self) -> None:
        """Place the dialog in the middle of the page.

        The buttons are placed side by side, with the first one on the right. Wide buttons are placed below each other.
        """
        unit, (page_width, height) = self.host.unit, self.host.size
        widths = [max(90.0 * unit, width(text, 13 * unit) + 26 * unit) for text in self.choices]
        stacked = self.neutral or sum(widths) + 8 * unit * len(widths) > (WIDTH - 2 * MARGIN) * unit
        rows = LINE * len(self._lines()) + self.body + ROW * (len(widths) if stacked else 1)
        self.box = pygame.Rect(0, 0, round(WIDTH * unit), round((3.0 * MARGIN + 20.0 + rows) * unit))
        self.box.center = (page_width // 2, round(0.4 * height))
        self.box.clamp_ip(pygame.Rect((0, 0), self.host.size))
        self.inner = self.box.inflate(-2 * round(MARGIN * unit), -2 * round(MARGIN * unit))
        # Vertical position of the space between the note and the buttons.
        self.head = self.inner.top + round((36.0 + LINE * len(self._lines())) * unit)
        right, y = self.inner.right, self.inner.bottom - round(ROW * unit) * (len(widths) if stacked else 1)
        for k, (text, command) in enumerate(self.choices.items()):
            wide = self.inner.width if stacked else round(widths[k])
            place = pygame.Rect(right - wide, y + round(6 * unit), wide, round(30 * unit))
            style = "#primary" if k == 0 and not self.neutral else None
            self.buttons[text] = UIButton(
                place, text, self.manager, object_id=style, command=partial(self.choose, command)
            )
            right, y = (right, y + round(ROW * unit)) if stacked else (place.left - round(8 * unit), y)

    def choose(self, command: Callable[[], object]) -> None:
        """Close the dialog and call the chosen function."""
        self.close()
        command()

    def take_choice(self) -> None:
        """Press the button that has the focus."""
        self.choose(list(self.choices.values())[self.focus])

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the shade over the page, the box, its widgets, and the ring around the button that Enter presses."""
        unit = self.host.unit
        paint_box(surface, self.box, unit)
        x, y = self.inner.topleft
        write(surface, self.title, (x, y), 16 * unit, tones.foreground, bold=True)
        for k, line in enumerate(self._lines()):
            write(surface, line, (x, y + (30 + LINE * k) * unit), 16 * unit, tones.foreground)
        super().paint(surface)
        self.paint_ring(surface)

    def paint_ring(self, surface: pygame.Surface) -> None:
        """Draw the ring around the button that Enter presses."""
        if self.focus >= 0:
            button = list(self.buttons.values())[self.focus]
            pygame.draw.rect(surface, tones.foreground, button.rect.inflate(6, 6), 2, border_radius=6)


def paint_box(surface: pygame.Surface, box: pygame.Rect, unit: float) -> None:
    """Dim the page and draw an empty box over it."""
    shade = pygame.Surface(surface.get_size())
    shade.fill(tones.shadow)
    shade.set_alpha(SHADE_OPACITY)
    surface.blit(shade, (0, 0))
    pygame.draw.rect(surface, tones.background, box, border_radius=round(8 * unit))
    pygame.draw.rect(surface, tones.faint, box, max(1, round(2 * unit)), border_radius=round(8 * unit))


class EntryDialog(Dialog):
    """A dialog with text fields. The OK button calls `take` with the text of each field, by name.

    Arguments:
        fields: initial text of each field, by name. The name of a single field is not shown.
        recent: paths of recent files, offered below the fields.
        more: further buttons.
        long: name of the field that has several lines.
    """

    def __init__(
        self,
        host: Host,
        title: str,
        note: str,
        fields: Mapping[str, str],
        take: Callable[[dict[str, str]], None],
        recent: Sequence[str] = (),
        more: Choices | None = None,
        long: str = "",
    ) -> None:
        self.texts, self.take, self.recent, self.long = dict(fields), take, tuple(recent), long
        self.rows: list[UIButton] = []
        self.entries: dict[str, TextEntry | TextBox] = {}
        self.body = ROW * len(fields) + (LONG - 28.0 if long else 0.0) + RECENT * len(self.recent) + 8.0
        choices: Choices = {_("OK"): self._finish, **(more or {}), _("Cancel"): lambda: None}
        super().__init__(host, title, note, choices)

    @property
    def entry(self) -> TextEntry | TextBox:
        """The text field that has the focus."""
        return next((one for one in self.entries.values() if one.is_focused), next(iter(self.entries.values())))

    def make_widgets(self) -> None:
        """Create the buttons and the text fields above them."""
        super().make_widgets()
        unit, typed = self.host.unit, next((k for k, one in enumerate(self.entries.values()) if one.is_focused), 0)
        names = [width(name, 13 * unit) for name in self.texts]
        self.indent = round(max(names) + 12 * unit) if len(names) > 1 else 0
        y, row = self.head, round(RECENT * unit)
        for name, text in self.texts.items():
            high = round((LONG if name == self.long else 28.0) * unit)
            place = pygame.Rect(self.inner.left + self.indent, y, self.inner.width - self.indent, high)
            kind = TextBox if name == self.long else TextEntry
            self.entries[name] = kind(place, manager=self.manager, initial_text=text)
            self.entries[name].edit_position = len(text)
            y += high + round(8 * unit)
        self.rows = [
            UIButton(
                pygame.Rect(self.inner.left, y + k * row, self.inner.width, row),
                shortened_path(path, 13 * unit, self.inner.width - 20 * unit),
                self.manager,
                object_id="#menu_row",
                tool_tip_text=path,
                command=partial(self.choose, partial(self.take, dict.fromkeys(self.texts, path))),
            )
            for k, path in enumerate(self.recent)
        ]
        self._go_to(typed)

    def _go_to(self, k: int) -> None:
        """Give the focus to text field `k`."""
        for one in self.entries.values():
            one.unfocus()
        entry = list(self.entries.values())[k % len(self.entries)]
        entry.focus()
        self.manager.set_focus_set({entry})

    def handle(self, event: pygame.Event) -> bool:
        """Handle every key and click. Store the typed texts, because the fields may be rebuilt."""
        taken = super().handle(event)
        self.texts = {name: str(entry.get_text()) for name, entry in self.entries.items()}
        return taken

    def key(self, event: pygame.Event) -> None:
        """Handle a pressed key. Enter presses OK, Tab goes to the next field, Up and Down insert a recent path, Esc
        closes.
        """
        entries = list(self.entries.values())
        if event.key == pygame.K_ESCAPE:
            self.close()
        elif event.key in (pygame.K_RETURN, pygame.K_KP_ENTER):
            self.choose(self._finish)
        elif event.key == pygame.K_TAB:
            self._go_to(entries.index(self.entry) + (-1 if event.mod & pygame.KMOD_SHIFT else 1))
        elif event.key in (pygame.K_UP, pygame.K_DOWN) and self.recent:
            by, text = 1 if event.key == pygame.K_DOWN else -1, self.entry.get_text()
            present = self.recent.index(text) + by if text in self.recent else (0 if by > 0 else -1)
            self.entry.set_text(self.recent[present % len(self.recent)])
        else:
            self.manager.process_events(event)

    def _finish(self) -> None:
        found = {name: str(entry.get_text()).strip().replace("\n", " ") for name, entry in self.entries.items()}
        if any(found.values()):
            self.take(found)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the dialog and the names of the fields."""
        super().paint(surface)
        for name, entry in self.entries.items() if self.indent else ():
            place = (self.inner.left, entry.rect.centery)
            write(surface, name, place, 13 * self.host.unit, tones.foreground, align=(0, 0.5))

    def paint_ring(self, surface: pygame.Surface) -> None:
        """Draw no ring: the text field has the focus."""


@contextmanager
def _plain_locale() -> Iterator[None]:
    """Use the locale C inside a `with` block. pygame_gui would set the locale of the environment, even one that is not
    installed.
    """
    used, wished = locale.setlocale(locale.LC_ALL), os.environ.get("LC_ALL")
    os.environ["LC_ALL"] = "C"
    try:
        yield
    finally:
        locale.setlocale(locale.LC_ALL, used)
        if wished is None:
            del os.environ["LC_ALL"]
        else:
            os.environ["LC_ALL"] = wished


class FileChooser(Overlay):
    """The file dialog of pygame_gui. It calls `take` with the chosen path."""

    def __init__(self, host: Host, title: str, endings: set[str], take: Callable[[str], None]) -> None:
        self.title, self.endings, self.take = title, endings, take
        super().__init__(host)

    def make_widgets(self) -> None:
        """Create the file dialog in the middle of the page."""
        wide, high = self.host.size
        self.box = pygame.Rect(
            0, 0, min(wide - 20, round(640 * self.host.unit)), min(high - 20, round(480 * self.host.unit))
        )
        self.box.center = wide // 2, high // 2
        folder = str(Path.cwd())
        with _plain_locale():
            self.window = UIFileDialog(
                self.box, self.manager, self.title, self.endings, folder, allow_picking_directories=False
            )

    def key(self, event: pygame.Event) -> None:
        """Handle a pressed key: letters type a file name, Esc closes."""
        if event.key == pygame.K_ESCAPE:
            self.close()
        else:
            self.manager.process_events(event)

    def handle(self, event: pygame.Event) -> bool:
        """Handle every key and click, and the events that end the file dialog."""
        if event.type == pygame_gui.UI_FILE_DIALOG_PATH_PICKED and event.ui_element is self.window:
            self.close()
            self.take(str(event.text))
            return True
        if event.type == pygame_gui.UI_WINDOW_CLOSE and event.ui_element is self.window:
            self.close()
            return True
        if event.type >= pygame.USEREVENT and self.manager.process_events(event):
            return True
        return super().handle(event)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the file dialog over the dimmed page."""
        paint_box(surface, self.box, self.host.unit)
        super().paint(surface)


def shortened_path(path: str, size: float, room: float) -> str:
    """Return `path`, cut at its start if it is wider than `room` pixels. The end stays, because it distinguishes files."""
    return path if width(path, size) <= room else shortened(path[::-1], size, room)[::-1]
