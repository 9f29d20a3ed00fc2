"""The inspector: the selected bead or contact, as sliders and typed numbers with units, and buttons."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import pygame
import pygame_gui
from pygame_gui.elements import UIButton, UIHorizontalSlider, UITextEntryLine
from softcradle.sandbox.draw.number_format import subscript
from softcradle.sandbox.draw.palette import FOREGROUND, MUTED, bead_colours
from softcradle.sandbox.draw.supersampling import draw_marker
from softcradle.sandbox.draw.text import shortened, write
from softcradle.sandbox.session.contact_conversion import kind_of
from softcradle.sandbox.session.inputs import SetContact, SetKind, SetMass
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.scene.about_scene import paint_about
from softcradle.sandbox.window.scene.editable_parameters import Parameter, number, parameters
from softcradle.sandbox.window.scene.pick import Pick
from softcradle.sandbox.window.scene.scene_editor import SceneEditor
from softcradle.sandbox.window.window_page import Host

ROW = 45.0  # design pixels of a parameter
ENTRY = 92.0  # design pixels of its number
SECONDS_BETWEEN_READINGS = 0.15  # numbers that change faster cannot be read
KIND_NAMES = {"power": "power law", "gear": "draft gear", "hard": "hard"}


@dataclass
class Control:
    """The widgets of one parameter."""

    parameter: Parameter
    slider: UIHorizontalSlider
    entry: UITextEntryLine
    shown: float


class Inspector:
    """The panel of the selection.

    Attributes:
        pick: the bead or contact that the widgets belong to: the selection, a frame later.
        controls: the widgets of its parameters, by key.
        buttons: its other widgets.
    """

    def __init__(self, host: Host, session: Session, editor: SceneEditor) -> None:
        self.host, self.session, self.editor = host, session, editor
        self.rect = pygame.Rect(0, 0, 0, 0)
        self.pick: Pick | None = None
        self.controls: dict[str, Control] = {}
        self.buttons: list[UIButton] = []
        self._seconds = 0.0  # since the numbers were last read

    def build(self, rect: pygame.Rect) -> None:
        """Make the widgets in a page that is built anew: the old ones are gone."""
        self.rect, self.controls, self.buttons = rect, {}, []
        self._make()

    def remake(self) -> None:
        """Make the widgets again: the selection, or the kind of the contact, has changed."""
        for control in self.controls.values():
            control.slider.kill()
            control.entry.kill()
        for button in self.buttons:
            button.kill()
        self.controls, self.buttons = {}, []
        self._make()

    def _make(self) -> None:
        self.pick = self.editor.selection
        if self.pick is None or self.rect.width == 0:
            return
        unit = self.host.unit
        y = self.rect.top + 31 * unit
        if self.pick.kind == "contact":
            self._make_kinds(self.pick, y)
            y += 31 * unit
        for parameter in parameters(self.session, self.pick):
            if y + ROW * unit > self.rect.bottom - 34 * unit:
                break
            self.controls[parameter.key] = self._control(parameter, y)
            y += ROW * unit
        if self.pick.kind == "contact":
            self._make_contact_buttons(self.pick, y + 4 * unit)
        else:
            self._make_bead_buttons(self.pick, y + 4 * unit)

    def _control(self, parameter: Parameter, y: float) -> Control:
        unit, manager, left, right = self.host.unit, self.host.manager, self.rect.left, self.rect.right
        place = pygame.Rect(round(right - ENTRY * unit), round(y), round(ENTRY * unit), round(25 * unit))
        entry = UITextEntryLine(place, manager, initial_text=_text(parameter.value))
        bar = pygame.Rect(left, round(y + 27 * unit), right - left, round(13 * unit))
        slider = UIHorizontalSlider(bar, parameter.share(), (0.0, 1.0), manager)
        return Control(parameter, slider, entry, parameter.value)

    def _make_kinds(self, pick: Pick, y: float) -> None:
        """Three buttons: power law, draft gear, hard."""
        unit, wide = self.host.unit, self.rect.width / 3
        present = kind_of(self.session.lanes[pick.lane].chain.contact[pick.index])
        for k, (kind, name) in enumerate(KIND_NAMES.items()):
            place = pygame.Rect(round(self.rect.left + k * wide), round(y), round(wide - 4 * unit), round(26 * unit))
            convert = partial(self.editor.apply, SetKind(pick.lane, pick.index, kind))
            button = self._button(place, name, convert, "law of this contact", "#chip")
            if kind == present:
                button.select()

    def _make_contact_buttons(self, pick: Pick, y: float) -> None:
        locked = self.session.lanes[pick.lane].setup.locked[pick.index] is not None
        left, right = self._halves(y)
        self._button(left, "unlock piston" if locked else "lock piston", self.editor.lock, hint("lock"))
        self._button(right, "all alike", self._copy_to_all, "give this law to every contact of the lane")

    def _make_bead_buttons(self, pick: Pick, y: float) -> None:
        left, right = self._halves(y)
        self._button(left, "add bead", self.editor.add_bead, hint("add_bead"))
        self._button(right, "remove bead", self.editor.remove_bead, hint("remove_bead"))
        wall = math.isinf(self.session.lanes[pick.lane].chain.mass[pick.index])
        below, _ = self._halves(y + 33 * self.host.unit)
        text = "free it" if wall else "make it a wall"
        self._button(below, text, self._toggle_wall, "a wall has no mass to move: it keeps its velocity")

    def _halves(self, y: float) -> tuple[pygame.Rect, pygame.Rect]:
        """Places of two buttons side by side."""
        unit, half = self.host.unit, self.rect.width / 2
        size = round(half - 4 * unit), round(28 * unit)
        left, right = ((round(self.rect.left + k * half), round(y)) for k in (0, 1))
        return pygame.Rect(left, size), pygame.Rect(right, size)

    def _button(
        self, place: pygame.Rect, text: str, command: Callable[[], object], tip: str, style: str | None = None
    ) -> UIButton:
        button = UIButton(place, text, self.host.manager, object_id=style, tool_tip_text=tip, command=command)
        self.buttons.append(button)
        return button

    def _toggle_wall(self) -> None:
        if self.pick is not None:
            masses = self.session.lanes[self.pick.lane].chain.mass
            mass = min(masses) if math.isinf(masses[self.pick.index]) else math.inf
            self.editor.apply(SetMass(self.pick.lane, self.pick.index, mass))

    def _copy_to_all(self) -> None:
        if self.pick is not None:
            law = self.session.lanes[self.pick.lane].chain.contact[self.pick.index]
            self.editor.apply(SetContact(self.pick.lane, None, law))

    def handle(self, event: pygame.Event) -> bool:
        """Sliders and typed numbers."""
        if event.type == pygame_gui.UI_HORIZONTAL_SLIDER_MOVED:
            for control in self.controls.values():
                if event.ui_element is control.slider:
                    self._set(control, control.parameter.at(event.value), typed=False)
                    return True
        if event.type == pygame_gui.UI_TEXT_ENTRY_FINISHED:
            for control in self.controls.values():
                if event.ui_element is control.entry:
                    self._type(control, event.text)
                    return True
        return False

    def _type(self, control: Control, text: str) -> None:
        try:
            value = number(text)
        except ValueError:
            self.host.messages.show(f"{control.parameter.name}: {text!r} is not a number", warning=True)
            control.entry.set_text(_text(control.parameter.value))
            return
        self._set(control, value, typed=True)

    def _set(self, control: Control, value: float, typed: bool) -> None:
        try:
            item = control.parameter.edit(value)
        except ValueError as error:
            self.host.messages.show(str(error), warning=True)
            item = None
        accepted = item is not None and self.editor.apply(item)
        if control.parameter.key in self.controls:  # the widgets may have been made again
            self.refresh(force=True, but=None if typed or not accepted else control)

    def update(self, seconds: float) -> None:
        """Follow the selection, and the numbers slowly enough to be read."""
        if self.editor.selection != self.pick:
            self.remake()
        self._seconds += seconds
        if self._seconds >= SECONDS_BETWEEN_READINGS:
            self._seconds = 0.0
            self.refresh()

    def refresh(self, force: bool = False, but: Control | None = None) -> None:
        """Show the present values; a number that is being typed, and the slider of `but`, are left as they are."""
        if self.pick is None or not self.controls:
            return
        for parameter in parameters(self.session, self.pick):
            control = self.controls.get(parameter.key)
            if control is None:
                continue
            control.parameter = parameter
            if (parameter.value != control.shown or force) and not control.entry.is_focused:
                control.entry.set_text(_text(parameter.value))
                if control is not but and not control.slider.has_moved_recently and not _grabbed(control.slider):
                    control.slider.set_current_value(parameter.share())
                control.shown = parameter.value

    @property
    def typing(self) -> bool:
        """Whether a number is being typed: keys belong to it."""
        return any(control.entry.is_focused for control in self.controls.values())

    @property
    def busy(self) -> bool:
        """Whether a widget is in use and must not be made again."""
        return self.typing or any(_grabbed(control.slider) for control in self.controls.values())

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw the title and the names of the parameters; without a selection, the text of the scene."""
        unit, rect = self.host.unit, self.rect
        if rect.width == 0:
            return
        if self.pick is None:
            paint_about(surface, rect, unit, self.session.scene)
            return
        self._title(surface, self.pick)
        for control in self.controls.values():
            parameter, y = control.parameter, control.entry.rect.centery
            end = write(surface, parameter.name, (rect.left, y), 13 * unit, FOREGROUND, align=(0, 0.5)).right
            if parameter.unit:
                write(surface, parameter.unit, (end + 6 * unit, y), 12 * unit, MUTED, align=(0, 0.5))

    def _title(self, surface: pygame.Surface, pick: Pick) -> None:
        unit, rect, lane = self.host.unit, self.rect, self.session.lanes[pick.lane]
        colours = bead_colours(lane.chain.contacts + 1)
        if pick.kind == "bead":
            title, colour = f"Bead {pick.index}", colours[pick.index]
        else:
            title, colour = f"Contact {subscript(pick.index, pick.index + 1)}", colours[pick.index + 1]
        if len(self.session.lanes) > 1 and lane.label:
            title = f"{title} · {lane.label}"
        draw_marker(surface, pick.index, (rect.left + 7 * unit, rect.top + 14 * unit), 6 * unit, colour)
        title = shortened(title, 16 * unit, rect.width - 22 * unit, bold=True)
        write(surface, title, (rect.left + 20 * unit, rect.top + 4 * unit), 16 * unit, FOREGROUND, bold=True)


def _grabbed(slider: UIHorizontalSlider) -> bool:
    return bool(slider.sliding_button is not None and slider.sliding_button.held)


def _text(value: float) -> str:
    return f"{value:.5g}"
