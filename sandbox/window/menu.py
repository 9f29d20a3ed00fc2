"""The menu: a list of actions below a button, each with what it does and its key; mouse or arrow keys choose."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import pygame
from pygame_gui.elements import UIButton
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.overlay import Overlay
from softcradle.sandbox.window.window_page import Host

WIDTH = 350.0  # design pixels
ROW = 27.0  # design pixels


class Menu(Overlay):
    """The actions `names` of the page or the window, in as many columns as they need. A click elsewhere and Esc close it.

    Attributes:
        focus: number of the row that Enter takes.
        buttons: the rows.
    """

    def __init__(self, host: Host, corner: tuple[int, int], names: Sequence[str]) -> None:
        self.corner, self.names, self.focus = corner, names, 0
        self.buttons: list[UIButton] = []
        super().__init__(host)

    def make_widgets(self) -> None:
        """Take a place below the button and make the rows."""
        unit, row, margin = self.host.unit, round(ROW * self.host.unit), round(6 * self.host.unit)
        columns = -(-row * len(self.names) // (self.host.size[1] - self.corner[1] - 2 * margin))
        rows, wide = -(-len(self.names) // columns), round(WIDTH * unit)
        self.box = pygame.Rect(0, 0, columns * wide, row * rows + 2 * margin)
        self.box.topright = self.corner
        self.box.clamp_ip(pygame.Rect((0, 0), self.host.size))
        left, top = self.box.left + margin, self.box.top + margin
        self.buttons = [
            UIButton(
                pygame.Rect(left + k // rows * wide, top + k % rows * row, wide - 2 * margin, row),
                hint(name),
                self.manager,
                object_id="#menu_row",
                command=partial(self.choose, name),
            )
            for k, name in enumerate(self.names)
        ]

    def widgets(self) -> Sequence[UIButton]:
        """The rows."""
        return self.buttons

    def choose(self, name: str) -> None:
        """Close the menu and do the action."""
        self.close()
        self.host.act(name)

    def handle(self, event: pygame.Event) -> bool:
        """A press elsewhere closes the menu."""
        if event.type == pygame.MOUSEBUTTONDOWN and not self.box.collidepoint(event.pos):
            self.close()
        return super().handle(event)

    def key(self, event: pygame.Event) -> None:
        """Arrows move, Enter takes, Esc closes."""
        if event.key == pygame.K_ESCAPE:
            self.close()
        elif event.key in (pygame.K_RETURN, pygame.K_KP_ENTER, pygame.K_SPACE):
            self.choose(self.names[self.focus])
        elif event.key in (pygame.K_DOWN, pygame.K_TAB):
            self.focus = (self.focus + 1) % len(self.names)
        elif event.key == pygame.K_UP:
            self.focus = (self.focus - 1) % len(self.names)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the box, the rows, and the ring of the row that Enter takes."""
        pygame.draw.rect(surface, tones.background, self.box, border_radius=6)
        pygame.draw.rect(surface, tones.faint, self.box, max(1, round(1.5 * self.host.unit)), border_radius=6)
        super().paint(surface)
        pygame.draw.rect(surface, tones.foreground, self.buttons[self.focus].rect, 2, border_radius=4)
