"""Editable numbers of a bead or a contact: name, unit, range of the slider, the input that sets each, and its widgets."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import pygame
from pygame_gui.elements import UIButton
from softcradle.physics import Contact
from softcradle.physics.scales import contact_scales
from softcradle.sandbox.draw.number_format import MINUS
from softcradle.sandbox.languages import N_, _, localized
from softcradle.sandbox.session.inputs import Input, SetContact, SetDrive, SetFriction, SetGap, SetMass, SetVelocity
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.scene.scene_editor import Pick
from softcradle.sandbox.window.widgets import Slider, TextEntry
from softcradle.sandbox.window.window_page import Host

DECADES = 2.0  # of a logarithmic slider on either side of the scene's own value
MOST_SPEED = 3.0  # of the slider, relative to the scene's closing speed
MOST_LOSS = 0.95  # of the slider; draft gears absorb 0.8 and more
MOST_FRICTION = 1.0  # of the slider
MOST_GAP = 2.0  # of the slider, in lengths of a bead
LEAST = 1e-6  # half the range of a slider whose values are all 0


@dataclass(frozen=True)
class Parameter:
    """One number of a bead or contact.

    Attributes:
        key: name of its widgets.
        name, unit: written beside them.
        low, high: ends of the slider; a typed number may be beyond.
        logarithmic: whether the slider changes it by factors.
        value: at present.
        edit: the input that sets it to a number; ValueError where it cannot be.
    """

    key: str
    name: str
    unit: str
    low: float
    high: float
    logarithmic: bool
    value: float
    edit: Callable[[float], Input]

    def share(self) -> float:
        """Place of the value on the slider, from 0 to 1."""
        if not math.isfinite(self.value):
            return 1.0
        low, high, value = self.low, self.high, self.value
        if self.logarithmic:
            low, high, value = (math.log(max(number, 1e-300)) for number in (low, high, value))
        return min(max((value - low) / (high - low), 0.0), 1.0)

    def at(self, share: float) -> float:
        """The number at that place of the slider, to four digits: no slider is finer."""
        low, high = self.low, self.high
        value = low * (high / low) ** share if self.logarithmic else low + share * (high - low)
        span = self.high - self.low
        return 0.0 if not self.logarithmic and abs(value) < 1e-3 * span else float(f"{value:.4g}")


def parameters(session: Session, pick: Pick) -> list[Parameter]:
    """The parameters of a bead or contact."""
    lane = session.lanes[pick.lane]
    return _of_bead(session, lane, pick) if pick.kind == "bead" else _of_contact(session, lane, pick)


def _of_bead(session: Session, lane: LiveLane, pick: Pick) -> list[Parameter]:
    number, mass = pick.index, lane.chain.mass[pick.index]
    velocity, most = float(lane.velocity[number]), MOST_SPEED * max(lane.setup.speed, LEAST)
    found = []
    if math.isfinite(mass):
        masses = session.scene.lanes[pick.lane].chain().mass
        low, high = _decades_around(next((mass for mass in masses if math.isfinite(mass)), 1.0))
        edit = partial(SetMass, pick.lane, number)
        found.append(Parameter("mass", "mass", "kg", low, high, True, mass, edit))
    set_velocity = partial(SetVelocity, pick.lane, number)
    found.append(Parameter("velocity", "velocity", "m/s", -most, most, False, velocity, set_velocity))
    return [*found, *_of_drive(session, lane, pick), *_of_bed(session, lane, pick)]


def _of_drive(session: Session, lane: LiveLane, pick: Pick) -> list[Parameter]:
    """The steady force on a bead."""
    drives = session.scene.lanes[pick.lane].chain().drive, lane.chain.drive
    given = max(abs(force) for drive in drives for force in drive or (0.0,))
    most = 2.0 * (given or max(LEAST, _impact_force(lane, min(pick.index, lane.chain.contacts - 1))))
    force = (lane.chain.drive or (0.0,) * len(lane.chain.mass))[pick.index]
    edit = partial(SetDrive, pick.lane, pick.index)
    return [Parameter("drive", N_("steady force"), "N", -most, most, False, force, edit)]


def _of_bed(session: Session, lane: LiveLane, pick: Pick) -> list[Parameter]:
    """The friction of the bed of the lane."""
    friction = lane.chain.friction
    most = max(MOST_FRICTION, friction)
    edit = partial(SetFriction, pick.lane)
    return [Parameter("friction", N_("friction of the bed"), "", 0.0, most, False, friction, edit)]


def _of_contact(session: Session, lane: LiveLane, pick: Pick) -> list[Parameter]:
    law, length = lane.chain.contact[pick.index], session.scene.view.length
    gap, set_gap = -float(lane.state.overlap[pick.index]), partial(SetGap, pick.lane, pick.index)
    of_gap = Parameter("gap", N_("gap to the next bead"), "m", 0.0, MOST_GAP * length, False, gap, set_gap)
    if not isinstance(law, Contact):
        return [of_gap]
    force = max(2.0 * law.preload, 2.0 * _impact_force(lane, pick.index))

    def set_field(field: str) -> Callable[[float], Input]:
        return lambda value: SetContact(pick.lane, pick.index, replace(law, **{field: value}))

    found = []
    if law.stiffness > 0.0:
        low, high = _stiffness_range(session, pick, law.stiffness)
        factor, alpha = _stiffness_names(law)
        found.append(Parameter("stiffness", *factor, low, high, True, law.stiffness, set_field("stiffness")))
        found.append(Parameter("exponent", alpha, "", 0.01, 3.0, True, law.exponent, set_field("exponent")))
    return [
        *found,
        Parameter("preload", N_("preload"), "N", 0.0, force, False, law.preload, set_field("preload")),
        Parameter("loss", N_("loss (0: elastic)"), "", 0.0, MOST_LOSS, False, law.loss, set_field("loss")),
        of_gap,
    ]


def _stiffness_names(law: Contact) -> tuple[tuple[str, str], str]:
    """Name and unit of the stiffness, and the name of the exponent."""
    gear = law.preload > 0.0
    factor = (N_("stiffness k"), "N/m") if gear and law.exponent == 1.0 else (N_("f0 (stiffness)"), "N/m^a")
    return factor, N_("exponent (1: spring)") if gear else N_("alpha (exponent)")


def _stiffness_range(session: Session, pick: Pick, present: float) -> tuple[float, float]:
    """Ends of the slider of the stiffness: around the scene's own, and wide enough for the present one."""
    laws = session.scene.lanes[pick.lane].chain().contact
    law = laws[min(pick.index, len(laws) - 1)]
    low, high = _decades_around((law.stiffness if isinstance(law, Contact) else 0.0) or present)
    return min(low, present), max(high, present)


