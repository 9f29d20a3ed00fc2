"""The panel of the selected bead or contact, with sliders, text fields and buttons.

This module also contains the overlay for a sweep, which compares nine values of a parameter.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import ClassVar, Protocol

import numpy as np
import pygame
import pygame_gui
from pygame_gui.elements import UIButton
from softcradle.physics.contact import Contact
from softcradle.sandbox.draw.axes import linear_axis
from softcradle.sandbox.draw.curve_panels import Panel
from softcradle.sandbox.draw.palette import bead_colours, tones
from softcradle.sandbox.draw.supersampling import draw_marker
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.languages import N_, NP_, _, error_words, pgettext, scene_words
from softcradle.sandbox.quantities import VELOCITY
from softcradle.sandbox.session.contact_conversion import kind_of
from softcradle.sandbox.session.editable_numbers import Parameter, Variant, parameters, variant_of
from softcradle.sandbox.session.inputs import Input, SetContact, SetKind, SetMass
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.story.numbers import subscript
from softcradle.sandbox.window.dialog import Choices, Overlay, paint_box
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.page import Derived, Host
from softcradle.sandbox.window.plots.scales import motions_ahead
from softcradle.sandbox.window.scene.editor import PREPARING, Pick, SceneEditor, pick_title
from softcradle.sandbox.window.widgets import (
    Control,
    fits,
    number,
    number_text,
    paint_whole,
    parameter_control,
    split,
    stack,
    write_wrapped,
)
from softcradle.scenes import Scene

COLUMNS, ROWS = 3, 3
COUNT = COLUMNS * ROWS
STEPS = {pygame.K_LEFT: -1, pygame.K_RIGHT: 1, pygame.K_UP: -COLUMNS, pygame.K_DOWN: COLUMNS, pygame.K_TAB: 1}
HEAD = 46.0  # Height above the plots in design pixels.
MARGIN = 20.0  # Margin around the plots in design pixels.


def swept_values(parameter: Parameter) -> list[float]:
    """Return COUNT values of a parameter that are evenly spaced on its slider, from one end to the other."""
    return [parameter.at(k / (COUNT - 1)) for k in range(COUNT)]


class SweepBoard(Overlay):
    """An overlay that compares runs with different values of a parameter. Each run has a small plot.

    A click on a plot sets the parameter to its value. Esc closes the overlay.

    Attributes:
        values: values of all variants.
        found: the variants that are computed, in the order of their values.
    """

    choice_count = COUNT
    steps: ClassVar[Mapping[int, int]] = STEPS

    def __init__(
        self,
        host: Host,
        scene: Scene,
        lane: int,
        parameter: Parameter,
        edits: Callable[[float], Sequence[Input]],
        take: Callable[[float], object],
    ) -> None:
        self.parameter, self.edits, self.take, self.values = parameter, edits, take, swept_values(parameter)
        self.found: list[Variant] = []
        self._panels: list[Panel] = []
        self.places: list[pygame.Rect] = []
        super().__init__(host)
        self.focus = int(np.abs(np.array(self.values) - parameter.value).argmin())
        for value in self.values:
            host.warmup.submit(self._take_variant, partial(self._compute, scene, lane, value))

    def _compute(self, scene: Scene, lane: int, value: float) -> Variant | None:
        return variant_of(scene, lane, value, self.edits, motions_ahead) if self.open else None

    def _take_variant(self, found: object) -> None:
        if isinstance(found, Variant):
            self.found.append(found)
            self._make_panels()
        elif self.open and isinstance(found, Exception):
            self.close()
            self.host.messages.show(_("this cannot be swept: {error}", error=error_words(found)), warning=True)

    def make_widgets(self) -> None:
        """Place the overlay in the middle of the page and create its Close button."""
        unit, (wide, high) = self.host.unit, self.host.size
        self.box = pygame.Rect(0, 0, min(wide - 8, round(1100 * unit)), min(high - 8, round(640 * unit)))
        self.box.center = wide // 2, high // 2
        margin, head = round(MARGIN * unit), round(HEAD * unit)
        place = pygame.Rect(self.box.right - margin - round(84 * unit), self.box.top + round(10 * unit), 1, 1)
        place.size = round(84 * unit), round(28 * unit)
        self.button = UIButton(place, _("Close"), self.manager, command=self.close)
        inner = pygame.Rect(self.box.left + margin, self.box.top + head, self.box.width - 2 * margin, 1)
        inner.height = self.box.bottom - margin // 2 - inner.top
        rows = stack(inner, [0.0] * ROWS, unit)
        self.places = [place for row in rows for place in split(row, [0.0] * COLUMNS, unit)]
        self._make_panels()

    def _make_panels(self) -> None:
        """Create the plots. They have the same velocity axis, which makes them comparable. Each time axis is as long as
        its motion.
        """
        motions = [variant.motion for variant in self.found if variant.motion is not None]
        self._panels = []
        if not motions:
            return
        speeds = np.concatenate([motion.velocity.ravel() for motion in motions])
        low, high = min(0.0, float(speeds.min())), max(0.0, float(speeds.max()))
        room = 0.06 * (high - low) or 1.0
        colours = bead_colours(max(motion.velocity.shape[1] for motion in motions))
        names = [VELOCITY.symbol + subscript(k) for k in range(len(colours))]
        for variant, place in zip(self.found, self.places, strict=False):
            motion = variant.motion or motions[0]
            time = float(motion.time[0]), float(motion.time[-1])
            title = f"{_(self.parameter.name)} = {number_text(variant.value)} {self.parameter.unit}".strip()
            axis = linear_axis(shortened(title, 13 * self.host.unit, 0.8 * place.width), low - room, high + room)
            panel = Panel(place, self.host.unit, time, axis, colours=colours, names=names)
            panel.labelled &= variant.motion is not None
            if variant.motion is not None:
                panel.colours = colours[: variant.motion.velocity.shape[1]]
                panel.draw_curves(variant.motion.time, variant.motion.velocity)
            self._panels.append(panel)

    def handle(self, event: pygame.Event) -> bool:
        """Handle an event. A click on a variant uses its value. A click outside the box closes the overlay."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            if not self.box.collidepoint(event.pos):
                self.close()
            for k, place in enumerate(self.places):
                if place.collidepoint(event.pos):
                    self._choose(k)
        return super().handle(event)

    def take_choice(self) -> None:
        """Use the value of the variant that has the focus."""
        self._choose(self.focus)

    def _choose(self, k: int) -> None:
        """Close the overlay and use the value of variant `k`, if that variant has been computed."""
        if k < len(self.found):
            self.close()
            self.take(self.values[k])

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the dimmed page, the box and its plots."""
        unit = self.host.unit
        paint_box(surface, self.box, unit)
        title = _("Velocities (m/s) for nine values: {name}. Click one to use it.", name=_(self.parameter.name))
        room = self.button.rect.left - self.box.left - 2 * MARGIN * unit
        place = (self.box.left + MARGIN * unit, self.box.top + 13 * unit)
        write(surface, shortened(title, 16 * unit, room, bold=True), place, 16 * unit, tones.foreground, bold=True)
        for waiting in self.places[len(self.found) :]:
            write(surface, _("computing ..."), waiting.center, 16 * unit, tones.muted, align=(0.5, 0.5))
        for variant, panel in zip(self.found, self._panels, strict=False):
            self._paint_variant(surface, variant, panel)
        pygame.draw.rect(surface, tones.accent, self.places[self.focus], max(2, round(2 * unit)), border_radius=5)
        super().paint(surface)

    def _paint_variant(self, surface: pygame.Surface, variant: Variant, panel: Panel) -> None:
        """Draw the axes and curves of one variant, or the error message if it failed."""
        motion, count = variant.motion, len(panel.colours)
        end = np.zeros(count) if motion is None else motion.velocity[-1]
        panel.backdrop(surface, np.zeros(0), np.zeros((0, count)), end, 0.0)
        if motion is not None:
            panel.paint(surface, float(motion.time[-1]), end)
        write_wrapped(surface, variant.problem, panel.area, 13 * self.host.unit, tones.warning)


TIPS = N_("Click a bead or a contact to change it. Drag a bead and throw it. Space plays and pauses.")
CHANGED = N_("You changed this scene, so its description no longer fits. Press Play.")


PREDICT = N_("Choose an answer, or press Play. The explanation comes afterwards.")


# Height of a button with an answer, and distance between two such buttons, in design pixels.
CHOICE, CHOICE_GAP = 30.0, 6.0
ABOUT_TITLE = 31.0  # Height in design pixels of the title above a text.


class Questions(Protocol):
    """Interface for the questions that are asked before a scene is played."""

    @property
    def title(self) -> str:
        """The title above the question."""

    @property
    def question(self) -> str:
        """The text of the question. It is empty if there is no question."""

    @property
    def choices(self) -> Choices:
        """The buttons with the possible answers, below the question."""

    @property
    def explanations(self) -> Sequence[str]:
        """Sentences that explain the answers."""


@dataclass(frozen=True)
class NoQuestions:
    """An implementation of Questions without any question."""

    title: str = ""
    question: str = ""
    choices: Choices = field(default_factory=dict)
    explanations: Sequence[str] = ()


def about(session: Session, questions: Questions, sources: bool) -> tuple[str, str, str]:
    """Return a title, the text of the scene, and its source if `sources` is True.

    While a question is open, the question is returned instead of the text. For an edited scene, a note explains that
    the text may be wrong.
    """
    scene = session.scene
    if questions.question:
        return questions.title, questions.question, _(PREDICT)
    if session.edited and (scene.text or (scene.source and sources)):
        return _("About this scene"), _(CHANGED), ""
    text, source = scene_words(scene.text), scene_words(scene.source) if sources else ""
    text = " ".join([text, *questions.explanations]).strip()
    return _("About this scene") if text or source else "", text, source


def choice_places(rect: pygame.Rect, unit: float, questions: Questions) -> list[pygame.Rect]:
    """Return the rectangles of the answers below the question in `rect`. The list is empty if they do not fit."""
    size, count = 13 * unit, len(questions.choices)
    y = rect.top + ABOUT_TITLE * unit + 1.4 * size * len(wrapped(questions.question, size, rect.width)) + 8 * unit
    pitch = (CHOICE + CHOICE_GAP) * unit
    if y + count * pitch > rect.bottom:
        return []
    return [pygame.Rect(rect.left, round(y + k * pitch), rect.width, round(CHOICE * unit)) for k in range(count)]


def paint_about(
    surface: pygame.Surface,
    rect: pygame.Rect,
    unit: float,
    session: Session,
    questions: Questions,
    choices: Sequence[pygame.Rect] = (),
    sources: bool = True,
) -> str:
    """Draw the text about the scene into `rect`, below its title. Draw nothing if not even one line fits.

    `choices` are the rectangles of the buttons below a question. If the text does not fit into `rect`, return the
    complete text, otherwise an empty string.
    """
    size = 13 * unit
    tips = math.ceil(1.4 * size * len(wrapped(_(TIPS), size, rect.width)) + 1) if rect.height > 150 * unit else 0
    low = pygame.Rect(rect.left, rect.bottom - tips, rect.width, tips)
    if choices and low.top < choices[-1].bottom + 8 * unit:
        low.top, low.height = rect.bottom, 0
    write_wrapped(surface, _(TIPS), low, size, tones.muted)
    title, text, more = about(session, questions, sources)
    place = pygame.Rect(rect.left, round(rect.top + ABOUT_TITLE * unit), rect.width, 0)
    place.height = max(0, low.top - place.top - round(8 * unit))
    if place.height < 1.4 * size:
        return f"{text} {more}"
    write(surface, title, (rect.left, rect.top + 4 * unit), 16 * unit, tones.foreground, bold=True)
    whole = fits(text, place, size)
    end = write_wrapped(surface, text, place, size, tones.foreground)
    if choices:
        end = float(choices[-1].bottom)
    place.top, place.height = round(end + 8 * unit), max(0, round(low.top - end - 16 * unit))
    write_wrapped(surface, more, place, size, tones.muted)
    return "" if whole and (choices or fits(more, place, size)) else f"{text} {more}"


ROW = 40.0  # Height of a parameter in design pixels.
# Time in seconds between two updates of the numbers. Numbers that change faster cannot be read.
SECONDS_BETWEEN_READINGS = 0.15
KIND_NAMES = {
    "power": NP_("button", "alpha < 1"),
    "gear": NP_("button", "draft gear"),
    "hard": NP_("button", "alpha ≥ 1"),
}


Knob = tuple[str, Callable[[], object], str]  # A button: its text, its function, and its tooltip.


class Inspector:
    """The panel of the selected bead or contact.

    Attributes:
        pick: bead or contact of the present widgets; it follows the selection with a delay of one frame.
        controls: widgets of the parameters, by key.
        buttons: the other widgets.
        reset_view: function that moves the view back to its initial part of the line.
        keep_ghost: function that stores the curves of the present run. They are compared with the curves of the next
            run.
    """

    reset_view: Callable[[], None]
    keep_ghost: Callable[[], None]

    def __init__(self, host: Host, session: Session, editor: SceneEditor) -> None:
        self.host, self.session, self.editor = host, session, editor
        self.rect = pygame.Rect(0, 0, 0, 0)
        self.questions: Questions = NoQuestions()  # Questions that are asked before the scene is played.
        self.choices: list[pygame.Rect] = []  # Rectangles of the buttons with the choices of a question.
        self.pick: Pick | None = None
        self.controls: dict[str, Control] = {}
        self.buttons: list[UIButton] = []
        self._whole = self.rect, ""  # Rectangle of a text that does not fit, and the complete text.
        # Position of the pointer when the text appeared. The complete text appears only after the pointer has moved,
        # because it covers plots.
        self._still = (-1, -1)
        self._seconds = 0.0  # Seconds since the last update of the numbers.
        self._last = ""  # Key of the parameter that was changed last.
        self._made = Derived(self._made_of, self._remake)

    def build(self, rect: pygame.Rect) -> None:
        """Create the widgets while the page is rebuilt. The old widgets have already been removed."""
        self.rect, self.controls, self.buttons = rect, {}, []
        self._make()
        self._made.note()

    def follow(self) -> None:
        """Rebuild the widgets if the selection or its kind of contact has changed. A widget that is in use is not
        rebuilt.
        """
        self._take_left_entries()
        if self.busy and self.editor.selection == self.pick:
            self._made.note()
        else:
            self._made.follow()

    def _made_of(self) -> object:
        questions = self.questions
        return self.editor.selection, self.session.setup.chains, questions.title, questions.question

    def _remake(self) -> None:
        for control in self.controls.values():
            control.kill()
        for button in self.buttons:
            button.kill()
        self.controls, self.buttons = {}, []
        self._make()

    def _make(self) -> None:
        self.pick, self.choices = self.editor.selection, []
        if self.rect.width == 0:
            return
        if self.pick is None:
            self._make_choices(self.rect)
            return
        unit = self.host.unit
        y = self.rect.top + 31 * unit
        if self._law() is not None:
            self._make_kinds(self.pick, y)
            y += 31 * unit
        for parameter in self._parameters():
            if y + ROW * unit > self.rect.bottom - 34 * unit:
                break
            sweep = partial(self.sweep, parameter.key)
            self.controls[parameter.key] = parameter_control(self.host, self.rect, parameter, y, sweep)
            y += ROW * unit
        for k, row in enumerate(self._knobs(self.pick)):
            self._row(y + (4 + 34 * k) * unit, row)

    def _make_choices(self, rect: pygame.Rect) -> None:
        """Create a button in `rect` for each answer to the question, if they fit."""
        self.choices = choice_places(rect, self.host.unit, self.questions)
        for place, (text, command) in zip(self.choices, self.questions.choices.items(), strict=False):
            self.buttons.append(UIButton(place, text, self.host.manager, object_id="#chip", command=command))

    def _parameters(self) -> list[Parameter]:
        """Return the parameters that have controls in this panel."""
        return [] if self.pick is None else parameters(self.session, self.pick.lane, self.pick.kind, self.pick.index)

    def _law(self) -> Contact | None:
        """Return the law of the selected contact if edits can convert it, otherwise None.

        Couplers and user-defined contact laws cannot be converted.
        """
        if self.pick is None or self.pick.kind != "contact":
            return None
        law = self.session.lanes[self.pick.lane].chain.contact[self.pick.index]
        return law if isinstance(law, Contact) else None

    def _make_kinds(self, pick: Pick, y: float) -> None:
        """Create three buttons for the kind of contact: power law with an exponent below 1, draft gear, and hard
        contact.

        The button for a hard contact makes a soft contact stiff.
        """
        present, tip = kind_of(self.session.lanes[pick.lane].chain.contact[pick.index]), _("law of this contact")
        row = [
            (pgettext("button", name), partial(self.editor.apply, SetKind(pick.lane, pick.index, kind)), tip)
            for kind, name in KIND_NAMES.items()
        ]
        buttons = self._row(y, row, style="#chip")
        if present in KIND_NAMES:
            buttons[list(KIND_NAMES).index(present)].select()

    def _knobs(self, pick: Pick) -> list[list[Knob]]:
        """Return the rows of buttons below the parameters."""
        lane = self.session.lanes[pick.lane]
        if pick.kind == "contact":
            lock = _("lock piston") if lane.setup.locked[pick.index] is None else _("unlock piston")
            alike = (_("same for all"), self._copy_to_all, _("give this law to every contact of the lane"))
            return [[(lock, self.editor.lock, hint("lock")), alike]] if self._law() else []
        add = (_("add bead"), self.editor.add_bead, hint("add_bead"))
        remove = (_("remove bead"), self.editor.remove_bead, hint("remove_bead"))
        wall = _("back into a bead") if math.isinf(lane.chain.mass[pick.index]) else _("turn into a wall")
        return [[add, remove], [(wall, self._toggle_wall, _("a wall has infinite mass: it keeps its velocity"))]]

    def _row(
        self,
        y: float,
        row: Sequence[Knob | None],
        sizes: Sequence[float] = (),
        height: float = 28.0,
        style: str | None = None,
    ) -> list[UIButton]:
        """Create buttons side by side at the height `y`. An entry None in `row` leaves a gap.

        `sizes` are the widths of the buttons [design pixels]. Without `sizes`, all buttons are equally wide.
        """
        unit, first = self.host.unit, len(self.buttons)
        rect = pygame.Rect(self.rect.left, round(y), self.rect.width, round(height * unit))
        for place, knob in zip(split(rect, sizes or [0.0] * len(row), unit), row, strict=True):
            if knob is not None:
                text, command, tip = knob
                made = UIButton(place, text, self.host.manager, object_id=style, tool_tip_text=tip, command=command)
                self.buttons.append(made)
        return self.buttons[first:]

    def _toggle_wall(self) -> None:
        if self.pick is not None:
            masses = self.session.lanes[self.pick.lane].chain.mass
            mass = min(masses) if math.isinf(masses[self.pick.index]) else math.inf
            self.editor.apply(SetMass(self.pick.lane, self.pick.index, mass))

    def _copy_to_all(self) -> None:
        law = self._law()
        if self.pick is not None and law is not None:
            self.editor.apply(SetContact(self.pick.lane, None, law))

    def sweep(self, key: str = "") -> None:
        """Show runs with nine values of a parameter side by side.

        `key` selects the parameter. Without a key, the parameter that was changed last is used, or else the first
        parameter.
        """
        found = self._parameters()
        if not found:
            self.host.messages.hint(_("Select a bead or a contact to try values of its sliders."))
            return
        if self.editor.preparing:
            self.host.messages.hint(_(PREPARING))
            return
        wanted, lane = key or self._last, 0 if self.pick is None else self.pick.lane
        chosen = next((one for one in found if one.key == wanted), found[0])
        edits = partial(self._edits, chosen)
        try:
            scene = self.session.to_scene()
            parameter = self._at_start(chosen, scene)
            board = SweepBoard(self.host, scene, lane, parameter, edits, lambda value: self._begin_anew(edits(value)))
            self.host.put_over(board)
        except ValueError as error:
            self.host.messages.show(_("this cannot be swept: {error}", error=error_words(error)), warning=True)

    def _edits(self, parameter: Parameter, value: float) -> list[Input]:
        """Return the inputs that set a parameter to `value`."""
        return [parameter.edit(value)]

    def _at_start(self, parameter: Parameter, scene: Scene) -> Parameter:
        """Return the parameter with its value at the start of `scene`."""
        if self.pick is None:
            return parameter
        begun = parameters(Session(scene), self.pick.lane, self.pick.kind, self.pick.index)
        return next((one for one in begun if one.key == parameter.key), parameter)

    def _begin_anew(self, items: list[Input], gesture: bool = False) -> bool:
        """Return to the start, and apply all earlier edits and the new `items`.

        Without the return, an input at an old frame would remove later edits.
        """
        moved = self.session.frame != 0 or self.session.scrubbed
        if moved:
            self.keep_ghost()
        taken = self.editor.apply_all(items, gesture, anew=True, trial=self.host.explore)
        if taken and moved:
            self.reset_view()
        return taken

    def handle(self, event: pygame.Event) -> bool:
        """Handle events of the sliders and text fields."""
        if event.type == pygame_gui.UI_HORIZONTAL_SLIDER_MOVED:
            for control in self.controls.values():
                if event.ui_element is control.slider:
                    self._set(control, control.parameter.at(event.value), typed=False)
                    return True
        if event.type == pygame_gui.UI_TEXT_ENTRY_FINISHED:
            for control in self.controls.values():
                if event.ui_element is control.entry:
                    control.typed = False
                    # Remove the focus from the text field, so that keys trigger actions of the window again.
                    self.host.manager.set_focus_set(None)
                    if control.new_text() is not None:
                        self._type(control, event.text)
                    return True
        return False

    def cancel_typing(self) -> None:
        """Discard the text that is being typed."""
        for control in self.controls.values():
            control.typed = False
        self.host.manager.set_focus_set(None)
        self.refresh(force=True)

    def _take_left_entries(self) -> None:
        """Apply a typed number after its text field has lost the focus by a click elsewhere."""
        for control in list(self.controls.values()):
            text = control.left_text()
            if text is not None:
                self._type(control, text)
                return

    def _type(self, control: Control, text: str) -> None:
        try:
            value = number(text)
        except ValueError:
            wrong = _("{name}: {text!r} is not a number", name=_(control.parameter.name), text=text)
            self.host.messages.show(wrong, warning=True)
            self.refresh(force=True)
            return
        self._set(control, value, typed=True)

    def _set(self, control: Control, value: float, typed: bool) -> None:
        self._last = control.parameter.key
        try:
            accepted = self._apply(control, value, gesture=not typed)
        except ValueError as error:
            self.host.messages.show(str(error), warning=True)
            accepted = False
        if control.parameter.key in self.controls:  # The widgets may have been created again in the meantime.
            self.refresh(force=True, but=None if typed or not accepted else control)

    def _apply(self, control: Control, value: float, gesture: bool) -> bool:
        """Set a parameter. Return True if the value was accepted. Raise ValueError if the number is invalid."""
        return self.editor.apply_all(self._edits(control.parameter, value), gesture)

    def update(self, seconds: float) -> None:
        """Update the displayed numbers from time to time, so that they can be read."""
        self._seconds += seconds
        if self._seconds >= SECONDS_BETWEEN_READINGS:
            self._seconds = 0.0
            self.refresh()

    def refresh(self, force: bool = False, but: Control | None = None) -> None:
        """Show the present values. A number that is being typed does not change, and neither does the slider of `but`."""
        for parameter in self._parameters() if self.controls else ():
            control = self.controls.get(parameter.key)
            if control is None:
                continue
            control.show(parameter, force, with_slider=control is not but)

    @property
    def typing(self) -> bool:
        """True while a number is being typed. Keys then go into its text field."""
        return any(control.entry.is_focused for control in self.controls.values())

    @property
    def busy(self) -> bool:
        """True while a widget is in use and must not be created again."""
        return self.typing or any(control.grabbed for control in self.controls.values())

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw the title and the names of the parameters. If nothing is selected, draw the text of the scene."""
        unit, rect = self.host.unit, self.rect
        if rect.width == 0:
            return
        self._still = self.host.pointer
        if self.pick is None:
            self._whole = rect, paint_about(surface, rect, unit, self.session, self.questions, self.choices)
            return
        self._whole = rect, ""
        self._title(surface, self.pick)
        self._names(surface)

    def paint_over(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """Draw the complete text while the pointer is on a text that does not fit."""
        unit, (rect, text) = self.host.unit, self._whole
        if text and rect.width and rect.collidepoint(point) and point != self._still:
            corner = rect.left - round(14 * unit), rect.bottom
            paint_whole(surface, text, corner, round(1.4 * rect.width), unit)

    def _names(self, surface: pygame.Surface) -> None:
        """Draw the names and units of the parameters."""
        unit, rect = self.host.unit, self.rect
        for control in self.controls.values():
            parameter, y = control.parameter, control.entry.rect.centery
            end = write(surface, _(parameter.name), (rect.left, y), 13 * unit, tones.foreground, align=(0, 0.5)).right
            if parameter.unit:
                write(surface, parameter.unit, (end + 6 * unit, y), 13 * unit, tones.muted, align=(0, 0.5))

    def _title(self, surface: pygame.Surface, pick: Pick) -> None:
        unit, rect, lane = self.host.unit, self.rect, self.session.lanes[pick.lane]
        colours = bead_colours(lane.chain.contacts + 1)
        colour = colours[pick.index + (pick.kind == "contact")]
        draw_marker(surface, pick.index, (rect.left + 7 * unit, rect.top + 14 * unit), 6 * unit, colour)
        title = shortened(pick_title(self.session, pick), 16 * unit, rect.width - 22 * unit, bold=True)
        write(surface, title, (rect.left + 20 * unit, rect.top + 4 * unit), 16 * unit, tones.foreground, bold=True)
