"""The card below the beads at the end of a motion: what happened in words, and what to do next."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pygame
from pygame_gui.elements import UIButton
from softcradle.sandbox.draw.number_format import fixed
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import shortened, width, wrapped, write
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.session.contact_conversion import has_soft_contacts
from softcradle.sandbox.session.history_slices import history_slices
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.summary_text import outcome_text
from softcradle.sandbox.window.plots.plot_kinds import FORCES
from softcradle.sandbox.window.window_page import Host

SIZE = 15.0  # design pixels of the text
LINE = 21.0  # design pixels of a line
MOST_LINES = 3
MOST_FORCES = 6  # that are named one by one
WHY = N_(
    "At the greatest force the contacts push with {forces} N. The marks say what each would carry if the row were one rigid "
    "body: the mass beyond it."
)


class OutcomeCard:
    """The card; it goes as soon as the clock runs or another frame is shown.

    Attributes:
        text: what it says; empty where it is not shown.
        buttons: by text.
    """

    def __init__(self, host: Host, session: Session, steel: Callable[[], None]) -> None:
        self.host, self.session, self.steel = host, session, steel
        self.text = ""
        self.buttons: dict[str, UIButton] = {}
        self._room = self._rect = pygame.Rect(0, 0, 0, 0)
        self._frame, self._choices = -1, dict[str, Callable[[], None]]()

    def show_outcome(self) -> None:
        """Say what happened, and offer the forces and the same blow among other balls."""
        choices: dict[str, Callable[[], None]] = {_("Why? The forces"): self.show_forces}
        if len(self.session.lanes) == 1:
            soft = has_soft_contacts(self.session.lanes[0].chain)
            choices[_("Now with steel balls") if soft else _("Now with soft beads")] = self.steel
        self._show(outcome_text(self.session), choices)

    def show_forces(self) -> None:
        """Go back to the moment of the greatest force, and say what the bars and marks mean there."""
        if self.host.explore:
            self.host.act(FORCES)
        history = self.session.history
        parts = list(history_slices(history, 0, history.first, history.last))
        peaks = [float(part.force.max()) for part in parts]
        part = parts[int(np.argmax(peaks))]
        row = int(np.argmax(part.force.max(axis=1)))
        self.session.scrub_frame(part.first + row)
        forces = [fixed(force, 2) for force in part.force[row][:MOST_FORCES].tolist()]
        more = " …" if part.chain.contacts > MOST_FORCES else ""
        self._show(_(WHY, forces=", ".join(forces) + more), {})

    def _show(self, text: str, choices: dict[str, Callable[[], None]]) -> None:
        self.text, self._choices, self._frame = text, {**choices, _("Close"): self.hide}, self.session.frame
        self.build(self._room)

    def hide(self) -> None:
        """Take it away."""
        self.text = ""
        self._kill()

    def _kill(self) -> None:
        for button in self.buttons.values():
            button.kill()
        self.buttons = {}

    def build(self, room: pygame.Rect) -> None:
        """Take a place at the top of `room`, which lies below the beads."""
        self._room = room
        self._kill()
        if not self.text:
            return
        unit, right = self.host.unit, room.right - round(10 * self.host.unit)
        texts = {text: round(width(text, 13 * unit) + 24 * unit) for text in self._choices}
        wide = sum(texts.values()) + 8 * unit * len(texts)
        self._lines = wrapped(self.text, SIZE * unit, room.width - 24 * unit)
        rows = min(len(self._lines), MOST_LINES)
        beside = rows == 1 and width(self.text, SIZE * unit) + wide + 30 * unit < room.width
        high = round((LINE * rows + 16.0 + (14.0 if beside else 40.0)) * unit)
        self._rect = pygame.Rect(room.left, room.top, room.width, high)
        y = self._rect.bottom - round(37 * unit)
        for text in reversed(texts):
            place = pygame.Rect(right - texts[text], y, texts[text], round(30 * unit))
            self.buttons[text] = UIButton(place, text, self.host.manager, command=self._choices[text])
            right = place.left - round(8 * unit)

    def update(self) -> None:
        """Go where the clock runs, or another frame is shown."""
        if self.text and (self.session.playing or self.session.frame != self._frame):
            self.hide()

    def paint(self, surface: pygame.Surface) -> None:
        """Draw it over the plots."""
        if not self.text:
            return
        unit, rect = self.host.unit, self._rect
        pygame.draw.rect(surface, tones.background, rect, border_radius=round(6 * unit))
        pygame.draw.rect(surface, tones.accent, rect, max(1, round(1.5 * unit)), border_radius=round(6 * unit))
        for k, line in enumerate(self._lines[:MOST_LINES]):
            more = k == MOST_LINES - 1 < len(self._lines) - 1
            text = shortened(f"{line} …" if more else line, SIZE * unit, rect.width - 24 * unit)
            write(
                surface, text, (rect.left + 12 * unit, rect.top + (9 + LINE * k) * unit), SIZE * unit, tones.foreground
            )
