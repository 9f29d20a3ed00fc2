"""Messages on screen. They show results of actions and warnings, and stay visible long enough to be read."""

from __future__ import annotations

from dataclasses import dataclass

import pygame
from softcradle.sandbox.draw.palette import Colour, tones
from softcradle.sandbox.draw.text import shortened, width, wrapped, write
from softcradle.sandbox.languages import message_words

MOST = 2  # Largest number of messages on screen.
# Largest number of characters that are shown. They fit into every window. Pasted names can be arbitrarily long.
LONGEST = 1000
LEAST_SECONDS = 2.5  # Shortest time in seconds that a message stays.
SECONDS_A_WORD = 0.35  # Time on screen in seconds per word of a message.
WARNING_FACTOR = 2.0  # Factor by which a warning stays on screen longer than other messages.


DONE, HINT, WARNING = "done", "hint", "warning"  # Kinds of messages.
MARKS = {DONE: "✓", HINT: "i", WARNING: "!"}


@dataclass
class Message:
    """A sentence on screen.

    Attributes:
        text: the sentence.
        kind: DONE after an action, HINT if no action was performed, or WARNING.
        seconds_left: remaining time on screen [s].
        subject: topic of the message; a newer message with the same subject replaces it. Empty: no subject.
    """

    text: str
    kind: str
    seconds_left: float
    subject: str = ""

    @property
    def warning(self) -> bool:
        """True if the message is a warning."""
        return self.kind == WARNING

    @property
    def tint(self) -> Colour:
        """The colour of the border and the mark."""
        return {DONE: tones.good, HINT: tones.muted, WARNING: tones.warning}[self.kind]


class Messages:
    """The messages on screen. The newest message is at the bottom."""

    def __init__(self) -> None:
        self.visible: list[Message] = []
        self._places: list[tuple[pygame.Rect, Message]] = []

    def show(self, text: str, warning: bool = False, subject: str = "") -> None:
        """Show a message about a completed action, or a warning. It replaces an older message with the same `subject`."""
        self._show(text, WARNING if warning else DONE, subject)

    def hint(self, text: str, subject: str = "") -> None:
        """Show a message that explains why an action was not performed, or what to do first. It has no check mark."""
        self._show(text, HINT, subject)

    def _show(self, text: str, kind: str, subject: str) -> None:
        text = message_words(text)
        text = text if len(text) <= LONGEST else f"{text[: LONGEST - 2]} …"
        kept = (one for one in self.visible if one.text != text and (one.subject != subject or not subject))
        self.visible = list(kept)[-(MOST - 1) :]
        seconds = max(LEAST_SECONDS, SECONDS_A_WORD * len(text.split())) * (WARNING_FACTOR if kind == WARNING else 1.0)
        self.visible.append(Message(text, kind, seconds, subject))

    def leave_page(self) -> None:
        """Remove the messages about the page that is being left, but keep warnings."""
        self.visible = [message for message in self.visible if message.warning]

    def handle(self, event: pygame.Event) -> bool:
        """Remove a message that is clicked. Return True if a message was clicked."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            for rect, message in self._places:
                if rect.collidepoint(event.pos) and message in self.visible:
                    self.visible.remove(message)
                    return True
        return False

    def update(self, seconds: float) -> None:
        """Reduce the remaining time of all messages by `seconds`."""
        for message in self.visible:
            message.seconds_left -= seconds
        self.visible = [message for message in self.visible if message.seconds_left > 0.0]

    def paint(self, surface: pygame.Surface, place: pygame.Rect, unit: float) -> None:
        """Draw the messages that fit into `place`, from the bottom up. The newest message is always drawn."""
        self._places, bottom = [], place.bottom
        for message in reversed(self.visible):
            room = min(720 * unit, place.width - 40 * unit)
            lines = [shortened(line, 13 * unit, room) for line in wrapped(message.text, 13 * unit, room)]
            height = round((len(lines) * 18 + 10) * unit)
            if self._places and bottom - height < place.top:
                break
            wide = max(width(line, 13 * unit) for line in lines) + 40 * unit
            rect = pygame.Rect(0, 0, round(wide), height)
            rect.midbottom = place.centerx, bottom
            self._box(surface, message, lines, rect, unit)
            bottom = rect.top - round(6 * unit)

    def _box(self, surface: pygame.Surface, message: Message, lines: list[str], rect: pygame.Rect, unit: float) -> None:
        """Draw one message."""
        tint = message.tint
        pygame.draw.rect(surface, tones.background, rect, border_radius=round(6 * unit))
        pygame.draw.rect(surface, tint, rect, max(1, round(1.5 * unit)), border_radius=round(6 * unit))
        x = rect.left + 13 * unit
        write(surface, MARKS[message.kind], (x, rect.top + 6 * unit), 13 * unit, tint, bold=True)
        for k, line in enumerate(lines):
            write(surface, line, (x + 15 * unit, rect.top + (6 + 18 * k) * unit), 13 * unit, tones.foreground)
        self._places.append((rect, message))
