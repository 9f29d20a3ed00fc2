"""The panel of Explore. Its controls change the softness of the contacts, the speed, and the number of beads."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import pygame
from softcradle.physics.contact import Contact
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import shortened, write
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.quantities import BEAD
from softcradle.sandbox.session.contact_conversion import at_the_same_depth, has_soft_contacts
from softcradle.sandbox.session.editable_numbers import MOST_SPEED, ROUND_EXPONENTS, Parameter, parameters
from softcradle.sandbox.session.inputs import AddBead, Input, RemoveBead, SetContact, SetVelocity
from softcradle.sandbox.session.lane_setup import LaneSetup
from softcradle.sandbox.session.run_verdict import Health
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.story.bodies import BODIES, body_word
from softcradle.sandbox.story.numbers import MINUS, axis_prefix, plain
from softcradle.sandbox.story.verdict import GOOD, LEVELS
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.scene.editor import Pick, SceneEditor, pick_title
from softcradle.sandbox.window.scene.inspector import ROW, Inspector, Knob, about, paint_about
from softcradle.sandbox.window.widgets import Control, parameter_control, write_wrapped
from softcradle.scenes import Scene

LEAST_ALPHA, MOST_ALPHA = 1 / 40, 1.5
ENDS = 14.0  # Height in design pixels of the labels below the ends of the softness slider.
MOST_BEADS = 12  # Largest number of beads that can be chosen in the panel.
OF_BEAD = ("mass", "velocity")  # Keys of the parameters that the panel shows for a selected bead.
COMPARE = 44.0  # Height of the button for the comparison in design pixels.
# Smallest height in design pixels for the text: its title and two lines. If less space is left, a button opens the
# text.
LEAST_TEXT = 76.0
SUM = 20.0  # Height in design pixels of a line with the total energy or momentum.
# Smallest height of a panel in design pixels that shows total energy and momentum. Smaller panels need the space for
# the text.
ROOM_FOR_SUMS = 480.0
# Smallest energy [J] or momentum [N s] that is shown. Smaller values are rounding errors and are written as 0.
SMALLEST_SUM = 1e-9
DOT = 6.0  # Radius in design pixels of the dot that shows the reliability.
# Velocities below this fraction of the largest velocity count as 0. The velocity of a bead at rest is a sum of
# increments.
ROUND_OFF = 1e-12


class ExplorePanel(Inspector):
    """The panel of Explore. It has controls for three numbers of the scene, and a button for a comparison.

    If a bead is selected, the panel shows its mass and velocity. A change restarts the experiment, which makes runs
    comparable.

    Arguments:
        health: function that returns the latest verdict on each lane.

    Attributes:
        play_again: function that plays the scene from the start.
    """

    play_again: Callable[[], None]

    def __init__(self, host: Host, session: Session, editor: SceneEditor, health: Callable[[], list[Health]]) -> None:
        super().__init__(host, session, editor)
        self.health = health
        # Vertical position of total energy and momentum [pixels], or None in a small panel.
        self._sums_at: float | None = None

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
        """Return the mass and the initial velocity of a bead. A change restarts the experiment."""
        found = [one for one in parameters(self.session, pick.lane, BEAD, pick.index) if one.key in OF_BEAD]
        lane = self._newest[pick.lane]
        start = lane.start.velocity(lane.chain)
        if pick.index >= len(start):  # The current frame is older than an edit that removed this bead.
            return found
        return [replace(one, value=float(start[pick.index])) if one.key == "velocity" else one for one in found]

    @property
    def _contact(self) -> int | None:
        """Index of the selected contact in the first lane, or None for all contacts."""
        pick = self.editor.selection
        return pick.index if pick is not None and pick.kind == "contact" and pick.lane == 0 else None

    def _laws(self) -> list[Contact]:
        """Return the laws of the first lane if all of them are power laws, otherwise an empty list."""
        laws = [law for law in self.session.lanes[0].chain.contact if isinstance(law, Contact)]
        plain = all(law.preload == 0.0 and law.stiffness > 0.0 for law in laws)
        return laws if plain and len(laws) == self.session.lanes[0].chain.contacts else []

    def _make(self) -> None:
        self.pick, self.choices = self.editor.selection, []
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
        self._sums_at = None
        if rect.height > ROOM_FOR_SUMS * unit:
            self._sums_at = y - 14 * unit
            y += 2 * SUM * unit
        chain, knob = self.session.lanes[0].chain, None
        if len(self.session.lanes) > 1:
            knob = _("Back to one row"), partial(self.host.act, "alone"), hint("alone")
        elif not chain.piecewise:
            text = _("Compare with steel balls") if has_soft_contacts(chain) else _("Compare with soft beads")
            knob = text, partial(self.host.act, "compare_balls"), _("the same blow in a second row below")
        knobs: list[Knob] = [] if knob is None else [knob]
        if rect.bottom - y < (COMPARE + LEAST_TEXT) * unit and (self.session.scene.text or self.questions.question):
            asks = bool(self.questions.choices)
            ask: Knob = (_("Predict"), partial(self.host.act, "lesson"), hint("lesson"))
            knobs.append(ask if asks else (_("Text"), self.show_text, _("what this scene is about")))
        if knobs:
            self._row(y, knobs, (0.0, 76.0)[-len(knobs) :] if len(knobs) > 1 else (), COMPARE)
            y += COMPARE * unit
        y += min(24 * unit, max(0.0, rect.bottom - y - 22 * unit))  # Leave space for the title of the text below.
        self._about = pygame.Rect(rect.left, round(y), rect.width, max(0, round(rect.bottom - y)))
        self._make_choices(self._about)

    def show_text(self) -> None:
        """Show the text of the scene, or its question, in a dialog."""
        title, *parts = about(self.session, self.questions, sources=False)
        self.host.choose(title, "\n".join(part for part in parts if part), {_("Close"): lambda: None})

    def _apply(self, control: Control, value: float, gesture: bool) -> bool:
        """Restart the experiment with another value of a parameter."""
        return self._begin_anew(self._edits(control.parameter, value), gesture)

    def _begin_anew(self, items: list[Input], gesture: bool = False) -> bool:
        """Return to the start and apply the edits. If the scene has been played, play it again at once."""
        played = self.session.history.last > 0
        taken = super()._begin_anew(items, gesture)
        if taken and played:
            self.play_again()
        return taken

    def _edits(self, parameter: Parameter, value: float) -> list[Input]:
        if parameter.key == "speed":
            return self._with_speed(value)
        if parameter.key != "alpha":
            return super()._edits(parameter, value)
        if not value > 0.0:
            raise ValueError(_("alpha must be a number > 0, not {given!r}", given=value))
        return self._with_alpha(value)

    def _at_start(self, parameter: Parameter, scene: Scene) -> Parameter:
        return parameter  # The parameters of this panel already have the values of the start.

    def _with_speed(self, speed: float) -> list[Input]:
        """Return the edits that give the first lane another speed. All velocities are multiplied by the same factor.

        If the first lane is at rest, the factor is applied to the velocities of the original scene. A speed > 0 has the
        direction of motion of the original scene.
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
        """Return the edits that change the exponent of all contacts or of the selected contact.

        The depth within which a contact stops an impact does not change.
        """
        lane, chosen = self._newest[0], self._contact
        contacts = range(lane.chain.contacts) if chosen is None else (min(chosen, lane.chain.contacts - 1),)
        return [SetContact(0, i, at_the_same_depth(lane.chain, i, alpha, lane.speed)) for i in contacts]

    def change_beads(self, by: int) -> None:
        """Add a bead at the right end of every lane (1), or remove the last bead (-1). A wall remains at the end."""
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
        """The lanes with all edits. This includes edits that are later than the current frame."""
        return self.session.history.newest_setup.lanes

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw the names of the parameters and the text of the scene."""
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
        chain = self.session.lanes[0].chain
        beads = f"{BODIES[body_word(chain)].words()['many']}: {chain.contacts + 1}"
        write(surface, beads, (rect.left, self._beads_at), 13 * unit, tones.foreground, align=(0, 0.5))
        self._still = self.host.pointer
        cut = paint_about(surface, self._about, unit, self.session, self.questions, self.choices, sources=False)
        self._whole = self._about, cut

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the dot that shows the reliability of the result. If a lane has a problem, draw a sentence about it.

        The sentence replaces the text of the scene.
        """
        if self.rect.width == 0:
            return
        self._paint_sums(surface)
        unit, states = self.host.unit, self.health()
        worst = max(states, key=lambda state: LEVELS.index(state.level), default=None)
        level = GOOD if worst is None else worst.level
        tint, place = getattr(tones, level), (self.rect.right - DOT * unit, self.rect.top + 14 * unit)
        pygame.draw.aacircle(surface, tint, place, DOT * unit)
        if worst is None or level == GOOD:
            return
        surface.fill(tones.background, self._about)
        write_wrapped(surface, worst.sentence, self._about, 16 * unit, tint)

    def _paint_sums(self, surface: pygame.Surface) -> None:
        """Write the total energy and the total momentum of each lane."""
        if self._sums_at is None:
            return
        unit, y = self.host.unit, self._sums_at
        motions = [lane.motion for lane in self.session.lanes]
        energies = [float(one.kinetic[0].sum() + one.stored[0]) for one in motions]
        momenta = [float(one.momentum[0].sum()) for one in motions]
        for name, values, of in ((_("energy"), energies, "J"), (_("momentum"), momenta, "N s")):
            write(surface, name, (self.rect.left, y), 13 * unit, tones.foreground)
            size, prefix = axis_prefix(max(map(abs, values)))
            texts = [plain(value / size if abs(value) > SMALLEST_SUM else 0.0) for value in values]
            text = f"{' | '.join(texts)} {prefix}{of}"
            write(surface, text, (self.rect.right, y), 13 * unit, tones.foreground, align=(1, 0))
            y += SUM * unit


def _unused(value: float) -> Input:
    """Raise NotImplementedError. The panel does not use the edits of its parameters, because a change needs several
    inputs.
    """
    raise NotImplementedError
