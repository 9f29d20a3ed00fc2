"""The panel of the first level, with alpha of the whole row, speed and number of beads; and the card at the end of a motion."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np
import pygame
from pygame_gui.elements import UIButton
from softcradle.physics.contact import Contact
from softcradle.sandbox.draw.bodies import cluster_ends, has_marks
from softcradle.sandbox.draw.number_format import MINUS, beside
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import paragraphs, width, write
from softcradle.sandbox.languages import N_, _, label_words
from softcradle.sandbox.session.contact_conversion import at_the_same_depth, has_soft_contacts
from softcradle.sandbox.session.editable_numbers import MOST_SPEED, Parameter
from softcradle.sandbox.session.history_slices import HistorySlice, history_slices
from softcradle.sandbox.session.inputs import AddBead, Input, RemoveBead, SetContact, SetVelocity
from softcradle.sandbox.session.lane_setup import LaneSetup
from softcradle.sandbox.session.run_verdict import GOOD, LEVELS, Health
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.summary_text import outcome_text
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.page import Derived, Host
from softcradle.sandbox.window.plots.board import PlotBoard
from softcradle.sandbox.window.plots.kinds import FORCES
from softcradle.sandbox.window.scene.editor import SceneEditor
from softcradle.sandbox.window.scene.inspector import ROW, Inspector, paint_about
from softcradle.sandbox.window.widgets import Control, parameter_control, write_wrapped

LEAST_ALPHA, MOST_ALPHA = 1 / 30, 1.5
MOST_BEADS = 12  # that can be chosen here
COMPARE = 44.0  # design pixels of the button that compares
DOT = 6.0  # design pixels, the radius of the badge
ROUND_OFF = 1e-12  # of the largest velocity: that of a bead at rest is a sum of rates


class ExplorePanel(Inspector):
    """Three numbers of the scene and one comparison. A change begins the experiment anew, so that runs can be compared.

    Arguments:
        health: of the lanes, as it was last read.
    """

    def __init__(self, host: Host, session: Session, editor: SceneEditor, health: Callable[[], list[Health]]) -> None:
        super().__init__(host, session, editor)
        self.health = health
        self.actions = {}

    def _parameters(self) -> list[Parameter]:
        lane = self.session.lanes[0]
        start = lane.setup.start.velocity(lane.chain)
        speed, own = float(abs(start).max()), max(map(abs, self.session.scene.lanes[0].velocity))
        found = []
        exponents = [law.exponent for law in self._laws()]
        if exponents:
            row = N_("alpha of the whole row") if len(self.session.lanes) == 1 else N_("alpha of the upper row")
            name = row if self._contact is None else N_("alpha of this contact")
            alpha = exponents[self._contact or 0]
            if self._contact is None and len(set(exponents)) > 1:
                alpha = math.nan
            found.append(Parameter("alpha", name, "", LEAST_ALPHA, MOST_ALPHA, True, alpha, _unused))
        if own > 0.0:
            found.append(Parameter("speed", N_("speed"), "m/s", 0.0, MOST_SPEED * own, False, speed, _unused))
        return found

    @property
    def _contact(self) -> int | None:
        """The selected contact of the first lane; None: the whole row."""
        pick = self.editor.selection
        return pick.index if pick is not None and pick.kind == "contact" and pick.lane == 0 else None

    def _laws(self) -> list[Contact]:
        """The laws of the first lane, where all are power laws."""
        laws = [law for law in self.session.lanes[0].chain.contact if isinstance(law, Contact)]
        plain = all(law.preload == 0.0 and law.stiffness > 0.0 for law in laws)
        return laws if plain and len(laws) == self.session.lanes[0].chain.contacts else []

    def _make(self) -> None:
        self.pick = self.editor.selection
        if self.rect.width == 0:
            return
        unit, rect = self.host.unit, self.rect
        y = rect.top + 34 * unit
        for parameter in self._parameters():
            self.controls[parameter.key] = parameter_control(self.host, rect, parameter, y)
            y += 1.15 * ROW * unit
        self._beads_at = y + 15 * unit
        fewer = (MINUS, partial(self.change_beads, -1), _("one bead fewer"))
        more = ("+", partial(self.change_beads, 1), _("one bead more"))
        self._row(y, [None, fewer, more], (0.0, 30.0, 30.0), 30.0)
        y += 54 * unit
        chain, knob = self.session.lanes[0].chain, None
        if len(self.session.lanes) > 1:
            knob = _("Back to one row"), partial(self.host.act, "alone"), hint("alone")
        elif not chain.couplers:
            text = _("Compare with steel balls") if has_soft_contacts(chain) else _("Compare with soft beads")
            knob = text, partial(self.host.act, "compare_balls"), _("the same blow in a second row below")
        if knob is not None:
            self._row(y, [knob], height=COMPARE)
            y += COMPARE * unit
        y += min(24 * unit, max(0.0, rect.bottom - y - 22 * unit))  # the title of the text has room below
        self._about = pygame.Rect(rect.left, round(y), rect.width, max(0, round(rect.bottom - y)))

    def _apply(self, control: Control, value: float, gesture: bool) -> bool:
        """Begin anew with another number."""
        if control.parameter.key != "alpha":
            return self._begin_anew(self._with_speed(value), gesture)
        if not value > 0.0:
            raise ValueError(_("alpha must be a number > 0, not {given!r}", given=value))
        return self._begin_anew(self._with_alpha(value), gesture)

    def _with_speed(self, speed: float) -> list[Input]:
        """Another speed of the first lane: all velocities are multiplied alike, those of the scene where that lane rests.

        A speed > 0 is in the direction of the scene.
        """
        rows = [lane.start.velocity(lane.chain).tolist() for lane in self._newest]
        if not any(rows[0]):
            rows = [lane.velocity[: len(row)] for lane, row in zip(self.session.scene.lanes, rows, strict=True)]
        if not any(rows[0]):
            rows[0] = [1.0]
        against = max(self.session.scene.lanes[0].velocity, key=abs) < 0.0
        most = max(rows[0], key=abs) * (-1.0 if against else 1.0)
        moving = [(k, bead, v / most) for k, row in enumerate(rows) for bead, v in enumerate(row)]
        return [SetVelocity(k, bead, speed * part) for k, bead, part in moving if abs(part) > ROUND_OFF]

    def _with_alpha(self, alpha: float) -> list[Input]:
        """Another alpha of the row, or of the selected contact: the blow is stopped within the same depth."""
        lane, chosen = self._newest[0], self._contact
        contacts = range(lane.chain.contacts) if chosen is None else (min(chosen, lane.chain.contacts - 1),)
        return [SetContact(0, i, at_the_same_depth(lane.chain, i, alpha, lane.speed)) for i in contacts]

    def change_beads(self, by: int) -> None:
        """Add a bead at the right end of every lane, or take the last one away; a wall there stays the end."""
        last = min(lane.chain.contacts for lane in self._newest)
        if not 2 <= last + 1 + by <= MOST_BEADS:
            self.host.messages.show(_("from 2 to {most} beads can be chosen here", most=MOST_BEADS))
            return
        items: list[Input] = []
        for k, lane in enumerate(self._newest):
            mass = lane.chain.mass
            end = len(mass) - 1 - math.isinf(mass[-1])
            items.append(AddBead(k, end + 1, mass[end]) if by > 0 else RemoveBead(k, end))
        self._begin_anew(items)

    @property
    def _newest(self) -> tuple[LaneSetup, ...]:
        """The lanes with all edits, later ones than the frame shown too."""
        return self.session.history.newest_setup.lanes

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw the names and the text of the scene."""
        unit, rect = self.host.unit, self.rect
        if rect.width == 0:
            return
        write(surface, _("Try it"), (rect.left, rect.top + 4 * unit), 16 * unit, tones.foreground, bold=True)
        self._names(surface)
        beads = _("beads: {n}", n=self.session.lanes[0].chain.contacts + 1)
        write(surface, beads, (rect.left, self._beads_at), 13 * unit, tones.foreground, align=(0, 0.5))
        self._whole = self._about, paint_about(surface, self._about, unit, self.session, self.question())

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the dot of the badge; where all is not well, its sentence in place of the text of the scene."""
        if self.rect.width == 0:
            return
        unit, states = self.host.unit, self.health()
        worst = max(states, key=lambda state: LEVELS.index(state.level), default=None)
        level = GOOD if worst is None else worst.level
        tint, place = getattr(tones, level), (self.rect.right - DOT * unit, self.rect.top + 14 * unit)
        pygame.draw.aacircle(surface, tint, place, DOT * unit)
        if worst is None or level == GOOD:
            return
        surface.fill(tones.background, self._about)
        write_wrapped(surface, worst.sentence, self._about, 16 * unit, tint)


def _unused(value: float) -> Input:
    """The panel applies its numbers itself: several inputs at once."""
    raise NotImplementedError


SIZE, SMALL = 16.0, 13.0  # design pixels of the text, and where two lanes would become too low beside it
LOW = 560.0  # design pixels of a window in which they would
MOST_LINES = 4
MOST_FORCES = 6  # that are named one by one, the greatest among them
WHY = N_("At the greatest force the contacts push with {forces} N.")
MARKS = N_("The marks say what each would carry if the row were one rigid body: the mass beyond it.")


class OutcomeCard:
    """The card at the end of a motion. It is hidden as soon as the clock runs or another frame is shown.

    If the page has no room for it, a dialog is shown instead. The card makes and removes its own buttons: the end of a motion,
    and an edit that hides the card, must not rebuild the widgets that the mouse may be holding.

    Attributes:
        text: the text on the card; empty while it is hidden.
        buttons: by text.
    """

    def __init__(self, host: Host, session: Session, board: PlotBoard, steel: Callable[[], None]) -> None:
        self.host, self.session, self.board, self.steel = host, session, board, steel
        self.text = ""
        self.buttons: dict[str, UIButton] = {}
        self._rect = pygame.Rect(0, 0, 0, 0)
        self._frame, self._choices = -1, dict[str, Callable[[], None]]()
        self._made = Derived(lambda: (self.text, self._rect), self._remake)

    def show_outcome(self) -> None:
        """Say what happened, and offer the forces and the same blow among other balls."""
        pushed = self._strongest()[1].force.any()
        choices: dict[str, Callable[[], None]] = {_("Why? The forces"): self.show_forces} if pushed else {}
        if len(self.session.lanes) == 1:
            soft = has_soft_contacts(self.session.lanes[0].chain)
            choices[_("Now with steel balls") if soft else _("Now with soft beads")] = self.steel
        self._show(outcome_text(self.session), choices)

    def show_forces(self) -> None:
        """Go back to the moment of the greatest force, a push or a pull, and say what the bars and marks mean there."""
        if self.host.explore:
            self.board.single = FORCES
        lane, part = self._strongest()
        row, greatest = divmod(int(np.abs(part.force).argmax()), part.chain.contacts)
        self.session.scrub_frame(part.first + row)
        first = max(0, min(greatest - MOST_FORCES // 2, part.chain.contacts - MOST_FORCES))
        last, size = first + MOST_FORCES, abs(float(part.force[row, greatest]))
        forces = ", ".join(beside(force, size) for force in part.force[row, first:last].tolist())
        forces = f"{'… ' if first else ''}{forces}{' …' if last < part.chain.contacts else ''}"
        text, label = _(WHY, forces=forces), label_words(self.session.label(lane))
        overlap, velocity = self.session.approach(lane)
        if has_marks(cluster_ends(overlap.tolist(), velocity.tolist(), self.session.scene.view.length)):
            text = f"{text} {_(MARKS)}"
        self._show(
            _("{label}: {words}", label=label, words=text) if len(self.session.lanes) > 1 and label else text, {}
        )

    def _strongest(self) -> tuple[int, HistorySlice]:
        """The lane of the greatest force that a frame shows, and the part of its history."""
        history = self.session.history
        lanes = range(len(self.session.lanes))
        parts = [(k, part) for k in lanes for part in history_slices(history, k, history.first, history.last)]
        return max(parts, key=lambda found: float(np.abs(found[1].force).max()))

    def _show(self, text: str, choices: dict[str, Callable[[], None]]) -> None:
        self.text, self._choices, self._frame = text, {**choices, _("Close"): self.hide}, self.session.frame

    def hide(self) -> None:
        """Take it away."""
        self.text = ""

    def height(self, room: int) -> int:
        """Pixels of the card where it is so wide; 0 where it is not shown, those of the window where its buttons are wider."""
        if not self.text or sum(self._widths()) > room:
            return self.host.size[1] if self.text else 0
        return round((1.4 * self._size * min(len(self._lines(room)), MOST_LINES) + 46.0) * self.host.unit)

    def _widths(self) -> list[int]:
        """Pixels of each button with the space beside it."""
        return [round(width(text, 13 * self.host.unit) + 32 * self.host.unit) for text in self._choices]

    @property
    def _size(self) -> float:
        return SMALL if len(self.session.lanes) > 1 and self.host.size[1] < LOW * self.host.unit else SIZE

    def _lines(self, room: int) -> list[str]:
        """The lines of the text in a card so wide; each lane begins one."""
        return paragraphs(self.text, self._size * self.host.unit, room - 28 * self.host.unit)

    def build(self, place: pygame.Rect) -> None:
        """Make the buttons in `place`, on a page whose old widgets are gone."""
        self.buttons, self._rect = {}, place
        self._make()
        self._made.note()

    def follow(self, place: pygame.Rect) -> None:
        """Make the buttons again if the text or the `place` has changed."""
        self._rect = place
        self._made.follow()

    def _remake(self) -> None:
        for button in self.buttons.values():
            button.kill()
        self.buttons = {}
        self._make()

    def _make(self) -> None:
        place = self._rect
        if self.text and not place.height:
            note, self.text = self.text, ""
            self.host.choose(_("What happened"), note, self._choices)
        if not self.text:
            return
        unit, left = self.host.unit, place.right - sum(self._widths())
        for (text, command), wide in zip(self._choices.items(), self._widths(), strict=True):
            button = pygame.Rect(left, place.bottom - round(36 * unit), wide - round(8 * unit), round(30 * unit))
            style = "#flat" if command == self.hide else None
            self.buttons[text] = UIButton(button, text, self.host.manager, object_id=style, command=command)
            left += wide

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
        surface.fill(
            tones.foreground, (rect.left, rect.top + round(8 * unit), round(3 * unit), rect.height - round(16 * unit))
        )
        for k, line in enumerate(self._lines(rect.width)[:MOST_LINES]):
            place = (rect.left + 14 * unit, rect.top + (6 + 1.4 * self._size * k) * unit)
            write(surface, line, place, self._size * unit, tones.foreground)
