"""The toolbar above a page. It contains a button to the gallery, undo and redo, and menus with less frequent actions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import pygame
from pygame_gui.elements import UIButton
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import shortened, width, write
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.session.undo import UndoStack
from softcradle.sandbox.window.dialog import Menu
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.plots.kinds import PLOT_KINDS
from softcradle.sandbox.window.scene.save_dialogs import WindowFilm

# Text of each button on the right, by action or menu. FEW lists the buttons of Explore. MENUS lists the actions of each
# menu.
BUTTONS = {
    "film": "",
    "undo": N_("Undo"),
    "redo": N_("Redo"),
    "sound": N_("Sound"),
    "share": N_("Share"),
    "plots_menu": N_("Plots"),
    "tools": N_("More"),
    "level": N_("Explore"),
    "help": N_("Help"),
}
FEW = ("film", "undo", "sound", "share", "tools", "level", "help")
MENUS: dict[str, tuple[str, ...]] = {
    "share": (
        *("save_scene", "words", "save_session", "export", "live_page", "share_page", "film"),
        *("screenshot", "copy_scene", "copy_values", "open"),
    ),
    "plots_menu": (*PLOT_KINDS, "signals", "logarithmic", "plots", "values", "data"),
    "tools": (
        *("lesson", "why", "tell", "compare", "compare_balls", "alone", "sweep", "arrows", "stopwatch", "ruler", "fit"),
        *("pause_at_end", "sound", "inspector", "larger", "smaller", "fullscreen", "theme", "language"),
    ),
}
MARGIN = 20.0  # Width in design pixels by which a button is wider than its text.
SPACE = 4.0  # Distance between two buttons in design pixels.
# Longest duration that the button of a film can show. It determines the width of the button, which does not change.
LONGEST_CLOCK = "88:88"
TITLE_LEFT = 110.0  # Left edge of the title in design pixels.
TITLE = 22.0  # Size of the title in design pixels.


class Toolbar:
    """The buttons of the toolbar, and the space between them for the title.

    Attributes:
        buttons: the buttons by action or menu.
        title_room: width between the buttons [pixels].
        ticked: function that returns the names of the visible parts, which have a check mark in the menus.
    """

    def __init__(
        self,
        host: Host,
        film: WindowFilm,
        stack: UndoStack | None = None,
        ticked: Callable[[], Sequence[str]] = lambda: (),
    ) -> None:
        self.host, self.film, self.stack, self.ticked = host, film, stack, ticked
        self.buttons: dict[str, UIButton] = {}
        self.title_room = 0.0
        self.actions = {name: partial(self.show_menu, name) for name in MENUS}

    def show_menu(self, name: str) -> None:
        """Show the available actions of a menu below its button. A menu without a button appears below the button
        "More".
        """
        known = {**self.host.actions, **self.host.page.actions}
        if names := [one for one in MENUS[name] if one in known]:
            button = self.buttons.get(name, self.buttons["tools"])
            self.host.put_over(Menu(self.host, button.rect.bottomright, names, self.ticked()))

    def build(self, rect: pygame.Rect, actions: Mapping[str, Callable[[], None]], leave: Callable[[], None]) -> None:
        """Create the buttons of the toolbar."""
        self.rect, unit, manager, height = rect, self.host.unit, self.host.manager, round(30 * self.host.unit)
        y = rect.centery - height // 2
        place = pygame.Rect(round(12 * unit), y, round(84 * unit), height)
        UIButton(
            place, "← " + _("Scenes"), manager, object_id="#flat", tool_tip_text=_("back to the gallery"), command=leave
        )
        x = rect.right - round(12 * unit)
        self.buttons = {}
        known: dict[str, Callable[[], None]] = {**actions, **self.actions}
        shown = {name: text for name, text in self._shown.items() if self._is_known(name, actions)}
        for name, usual in reversed(shown.items()):
            longest = self._stop(LONGEST_CLOCK) if name == "film" else _(usual)
            wide = round(width(longest, 13 * unit, bold=name == "film") + MARGIN * unit)
            x -= wide + round(SPACE * unit)
            place = pygame.Rect(x, y, wide, height)
            style = "#recording" if name == "film" else "#flat"
            self.buttons[name] = UIButton(
                place, longest, manager, object_id=style, tool_tip_text=hint(name), command=known[name]
            )
        self.title_room = x - (TITLE_LEFT + 10.0) * unit
        self.update()

    @property
    def _shown(self) -> dict[str, str]:
        """Action and text of each button at the present level. The button that stops a film exists only during
        recording.
        """
        few = {**{name: BUTTONS[name] for name in FEW}, "level": N_("Lab")}
        shown = few if self.host.explore else {name: text for name, text in BUTTONS.items() if name != "sound"}
        return {name: text for name, text in shown.items() if name != "film" or self.film.recording}

    def _is_known(self, name: str, actions: Mapping[str, object]) -> bool:
        """Return True if the page offers the action `name`, or any action of the menu `name`."""
        return name == "tools" or any(one in actions for one in MENUS.get(name, (name,)))

    def _stop(self, clock: str) -> str:
        """Return the text of the button that stops the film. It contains the duration `clock`."""
        return _("Stop {time}", time=clock)

    def update(self) -> None:
        """Enable the possible actions. Show the duration of a film on its button, which changes once per second."""
        if "film" in self.buttons:
            self.buttons["film"].set_text(self._stop(self.film.clock))
        stack = self.stack
        for name, steps in (("undo", stack.done), ("redo", stack.undone)) if stack is not None else ():
            button = self.buttons.get(name)
            if button is not None and bool(steps) != button.is_enabled:
                (button.enable if steps else button.disable)()

    def paint_title(self, surface: pygame.Surface, title: str) -> None:
        """Draw the title of the page between the buttons."""
        size, place = TITLE * self.host.unit, (TITLE_LEFT * self.host.unit, self.rect.centery)
        shown = shortened(title, size, self.title_room, bold=True)
        write(surface, shown, place, size, tones.foreground, bold=True, align=(0, 0.5))
