"""The explanation of a collision. It is a picture that replaces the plots.

Each lane is shown at its own largest force, with its own scale of forces. It has a magnifier for each contact and a
sentence.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame
from softcradle.sandbox.draw.magnified_insets import CAPTION, LARGEST_RADIUS, CaptionedInsets
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.shared_scales import FORCE_MARGIN
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.languages import _, scene_words
from softcradle.sandbox.motion import Array
from softcradle.sandbox.session.history_slices import HistorySlice, approach_of, history_slices, slice_at
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.story.bodies import body_word
from softcradle.sandbox.story.numbers import axis_prefix, beside
from softcradle.sandbox.story.sentences import time_text
from softcradle.sandbox.story.why import Push, length_text, push_of, share_texts, why_words
from softcradle.sandbox.window.page import Derived, Host
from softcradle.sandbox.window.page_geometry import GUTTER
from softcradle.sandbox.window.scene.lane_view import LaneView
from softcradle.sandbox.window.widgets import split, write_wrapped

SIZE, SMALL = 16.0, 13.0  # Text sizes of the explanation in design pixels: for one lane, and for two lanes.
HEAD = 20.0  # Height of the name of a lane in design pixels.
# Largest number of forces in the explanation of a lane whose strongest contact pulls. The largest force is one of them.
MOST_FORCES = 6


@dataclass(frozen=True, eq=False)
class Explained:
    """A lane at its largest force.

    Attributes:
        frame: number of the frame with the largest force.
        motion: this frame as a motion with one sample.
        push: the compressive force that is explained, or None if the strongest contact pulls.
        words: the explanation.
        approach: (n,) overlaps and (n+1,) velocities before the collision, or None.
    """

    frame: int
    motion: HistorySlice
    push: Push | None
    words: str
    approach: tuple[Array, Array] | None

    @property
    def force(self) -> float:
        """Upper end of the force axis [N] for this lane alone."""
        return FORCE_MARGIN * float(np.abs(self.motion.force).max())


class WhyView:
    """The explanation of all lanes. It closes when the clock runs or another frame is shown.

    Attributes:
        rows: the explained lanes; empty while the explanation is closed.
        available: True if the history contains a force.
    """

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        self.rows: tuple[Explained, ...] = ()
        self.available = False
        self._insets: list[tuple[CaptionedInsets | None, LaneView]] = []
        self._texts: list[tuple[pygame.Rect, Explained, str]] = []
        self._branch = Derived(lambda: session.history.branch, self._search)

    def toggle(self) -> None:
        """Open the explanation, or close it."""
        if self.rows:
            self.hide()
        elif not self._search():
            self.host.messages.hint(_("Press Play first. The explanation needs a collision."))
        else:
            self.show()

    def show(self) -> None:
        """Show each lane at its largest force. The clock shows the time of the first lane."""
        rows = tuple(map(self._explained, range(len(self.session.lanes))))
        self.session.scrub_frame(rows[0].frame)
        self.rows = rows

    def hide(self) -> None:
        """Close the explanation."""
        self.rows = ()

    @property
    def words(self) -> str:
        """The explanation of all lanes as text, one line for each lane."""
        return "\n".join(
            _("{label}: {words}", label=label, words=row.words) if label and len(self.rows) > 1 else row.words
            for label, row in zip(self._labels, self.rows, strict=False)
        )

    def update(self) -> None:
        """Close the explanation if the clock runs or another frame is shown. Set `available` after the first force."""
        history, session = self.session.history, self.session
        if self.rows and (session.playing or session.frame != self.rows[0].frame):
            self.hide()
        self._branch.follow()
        if not self.available and history.last > history.first:
            self.available = any(bool(lane.state.force.any()) for lane in session.lanes)

    @property
    def _labels(self) -> list[str]:
        return [scene_words(self.session.label(lane)) for lane in range(len(self.session.lanes))]

    def _search(self) -> bool:
        """Return True if the history contains a force."""
        lanes = range(len(self.session.lanes))
        self.available = any(part.force.any() for lane in lanes for part in self._parts(lane))
        return self.available

    def _parts(self, lane: int) -> list[HistorySlice]:
        """Return the slices of the history that belong to the newest chain of a lane."""
        history = self.session.history
        chain = history.newest_setup.lanes[lane].chain
        return [part for part in history_slices(history, lane, history.first, history.last) if part.chain is chain]

    def _explained(self, lane: int) -> Explained:
        """Return a lane at its largest pushing or pulling force."""
        history, parts = self.session.history, self._parts(lane)
        part = max(parts, key=lambda one: float(np.abs(one.force).max()))
        frame = part.first + int(np.abs(part.force).max(axis=1).argmax())
        found, begun = slice_at(history, lane, frame), parts[0]
        chain, force = found.chain, found.force[0].tolist()
        alone = not (chain.driven or chain.brakes or begun.force[0].any())
        push = push_of(chain.mass, found.overlap[0].tolist(), force, alone)
        words = _pulled(force) if push is None else why_words(push, body_word(chain))
        return Explained(frame, found, push, words, approach_of(history, lane, frame))

    def build(self, area: pygame.Rect, lanes: Sequence[LaneView]) -> None:
        """Place the magnifiers and sentences side by side in `area`."""
        self._insets, self._texts = [], []
        if not self.rows:
            return
        unit, labels = self.host.unit, self._labels
        several = len(self.rows) > 1
        size = (SMALL if several else SIZE) * unit
        for row, lane, label, rect in zip(
            self.rows, lanes, labels, split(area, [0.0] * len(self.rows), unit, GUTTER), strict=True
        ):
            head = round(HEAD * unit) if several else 0
            high = round(1.4 * size * len(wrapped(row.words, size, rect.width)) + 4 * unit)
            room = rect.height - head - high
            place = pygame.Rect(rect.left, rect.top + head, rect.width, max(0, room))
            place.height = min(place.height, round((2 * LARGEST_RADIUS + CAPTION + 8) * unit))
            self._insets.append((self._inset(place, row, lane, not several), lane))
            text = pygame.Rect(rect.left, place.bottom, rect.width, rect.bottom - place.bottom)
            self._texts.append((text, row, label if several else ""))

    def _inset(self, rect: pygame.Rect, row: Explained, lane: LaneView, leaders: bool) -> CaptionedInsets | None:
        """Return the magnifiers of a lane, or None if its strongest contact pulls or there is too little space."""
        push = row.push
        if push is None or rect.height < (CAPTION + 16.0) * self.host.unit:
            return None
        overlaps = dict(zip(push.contacts, push.overlaps, strict=True))
        lengths, shares = map(length_text, push.overlaps), share_texts(push.shares)
        texts = ((length, _("force {share}", share=share)) for length, share in zip(lengths, shares, strict=True))
        captions = dict(zip(push.contacts, texts, strict=True))
        return CaptionedInsets(rect, self.host.unit, lane.drawing, overlaps, captions, leaders)

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw the parts that do not change with time: names, captions and sentences."""
        unit, size = self.host.unit, (SMALL if len(self._texts) > 1 else SIZE) * self.host.unit
        for (inset, _lane), (rect, row, label) in zip(self._insets, self._texts, strict=True):
            if inset is not None:
                inset.backdrop(surface)
            if label:
                top = rect.top if inset is None else inset.rect.top
                when = _("at {time}", time=time_text(float(row.motion.time[0])))
                place = (rect.left, top - HEAD * unit)
                end = write(
                    surface, shortened(label, 13 * unit, 0.6 * rect.width, bold=True), place, 13 * unit, bold=True
                )
                write(surface, when, (end.right + 8 * unit, place[1]), 13 * unit, tones.muted)
            write_wrapped(surface, row.words, rect, size, tones.foreground)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the magnifiers."""
        for (inset, lane), (_rect, row, _label) in zip(self._insets, self._texts, strict=True):
            if inset is not None:
                inset.paint(surface, row.motion, 0, lane.contacts)


def _pulled(force: list[float]) -> str:
    """Return the sentence about the forces of a lane whose strongest contact pulls, or which carries no force."""
    greatest = max(range(len(force)), key=lambda i: abs(force[i]))
    most = abs(force[greatest])
    if not most:
        return _("No contact pushes.")
    first = max(0, min(greatest - MOST_FORCES // 2, len(force) - MOST_FORCES))
    last = first + MOST_FORCES
    named = ", ".join(beside(one, most) for one in force[first:last])
    named = f"{'… ' if first else ''}{named}{' …' if last < len(force) else ''}"
    return _(
        "When the pull is strongest, the contacts carry {forces} {unit}.", forces=named, unit=f"{axis_prefix(most)[1]}N"
    )