def _decades_around(value: float) -> tuple[float, float]:
    return value * 10**-DECADES, value * 10**DECADES


def _impact_force(lane: LiveLane, contact: int) -> float:
    """Force [N] of a contact that is struck at the scene's speed."""
    depth = contact_scales(lane.chain, [0.0] * lane.chain.contacts + [lane.setup.speed])[0][contact]
    return float(lane.chain.contact[contact].force(float(depth)))


def number(text: str) -> float:
    """A typed number: 0.1, 1e-3, 1/14, also with a comma or a minus sign of typography.

    ValueError where it is none, or not finite: a wall is made by its button, not by 1e999.
    """
    cleaned = text.replace(MINUS, "-").replace(",", ".").strip()
    numerator, slash, denominator = cleaned.partition("/")
    if slash and float(denominator) == 0.0:
        raise ValueError(_("{text!r} divides by zero", text=text))
    value = float(numerator) / float(denominator) if slash else float(cleaned)
    if not math.isfinite(value):
        raise ValueError(_("{text!r} is not finite", text=text))
    return value


ENTRY = 92.0  # design pixels of the box
SWEEP = 26.0  # design pixels of the button for a sweep


@dataclass
class Control:
    """The widgets of one parameter.

    Attributes:
        shown: the value in the box.
        typed: whether the box had the focus in the last frame.
    """

    parameter: Parameter
    slider: Slider
    entry: TextEntry
    sweep: UIButton | None
    shown: float
    typed: bool = False

    @property
    def grabbed(self) -> bool:
        """Whether the slider is held."""
        return bool(self.slider.sliding_button is not None and self.slider.sliding_button.held)

    def left_text(self) -> str | None:
        """What was typed into the box, if it has been left since the last frame and shows another number."""
        left, self.typed = self.typed and not self.entry.is_focused, self.entry.is_focused
        text = str(self.entry.get_text())
        return text if left and text != number_text(self.shown) else None

    def show(self, parameter: Parameter, force: bool, with_slider: bool) -> None:
        """Show another value; a number that is being typed, and a slider that is held, are left as they are."""
        self.parameter = parameter
        if (parameter.value == self.shown and not force) or self.entry.is_focused:
            return
        self.entry.set_text(number_text(parameter.value))
        if with_slider and not self.grabbed:
            self.slider.set_current_value(parameter.share())
        self.shown = parameter.value

    def kill(self) -> None:
        """Remove the widgets."""
        self.slider.kill()
        self.entry.kill()
        if self.sweep is not None:
            self.sweep.kill()


def parameter_control(
    host: Host, rect: pygame.Rect, parameter: Parameter, y: float, sweep: Callable[[], None] | None = None
) -> Control:
    """The widgets of `parameter` in the panel `rect`, from the height `y` on; `sweep` is done by a button of its own, if any."""
    unit, manager, left, right = host.unit, host.manager, rect.left, rect.right
    place = pygame.Rect(round(right - ENTRY * unit), round(y), round(ENTRY * unit), round(25 * unit))
    entry = TextEntry(place, manager, initial_text=number_text(parameter.value))
    wide = round(SWEEP * unit) if sweep else 0
    bar = pygame.Rect(left, round(y + 26 * unit), right - left - wide - round(4 * unit), round(12 * unit))
    button = None
    if sweep:
        tip = _("{name}: nine values side by side", name=_(parameter.name))
        place = pygame.Rect(right - wide, bar.top, wide, bar.height)
        button = UIButton(place, "…", manager, object_id="#chip", tool_tip_text=tip, command=sweep)
    slider = Slider(bar, parameter.share(), (0.0, 1.0), manager)
    slider.name = entry.name = f"{_(parameter.name)} {parameter.unit}".strip()
    return Control(parameter, slider, entry, button, parameter.value)


def number_text(value: float) -> str:
    """A number as the box shows it."""
    return localized(f"{value:.5g}")
