"""The panel of Explore with softness, speed and number of beads, and the card with the outcome at the end of a motion."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pygame
from pygame_gui.elements import UIButton
from softcradle.physics.contact import Contact
from softcradle.sandbox.draw.bodies import cluster_ends, has_marks, visible_marks
from softcradle.sandbox.draw.lane_drawing import VISIBLE_FORCE
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import paragraphs, shortened, width, write
from softcradle.sandbox.languages import N_, _, scene_words
from softcradle.sandbox.session.contact_conversion import at_the_same_depth, has_soft_contacts
from softcradle.sandbox.session.editable_numbers import MOST_SPEED, ROUND_EXPONENTS, Parameter, parameters
from softcradle.sandbox.session.history_slices import HistorySlice, approach_of, history_slices
from softcradle.sandbox.session.inputs import AddBead, Input, RemoveBead, SetContact, SetVelocity
from softcradle.sandbox.session.lane_setup import LaneSetup
from softcradle.sandbox.session.run_verdict import Health
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.summary_text import outcome_text
from softcradle.sandbox.story.numbers import MINUS, axis_prefix, beside
from softcradle.sandbox.story.terms import BEAD
from softcradle.sandbox.story.verdict import GOOD, LEVELS
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.page import Derived, Host
from softcradle.sandbox.window.plots.board import PlotBoard
from softcradle.sandbox.window.plots.kinds import FORCES
from softcradle.sandbox.window.scene.editor import Pick, SceneEditor, pick_title
from softcradle.sandbox.window.scene.inspector import ROW, Inspector, Knob, about, paint_about
from softcradle.sandbox.window.widgets import Control, parameter_control, write_wrapped
from softcradle.scenes import Scene

LEAST_ALPHA, MOST_ALPHA = 1 / 40, 1.5
ENDS = 14.0  # Height in design pixels of the words below the ends of the softness slider.
MOST_BEADS = 12  # Largest number of beads that the panel offers.
OF_BEAD = ("mass", "velocity")  # Keys of the numbers that the panel shows for a selected bead.
COMPARE = 44.0  # Height of the button for the comparison in design pixels.
# Height in design pixels of the title and two lines of the text. If less space is left, a button shows the text.
LEAST_TEXT = 76.0
DOT = 6.0  # Radius of the badge in design pixels.
# Fraction of the largest velocity below which a velocity counts as 0. The velocity of a bead at rest is a sum of
# increments.
ROUND_OFF = 1e-12


class ExplorePanel(Inspector):
    """The panel with three numbers of the scene and one comparison. For a selected bead it shows mass and velocity.

    A change restarts the experiment, so that runs can be compared.

    Arguments:
        health: returns the latest verdict on each lane.
    """

    def __init__(self, host: Host, session: Session, editor: SceneEditor, health: Callable[[], list[Health]]) -> None:
        super().__init__(host, session, editor)
        self.health = health

    def _parameters(self) -> list[Parameter]:
        pick = self.editor.selection
        if pick is not None and pick.kind == "bead":
            return self._bead_parameters(pick)
        lane = self.session.lanes[0]
        start = lane.setup.start.velocity(lane.chain)
        speed, own = float(abs(start).max()), max(map(abs, self.session.scene.lanes[0].velocity))
        found = []
        exponents = [law.exponent for law in self._laws()]
        if exponents:
            row = N_("softness (alpha)") if len(self.session.lanes) == 1 else N_("softness, upper row")
            name = row if self._contact is None else N_("softness of this contact")
            alpha = exponents[self._contact or 0]
            if self._contact is None and len(set(exponents)) > 1:
                alpha = math.nan
            ends, stops = (LEAST_ALPHA, MOST_ALPHA), ROUND_EXPONENTS
            found.append(Parameter("alpha", name, "", *ends, True, alpha, _unused, stops))
        if own > 0.0:
            found.append(Parameter("speed", N_("speed"), "m/s", 0.0, MOST_SPEED * own, False, speed, _unused))
        return found

    def _bead_parameters(self, pick: Pick) -> list[Parameter]:
        """Return mass and initial velocity of a bead. A change restarts the experiment."""
        found = [one for one in parameters(self.session, pick.lane, BEAD, pick.index) if one.key in OF_BEAD]
        lane = self._newest[pick.lane]
        start = lane.start.velocity(lane.chain)
        if pick.index >= len(start):  # The current frame is in the past, when there were more beads.
            return found
        return [replace(one, value=float(start[pick.index])) if one.key == "velocity" else one for one in found]

    @property
    def _contact(self) -> int | None:
        """Index of the selected contact in the first lane, or None for the whole row."""
        pick = self.editor.selection
        return pick.index if pick is not None and pick.kind == "contact" and pick.lane == 0 else None

    def _laws(self) -> list[Contact]:
        """Return the laws of the first lane if all of them are power laws, otherwise an empty list."""
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
            y += (1.15 * ROW + (ENDS if parameter.key == "alpha" else 0.0)) * unit
        self._beads_at = y + 15 * unit
        fewer = (MINUS, partial(self.change_beads, -1), _("one bead fewer"))
        more = ("+", partial(self.change_beads, 1), _("one bead more"))
        self._row(y, [None, fewer, more], (0.0, 30.0, 30.0), 30.0)
        y += 54 * unit
        chain, knob = self.session.lanes[0].chain, None
        if len(self.session.lanes) > 1:
            knob = _("Back to one row"), partial(self.host.act, "alone"), hint("alone")
        elif not chain.piecewise:
            text = _("Compare with steel balls") if has_soft_contacts(chain) else _("Compare with soft beads")
            knob = text, partial(self.host.act, "compare_balls"), _("the same blow in a second row below")
        knobs: list[Knob] = [] if knob is None else [knob]
        if rect.bottom - y < (COMPARE + LEAST_TEXT) * unit and (self.session.scene.text or self.question()):
            knobs.append((_("Text"), self.show_text, _("what this scene is about")))
        if knobs:
            self._row(y, knobs, (0.0, 76.0)[-len(knobs) :] if len(knobs) > 1 else (), COMPARE)
            y += COMPARE * unit
        y += min(24 * unit, max(0.0, rect.bottom - y - 22 * unit))  # Leave space for the title of the text below.
        self._about = pygame.Rect(rect.left, round(y), rect.width, max(0, round(rect.bottom - y)))

    def show_text(self) -> None:
        """Show the text of the scene, or its question, in a dialog."""
        title, *parts = about(self.session, self.question())
        self.host.choose(title, "\n".join(part for part in parts if part), {_("Close"): lambda: None})

    def _apply(self, control: Control, value: float, gesture: bool) -> bool:
        """Restart with another number."""
        return self._begin_anew(self._edits(control.parameter, value), gesture)

    def _edits(self, parameter: Parameter, value: float) -> list[Input]:
        if parameter.key == "speed":
            return self._with_speed(value)
        if parameter.key != "alpha":
            return super()._edits(parameter, value)
        if not value > 0.0:
            raise ValueError(_("alpha must be a number > 0, not {given!r}", given=value))
        return self._with_alpha(value)

    def _at_start(self, parameter: Parameter, scene: Scene) -> Parameter:
        return parameter  # The numbers of this panel already belong to the start.

    def _with_speed(self, speed: float) -> list[Input]:
        """Return the edits for another speed of the first lane. All velocities are multiplied by the same factor.

        If the first lane is at rest, the velocities of the scene are used. A speed > 0 has the direction of motion of
        the scene.
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
        """Return the edits for another exponent of the row or of the selected contact. The depth at which the blow
        stops is kept.
        """
        lane, chosen = self._newest[0], self._contact
        contacts = range(lane.chain.contacts) if chosen is None else (min(chosen, lane.chain.contacts - 1),)
        return [SetContact(0, i, at_the_same_depth(lane.chain, i, alpha, lane.speed)) for i in contacts]

    def change_beads(self, by: int) -> None:
        """Add a bead at the right end of every lane, or remove the last bead. A wall stays at the end."""
        last = min(lane.chain.contacts for lane in self._newest)
        if not 2 <= last + 1 + by <= MOST_BEADS:
            self.host.messages.hint(_("You can choose 2 to {most} beads here.", most=MOST_BEADS))
            return
        items: list[Input] = []
        for k, lane in enumerate(self._newest):
            mass = lane.chain.mass
            end = len(mass) - 1 - math.isinf(mass[-1])
            items.append(AddBead(k, end + 1, mass[end]) if by > 0 else RemoveBead(k, end))
        self._begin_anew(items)

    @property
    def _newest(self) -> tuple[LaneSetup, ...]:
        """The lanes with all edits, including edits later than the current frame."""
        return self.session.history.newest_setup.lanes

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw the names of the numbers and the text of the scene."""
        unit, rect = self.host.unit, self.rect
        if rect.width == 0:
            return
        title = _("Try it") if self.pick is None else pick_title(self.session, self.pick)
        title = shortened(title, 16 * unit, rect.width - 3 * DOT * unit, bold=True)
        write(surface, title, (rect.left, rect.top + 4 * unit), 16 * unit, tones.foreground, bold=True)
        self._names(surface)
        if (alpha := self.controls.get("alpha")) is not None:
            y = alpha.slider.rect.bottom + 2 * unit
            for text, x, side in ((_("soft"), rect.left, 0), (_("like steel"), rect.right, 1)):
                write(surface, text, (x, y), 13 * unit, tones.muted, align=(side, 0))
        beads = _("beads: {n}", n=self.session.lanes[0].chain.contacts + 1)
        write(surface, beads, (rect.left, self._beads_at), 13 * unit, tones.foreground, align=(0, 0.5))
        self._whole = self._about, paint_about(surface, self._about, unit, self.session, self.question())

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the dot of the badge. If a lane has a problem, draw the sentence about it instead of the text of the
        scene.
        """
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
    """Raise NotImplementedError. The panel applies its numbers itself, because a change needs several inputs."""
    raise NotImplementedError


