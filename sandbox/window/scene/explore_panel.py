"""The panel of the first level: alpha of the whole row, speed, number of beads, and the same blow among steel balls."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pygame
from softcradle.physics.contact import Contact
from softcradle.sandbox.draw.number_format import MINUS
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import wrapped, write
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.session.badge_numbers import GOOD, LEVELS, Health
from softcradle.sandbox.session.contact_conversion import at_the_same_depth, has_soft_contacts
from softcradle.sandbox.session.inputs import AddBead, Input, RemoveBead, SetContact, SetVelocity
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.scene.about_scene import paint_about
from softcradle.sandbox.window.scene.editable_parameters import MOST_SPEED, Parameter
from softcradle.sandbox.window.scene.inspector import ROW, Inspector
from softcradle.sandbox.window.scene.parameter_control import Control, parameter_control
from softcradle.sandbox.window.scene.scene_editor import SceneEditor
from softcradle.sandbox.window.window_page import Host

LEAST_ALPHA, MOST_ALPHA = 1 / 30, 1.5
MOST_BEADS = 12  # that can be chosen here
DOT = 6.0  # design pixels, the radius of the badge


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
        laws = self._laws()
        if laws:
            name = N_("alpha of this contact") if self._contact is not None else N_("alpha of the whole row")
            alpha = laws[self._contact or 0].exponent
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
        side = round(30 * unit)
        self._beads_at = y + 0.5 * side
        for k, (text, change) in enumerate(((MINUS, -1), ("+", 1))):
            place = pygame.Rect(rect.right - (2 - k) * side - (1 - k) * round(6 * unit), round(y), side, side)
            self._button(
                place, text, partial(self.change_beads, change), _("one bead fewer") if k == 0 else _("one bead more")
            )
        y += side + 14 * unit
        if len(self.session.lanes) == 1 and not self.session.lanes[0].chain.couplers:
            text = (
                _("Compare with steel balls")
                if has_soft_contacts(self.session.lanes[0].chain)
                else _("Compare with soft beads")
            )
            place = pygame.Rect(rect.left, round(y), rect.width, round(44 * unit))
            self._button(place, text, partial(self.host.act, "compare_balls"), _("the same blow in a second row below"))
            y += 58 * unit
        self._about = pygame.Rect(rect.left, round(y), rect.width, max(0, round(rect.bottom - y)))

    def _apply(self, control: Control, value: float, gesture: bool) -> bool:
        """Begin anew with another number."""
        if control.parameter.key == "alpha":
            return self._anew(self._with_alpha(value), gesture)
        lane = self.session.lanes[0]
        factor = value / (control.parameter.value or 1.0)
        items: list[Input] = []
        for k, live in enumerate(self.session.lanes):
            start = live.setup.start.velocity(live.chain)
            items += [SetVelocity(k, bead, factor * float(v)) for bead, v in enumerate(start) if v != 0.0]
        return self._anew(items or [SetVelocity(0, 0, value)] * bool(lane.chain.contacts), gesture)

    def _with_alpha(self, alpha: float) -> list[Input]:
        """Another alpha of the row, or of the selected contact: the blow is stopped within the same depth."""
        if not alpha > 0.0:
            raise ValueError(_("alpha must be a number > 0, not {given!r}", given=alpha))
        lane, chosen = self.session.lanes[0], self._contact
        contacts = range(lane.chain.contacts) if chosen is None else (chosen,)
        found = {i: at_the_same_depth(lane.chain, i, alpha, lane.setup.speed) for i in contacts}
        first = next(iter(found.values()))
        if chosen is None and all(law == first for law in found.values()):
            return [SetContact(0, None, first)]
        return [SetContact(0, i, law) for i, law in found.items()]

    def change_beads(self, by: int) -> None:
        """Add a bead at the right end of every lane, or take the last one away."""
        last = min(lane.chain.contacts for lane in self.session.lanes)
        if not 2 <= last + 1 + by <= MOST_BEADS:
            self.host.messages.show(_("from 2 to {most} beads can be chosen here", most=MOST_BEADS))
            return
        items: list[Input] = []
        for k, lane in enumerate(self.session.lanes):
            end = lane.chain.contacts
            items.append(AddBead(k, end + 1, lane.chain.mass[end]) if by > 0 else RemoveBead(k, end))
        self._anew(items, gesture=False)

    def _anew(self, items: list[Input], gesture: bool) -> bool:
        """Go back to the start, and apply the inputs; whether all were accepted."""
        if self.session.frame != 0:
            self.session.pause()
            self.host.act("restart")
        return all(self.editor.apply(item, gesture or k > 0) for k, item in enumerate(items))

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw the names and the text of the scene."""
        unit, rect = self.host.unit, self.rect
        if rect.width == 0:
            return
        write(surface, _("Try it"), (rect.left, rect.top + 4 * unit), 16 * unit, tones.foreground, bold=True)
        self._names(surface)
        beads = _("beads: {n}", n=self.session.lanes[0].chain.contacts + 1)
        write(surface, beads, (rect.left, self._beads_at), 13 * unit, tones.foreground, align=(0, 0.5))
        paint_about(surface, self._about, unit, self.session)

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
        for k, line in enumerate(wrapped(worst.sentence, 13 * unit, self._about.width)):
            write(surface, line, (self._about.left, self._about.top + 18 * k * unit), 13 * unit, tint)


def _unused(value: float) -> Input:
    """The panel applies its numbers itself: several inputs at once."""
    raise NotImplementedError
