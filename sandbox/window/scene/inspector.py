"""The inspector: what is selected, as sliders and typed numbers with units, and buttons that change it as a whole."""

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
from softcradle.sandbox.session.inputs import Input, SetContact, SetKind, SetMass
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.scene.about_scene import paint_about
from softcradle.sandbox.window.scene.editable_parameters import Parameter, number, parameters
from softcradle.sandbox.window.scene.lane_view import Pick
from softcradle.sandbox.window.window_page import Host

ROW, ENTRY = 45.0, 92.0  # design pixels
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
    """Edits go out through `apply(input) -> whether it was taken`."""

    def __init__(
        self, host: Host, session: Session, apply: Callable[[Input], bool], actions: dict[str, Callable[[], None]]
    ) -> None:
        self.host, self.session, self.apply, self.actions = host, session, apply, actions
        self.rect = pygame.Rect(0, 0, 0, 0)
        self.pick: Pick | None = None
        self.controls: dict[str, Control] = {}
        self.widgets: list[UIButton] = []
        self._waited = 0.0

    def build(self, rect: pygame.Rect) -> None:
        """Take its place in a page that is built anew: the old widgets are gone."""
        self.rect, self.controls, self.widgets = rect, {}, []
        self._make()

    def select(self, pick: Pick | None) -> None:
        """Show another bead or contact, or none."""
        if pick != self.pick:
            self.pick = pick
            self.remake()

    def remake(self) -> None:
        """Make the widgets again: what is selected, or its kind, has changed."""
        for control in self.controls.values():
            control.slider.kill()
            control.entry.kill()
        for widget in self.widgets:
            widget.kill()
        self.controls, self.widgets = {}, []
        self._make()

    def _make(self) -> None:
        if self.pick is None or self.rect.width == 0:
            return
        unit = self.host.unit
        y = self.rect.top + 31 * unit
        y = self._kinds(y) if self.pick.kind == "contact" else y
        for parameter in parameters(self.session, self.pick):
            if y + ROW * unit > self.rect.bottom - 34 * unit:
                break
            self.controls[parameter.key] = self._control(parameter, y)
            y += ROW * unit
        self._buttons(y + 4 * unit)

    def _control(self, parameter: Parameter, y: float) -> Control:
        unit, manager, left, right = self.host.unit, self.host.manager, self.rect.left, self.rect.right
        place = pygame.Rect(round(right - ENTRY * unit), round(y), round(ENTRY * unit), round(25 * unit))
        entry = UITextEntryLine(place, manager, initial_text=_text(parameter.value))
        bar = pygame.Rect(left, round(y + 27 * unit), right - left, round(13 * unit))
        slider = UIHorizontalSlider(bar, parameter.share(), (0.0, 1.0), manager)
        return Control(parameter, slider, entry, parameter.value)

    def _kinds(self, y: float) -> float:
        """Power law, draft gear, hard: one of three."""
        assert self.pick is not None
        unit, wide = self.host.unit, self.rect.width / 3
        now = kind_of(self.session.lanes[self.pick.lane].chain.contact[self.pick.index])
        for k, (kind, name) in enumerate(KIND_NAMES.items()):
            place = pygame.Rect(round(self.rect.left + k * wide), round(y), round(wide - 4 * unit), round(26 * unit))
            button = self._button(place, name, partial(self._turn, kind), "#chip", "law of this contact")
            if kind == now:
                button.select()
        return y + 31 * unit

    def _turn(self, kind: str) -> None:
        assert self.pick is not None
        self.apply(SetKind(self.pick.lane, self.pick.index, kind))

    def _buttons(self, y: float) -> None:
        assert self.pick is not None
        unit, half = self.host.unit, self.rect.width / 2
        locked = False
        if self.pick.kind == "contact":
            locked = self.session.lanes[self.pick.lane].setup.locked[self.pick.index] is not None
            texts: tuple[tuple[str, str | None], ...] = (
                ("unlock piston" if locked else "lock piston", "lock"),
                ("all alike", None),
            )
        else:
            texts = (("add bead", "add_bead"), ("remove bead", "remove_bead"))
        for k, (text, action) in enumerate(texts):
            place = pygame.Rect(round(self.rect.left + k * half), round(y), round(half - 4 * unit), round(28 * unit))
            if action is None:
                self._button(place, text, self._all_alike, None, "give this law to every contact of the lane")
            else:
                self._button(place, text, self.actions[action], None, hint(action))
        if self.pick.kind == "bead":
            wall = math.isinf(self.session.lanes[self.pick.lane].chain.mass[self.pick.index])
            place = pygame.Rect(self.rect.left, round(y + 33 * unit), round(half - 4 * unit), round(28 * unit))
            text = "free it" if wall else "make it a wall"
            self._button(place, text, self._wall, None, "a wall has no mass to move: it keeps its velocity")

    def _button(
        self, place: pygame.Rect, text: str, command: Callable[[], None], kind: str | None, tip: str
    ) -> UIButton:
        made = UIButton(place, text, self.host.manager, object_id=kind, tool_tip_text=tip, command=command)
        self.widgets.append(made)
        return made

    def _wall(self) -> None:
        if self.pick is not None:
            masses = self.session.lanes[self.pick.lane].chain.mass
            free = min(masses) if math.isinf(masses[self.pick.index]) else math.inf
            self.apply(SetMass(self.pick.lane, self.pick.index, free))

    def _all_alike(self) -> None:
        if self.pick is not None:
            law = self.session.lanes[self.pick.lane].chain.contact[self.pick.index]
            self.apply(SetContact(self.pick.lane, None, law))

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
                    self._typed(control, event.text)
                    return True
        return False

    def _typed(self, control: Control, text: str) -> None:
        try:
            value = number(text)
        except ValueError:
            self.host.messages.say(f"{control.parameter.name}: {text!r} is not a number", trouble=True)
            control.entry.set_text(_text(control.parameter.value))
            return
        self._set(control, value, typed=True)

    def _set(self, control: Control, value: float, typed: bool) -> None:
        try:
            wanted = control.parameter.edit(value)
        except ValueError as error:
            self.host.messages.say(str(error), trouble=True)
            wanted = None
        taken = wanted is not None and self.apply(wanted)
        if control.parameter.key in self.controls:  # it may have been made anew
            self.refresh(force=True, but=None if typed or not taken else control)

    def update(self, seconds: float) -> None:
        """Follow what moves, slowly enough to be read."""
        self._waited += seconds
        if self._waited >= SECONDS_BETWEEN_READINGS:
            self._waited = 0.0
            self.refresh()

    def refresh(self, force: bool = False, but: Control | None = None) -> None:
        """Show the values as they are; a number that is being typed, and the slider of `but`, are left alone."""
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
        """Whether a number is being typed: keys are its own."""
        return any(control.entry.is_focused for control in self.controls.values())

    @property
    def busy(self) -> bool:
        """Whether a widget is in use, which making them anew would take out of the hand."""
        return self.typing or any(_grabbed(control.slider) for control in self.controls.values())

    def backdrop(self, surface: pygame.Surface) -> None:
        """Title and names; without a selection, what the scene is about."""
        unit, rect = self.host.unit, self.rect
        if rect.width == 0:
            return
        if self.pick is None:
            paint_about(surface, rect, unit, self.session.scene)
            return
        lane = self.session.lanes[self.pick.lane]
        label = f" · {lane.label}" if len(self.session.lanes) > 1 and lane.label else ""
        colours, shape = bead_colours(lane.chain.contacts + 1), self.pick.index
        if self.pick.kind == "bead":
            title, colour = f"Bead {shape}{label}", colours[shape]
        else:
            title, colour = f"Contact {subscript(shape, shape + 1)}{label}", colours[shape + 1]
        draw_marker(surface, shape, (rect.left + 7 * unit, rect.top + 14 * unit), 6 * unit, colour)
        title = shortened(title, 16 * unit, rect.width - 22 * unit, bold=True)
        write(surface, title, (rect.left + 20 * unit, rect.top + 4 * unit), 16 * unit, FOREGROUND, bold=True)
        for control in self.controls.values():
            parameter, y = control.parameter, control.entry.rect.centery
            end = write(surface, parameter.name, (rect.left, y), 13 * unit, FOREGROUND, align=(0, 0.5)).right
            if parameter.unit:
                write(surface, parameter.unit, (end + 6 * unit, y), 12 * unit, MUTED, align=(0, 0.5))


def _grabbed(slider: UIHorizontalSlider) -> bool:
    return bool(slider.sliding_button is not None and slider.sliding_button.held)


def _text(value: float) -> str:
    return f"{value:.5g}"
