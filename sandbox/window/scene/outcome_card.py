"""The text at the end of a motion. It appears in the force panels above the beads, because they are empty without a
contact.
"""

from __future__ import annotations

from collections.abc import Sequence

import pygame
from softcradle.sandbox.draw.lane_drawing import KEY
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import wrapped, write
from softcradle.sandbox.languages import _
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.summary_text import outcome_text, outcome_texts
from softcradle.sandbox.window.page import Derived, Host
from softcradle.sandbox.window.scene.lane_view import LaneView

# Text sizes in design pixels. The first size at which the text fits is used.
SIZES = (16.0, 13.0)
# Space in design pixels for the labels of the force axis on the left, and for the ruler on the right.
LEFT, RIGHT = 52.0, 132.0


class OutcomeCard:
    """The text at the end of a motion. Each lane has its own text, which is shown in its force panel.

    The text disappears when the clock runs or another frame is shown. If the text does not fit, a dialog shows it.

    Attributes:
        paragraphs: the paragraphs of each lane, the most important first; empty while the card is hidden.
    """

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        self.paragraphs: list[list[str]] = []
        self._frame = -1
        self._lanes: Sequence[LaneView] = ()
        self._fitted = Derived(lambda: (self.paragraphs, [lane.drawing for lane in self._lanes]), self._fit)
        self._shown: list[tuple[pygame.Rect, float, list[str]]] = []

    @property
    def text(self) -> str:
        """The text of all lanes. It is empty while the card is hidden."""
        return "\n".join(" ".join(paragraphs) for paragraphs in self.paragraphs)

    def show_outcome(self, verdict: str = "") -> None:
        """Describe how the beads of each lane move. If there is a `verdict`, it comes first.

        A verdict compares a prediction about the first lane with the result.
        """
        self.paragraphs = [[words] for words in outcome_texts(self.session)]
        if verdict:
            self.paragraphs[0].insert(0, verdict)
        self._frame = self.session.frame

    def hide(self) -> None:
        """Hide the card."""
        self.paragraphs = []

    def update(self) -> None:
        """Hide the card if the clock runs or another frame is shown."""
        if self.paragraphs and (self.session.playing or self.session.frame != self._frame):
            self.hide()

    def follow(self, lanes: Sequence[LaneView]) -> None:
        """Fit the text into the force panels of `lanes`. If it does not fit, show a dialog instead."""
        self._lanes = lanes
        self._fitted.follow()

    def _fit(self) -> None:
        self._shown = []
        if len(self.paragraphs) != len(self._lanes):
            return
        found = [self._placed(lane, texts) for lane, texts in zip(self._lanes, self.paragraphs, strict=True)]
        self._shown = [one for one in found if one is not None]
        if len(self._shown) < len(found):
            verdict = self.paragraphs[0][0] if len(self.paragraphs[0]) > 1 else ""
            words = "\n".join(part for part in (verdict, outcome_text(self.session)) if part)
            self.hide()
            self._shown = []
            self.host.choose(_("What happened"), words, {_("Close"): lambda: None})

    def _placed(self, lane: LaneView, texts: Sequence[str]) -> tuple[pygame.Rect, float, list[str]] | None:
        """Return the rectangle, the text size and the lines for one lane, or None if the text does not fit.

        Paragraphs at the end are left out if they do not fit.
        """
        unit, drawing = self.host.unit, lane.drawing
        room = drawing.rect.inflate(0, 0)
        room.update(drawing.rect.left + LEFT * unit, drawing.rect.top + KEY * unit, drawing.rect.width, 0)
        room.width -= round((LEFT + RIGHT) * unit)
        high = drawing.bar_base - room.top - 4.0 * unit
        for count in range(len(texts), 0, -1):
            for size in SIZES:
                lines = [line for text in texts[:count] for line in wrapped(text, size * unit, room.width - 14 * unit)]
                room.height = round(1.4 * size * unit * len(lines) + 2 * unit)
                if room.height <= high:
                    return room, size * unit, lines
        return None

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the text."""
        unit = self.host.unit
        for rect, size, lines in self._shown if self.paragraphs else ():
            surface.fill(tones.lane_background, rect)
            mark = rect.inflate(0, -round(4 * unit))
            mark.width = round(3 * unit)
            surface.fill(tones.foreground, mark)
            for k, line in enumerate(lines):
                write(surface, line, (rect.left + 14 * unit, rect.top + 1 * unit + 1.4 * size * k), size)
