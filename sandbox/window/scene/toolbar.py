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
    ("help", N_("Help")),
)
MARGIN = 20.0  # design pixels of a button beside its text
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

    def build(self, rect: pygame.Rect, actions: Mapping[str, Callable[[], None]], leave: Callable[[], None]) -> None:
        """Make the buttons."""
        unit, manager, height = self.host.unit, self.host.manager, round(30 * self.host.unit)
        y = rect.centery - height // 2
        place = pygame.Rect(round(12 * unit), y, round(84 * unit), height)
        UIButton(place, "← " + _("Scenes"), manager, tool_tip_text=_("back to the gallery"), command=leave)
        x = rect.right - round(12 * unit)
        for name, usual in reversed([tool for tool in TOOLS if tool[0] in actions]):
            filming = name == "film" and self.film.film is not None
            text = _("Stop") if filming else _(usual)
            wide = round(width(text, 13 * unit) + MARGIN * unit)
            x -= wide + round(5 * unit)
            place = pygame.Rect(x, y, wide, height)
            style = "#primary" if filming else None
            self.buttons[name] = UIButton(
                place, text, manager, object_id=style, tool_tip_text=hint(name), command=actions[name]
            )
        self.title_room = x - (TITLE_LEFT + 10.0) * unit
        self.update()

    def update(self) -> None:
        """Enable what can be done."""
        stack = self.stack
        for name, steps in (("undo", stack.done), ("redo", stack.undone)) if stack is not None else ():
            button = self.buttons[name]
            if bool(steps) != button.is_enabled:
                (button.enable if steps else button.disable)()