# Text sizes in design pixels. The small size is used for two lanes in a low window, where the lanes would become too
# low.
SIZE, SMALL = 16.0, 13.0
LOW = 560.0  # Height of a window, in design pixels, below which this happens.
MOST_LINES = 4
MOST_FORCES = 6  # Number of forces that are listed, including the largest.
WHY = N_("When the push is strongest, the contacts carry {forces} {unit}.")
MARKS = N_(
    "The black lines show the forces inside one solid block: each contact only has to move the beads on its other side."
)


class OutcomeCard:
    """The card at the end of a motion. It is hidden as soon as the clock runs or another frame is shown.

    If the page does not have enough space for it, a dialog is shown instead. The card creates and removes its buttons
    itself: neither the end of a motion nor an edit that hides the card may rebuild widgets that the mouse is holding.

    Attributes:
        text: text on the card; empty while it is hidden.
        buttons: the buttons by their text.
    """

    def __init__(self, host: Host, session: Session, board: PlotBoard, steel: Callable[[], None]) -> None:
        self.host, self.session, self.board, self.steel = host, session, board, steel
        self.text = ""
        self.buttons: dict[str, UIButton] = {}
        self._rect = pygame.Rect(0, 0, 0, 0)
        self._frame, self._choices = -1, dict[str, Callable[[], None]]()
        self._made = Derived(lambda: (self.text, self._rect), self._remake)

    def show_outcome(self) -> None:
        """Describe the outcome, and offer to show the forces or the same blow with other balls."""
        pushed = any(part.force.any() for lane in self._rows for part in self._parts(lane))
        choices: dict[str, Callable[[], None]] = {_("Why? The forces"): self.show_forces} if pushed else {}
        if len(self.session.lanes) == 1:
            soft = has_soft_contacts(self.session.lanes[0].chain)
            choices[_("Now with steel balls") if soft else _("Now with soft beads")] = self.steel
        self._show(outcome_text(self.session), choices)

    def show_forces(self) -> None:
        """Show the first row at its largest force and describe the forces of each row.

        Each row is described at the time of its own largest force, because different rows push at different times.
        """
        if self.host.explore:
            self.board.single = FORCES
        self.session.scrub_frame(self._strongest(0)[0])
        said, marked = [], False
        for lane in self._rows:
            text, marks = self._forces(lane)
            label, marked = scene_words(self.session.label(lane)), marked or marks
            said.append(_("{label}: {words}", label=label, words=text) if len(self._rows) > 1 and label else text)
        if marked:
            said[-1] = f"{said[-1]} {_(MARKS)}"
        self._show("\n".join(said), {})

    @property
    def _rows(self) -> range:
        return range(len(self.session.lanes))

    def _parts(self, lane: int) -> list[HistorySlice]:
        history = self.session.history
        return list(history_slices(history, lane, history.first, history.last))

    def _strongest(self, lane: int) -> tuple[int, HistorySlice, int]:
        """Return the frame with the largest push or pull in a lane, its slice of the history, and the row in that
        slice.
        """
        part = max(self._parts(lane), key=lambda one: float(np.abs(one.force).max()))
        row = int(np.abs(part.force).max(axis=1).argmax())
        return part.first + row, part, row

    def _forces(self, lane: int) -> tuple[str, bool]:
        """Return the sentence about the largest forces of a lane, and True if marks are drawn on its force bars."""
        frame, part, row = self._strongest(lane)
        forces = part.force[row]
        greatest = int(np.abs(forces).argmax())
        first = max(0, min(greatest - MOST_FORCES // 2, part.chain.contacts - MOST_FORCES))
        last, most = first + MOST_FORCES, abs(float(forces[greatest]))
        if not most:
            return _("No contact pushes."), False
        named = ", ".join(beside(force, most) for force in forces[first:last].tolist())
        named = f"{'… ' if first else ''}{named}{' …' if last < part.chain.contacts else ''}"
        overlap, velocity = approach_of(self.session.history, lane, frame) or self.session.approach(lane)
        length = self.session.scene.view.length
        ends = cluster_ends(overlap.tolist(), velocity.tolist(), length)
        chain, least = part.chain, VISIBLE_FORCE * most
        marks = visible_marks(chain.mass, ends, part.overlap[row].tolist(), forces.tolist(), length, least)
        return _(WHY, forces=named, unit=f"{axis_prefix(most)[1]}N"), has_marks(ends) and any(marks)

    def _show(self, text: str, choices: dict[str, Callable[[], None]]) -> None:
        self.text, self._choices, self._frame = text, {**choices, _("Close"): self.hide}, self.session.frame

    def hide(self) -> None:
        """Hide the card."""
        self.text = ""

    def height(self, room: int) -> int:
        """Return the height of the card [pixels] for a width of `room` pixels.

        It is 0 for a hidden card. It is the height of the window if the buttons do not fit, so that a dialog is shown
        instead.
        """
        if not self.text or sum(self._widths()) > room:
            return self.host.size[1] if self.text else 0
        return round((1.4 * self._size * min(len(self._lines(room)), MOST_LINES) + 46.0) * self.host.unit)

    def _widths(self) -> list[int]:
        """Return the width in pixels of each button, including the space next to it."""
        return [round(width(text, 13 * self.host.unit) + 32 * self.host.unit) for text in self._choices]

    @property
    def _size(self) -> float:
        return SMALL if len(self.session.lanes) > 1 and self.host.size[1] < LOW * self.host.unit else SIZE

    def _lines(self, room: int) -> list[str]:
        """Return the lines of the text for a card of that width. The text about a lane starts on a new line."""
        return paragraphs(self.text, self._size * self.host.unit, room - 28 * self.host.unit)

    def build(self, place: pygame.Rect) -> None:
        """Create the buttons in `place`; the old widgets of the page have already been removed."""
        self.buttons, self._rect = {}, place
        self._make()
        self._made.note()

    def follow(self, place: pygame.Rect) -> None:
        """Create the buttons again if the text or the `place` has changed."""
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
        """Hide the card if the clock runs or another frame is shown."""
        if self.text and (self.session.playing or self.session.frame != self._frame):
            self.hide()

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the card over the plots."""
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
