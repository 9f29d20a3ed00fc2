"""The toolbar above a page: back to the gallery, undo and redo, and what can be saved."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import pygame
from pygame_gui.elements import UIButton
from softcradle.sandbox.draw.text import width
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.session.undo import UndoStack
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.scene.window_film import WindowFilm
from softcradle.sandbox.window.window_page import Host

# Action and text of each button on the right.
TOOLS = (
    ("undo", N_("Undo")),
    ("redo", N_("Redo")),
    ("save_scene", N_("Save scene")),
    ("save_session", N_("Save session")),
    ("export", N_("Export")),
    ("screenshot", N_("Screenshot")),
    ("film", N_("Film")),
    ("tools", N_("Tools")),
    ("level", N_("Explore")),
    ("help", N_("Help")),
)
FEW = {"undo": N_("Undo"), "tools": N_("More"), "level": N_("Lab"), "help": N_("Help")}  # those of the first level
MARGIN, LEAST_MARGIN = 20.0, 8.0  # design pixels of a button beside its text
SPACE = 5.0  # design pixels between two buttons
LEAST_TITLE = 70.0  # design pixels for the title, for which buttons give way
LONGEST_CLOCK = "88:88"  # a film's, for which its button has room from the beginning
TITLE_LEFT = 110.0  # design pixels


class Toolbar:
    """The buttons, and how much room they leave for the title.

    Attributes:
        buttons: by action.
        title_room: pixels between the buttons.
    """

    def __init__(self, host: Host, film: WindowFilm, stack: UndoStack | None = None) -> None:
        self.host, self.film, self.stack = host, film, stack
        self.buttons: dict[str, UIButton] = {}
        self.title_room = 0.0
        self._filming = False  # whether the button of the film says Stop

    def build(self, rect: pygame.Rect, actions: Mapping[str, Callable[[], None]], leave: Callable[[], None]) -> None:
        """Make the buttons."""
        unit, manager, height = self.host.unit, self.host.manager, round(30 * self.host.unit)
        y = rect.centery - height // 2
        place = pygame.Rect(round(12 * unit), y, round(84 * unit), height)
        UIButton(place, "← " + _("Scenes"), manager, tool_tip_text=_("back to the gallery"), command=leave)
        x = rect.right - round(12 * unit)
        self._filming = self.film.film is not None
        self.buttons = {}
        texts = {name: self._longest(name, usual) for name, usual in self._tools if name in actions}
        margin = self._margin(texts, x)
        for name, longest in reversed(texts.items()):
            wide = round(self._width(name, longest) + margin)
            x -= wide + round(SPACE * unit)
            place = pygame.Rect(x, y, wide, height)
            style = "#recording" if name == "film" and self._filming else None
            self.buttons[name] = UIButton(
                place, longest, manager, object_id=style, tool_tip_text=hint(name), command=actions[name]
            )
        self.title_room = x - (TITLE_LEFT + 10.0) * unit
        self.update()

    @property
    def _tools(self) -> tuple[tuple[str, str], ...]:
        """Action and text of each button at the present level."""
        return tuple(FEW.items()) if self.host.explore else TOOLS

    def _longest(self, name: str, usual: str) -> str:
        """The longest text of a button until the page is built anew."""
        return self._stop(LONGEST_CLOCK) if name == "film" and self._filming else _(usual)

    def _width(self, name: str, text: str) -> int:
        return width(text, 13 * self.host.unit, bold=name == "film" and self._filming)

    def _margin(self, texts: Mapping[str, str], right: float) -> float:
        """Pixels of a button beside its text: less than usual where the title would have no room."""
        unit = self.host.unit
        room = right - (TITLE_LEFT + 10.0 + LEAST_TITLE + SPACE * len(texts)) * unit
        spare = room - sum(self._width(*one) for one in texts.items())
        return min(MARGIN * unit, max(LEAST_MARGIN * unit, spare / len(texts)))

    def _stop(self, clock: str) -> str:
        """The text of the button that ends the film."""
        return _("Stop {time}", time=clock)

    def update(self) -> None:
        """Enable what can be done, and let the button of a film say how long it is: its text changes once a second."""
        if self._filming != (self.film.film is not None):
            self.host.rebuild()  # the film has ended, or stopped
        elif self._filming and "film" in self.buttons:
            self.buttons["film"].set_text(self._stop(self.film.clock))
        stack = self.stack
        for name, steps in (("undo", stack.done), ("redo", stack.undone)) if stack is not None else ():
            button = self.buttons.get(name)
            if button is not None and bool(steps) != button.is_enabled:
                (button.enable if steps else button.disable)()
