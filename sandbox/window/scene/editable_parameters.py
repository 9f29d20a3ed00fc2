"""What can be edited of a bead or a contact: name, unit, range of the slider, and which input sets it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from softcradle.physics import Contact
from softcradle.sandbox.draw.number_format import MINUS
from softcradle.sandbox.session.inputs import Input, SetContact, SetDrive, SetFriction, SetGap, SetMass, SetVelocity
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.scene.lane_view import Pick

DECADES = 2.0  # that a logarithmic slider reaches on either side of the scene's own value
MOST_LOSS = 0.95  # of the slider; a gear absorbs 0.8 and more
MOST_FRICTION = 1.0  # of the slider


@dataclass(frozen=True)
class Parameter:
    """One number of a bead or contact.

    Attributes:
        key: names its widgets.
        name, unit: written beside them.
        low, high: ends of the slider; a typed number may lie beyond.
        logarithmic: whether the slider moves by factors.
        value: now.
        edit: the input that sets it to a number; ValueError where it cannot be.
        live: it changes while the model runs.
    """

    key: str
    name: str
    unit: str
    low: float
    high: float
    logarithmic: bool
    value: float
    edit: Callable[[float], Input]
    live: bool = False

    def share(self) -> float:
        """Where on the slider the value is, from 0 to 1."""
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
    """The numbers of what is picked."""
    lane = session.lanes[pick.lane]
    return _of_bead(session, lane, pick) if pick.kind == "bead" else _of_contact(session, lane, pick)


def _of_bead(session: Session, lane: LiveLane, pick: Pick) -> list[Parameter]:
    opened = session.scene.lanes[pick.lane].chain().mass
    usual = next((mass for mass in opened if math.isfinite(mass)), 1.0)
    speed = 3.0 * max(lane.setup.speed, 1e-6)
    mass, number = lane.chain.mass[pick.index], pick.index
    velocity = float(lane.velocity[number])
    found = []
    if math.isfinite(mass):
        low, high = usual * 10**-DECADES, usual * 10**DECADES
        found.append(Parameter("mass", "mass", "kg", low, high, True, mass, lambda m: SetMass(pick.lane, number, m)))
    found.append(
        Parameter(
            "velocity",
            "velocity",
            "m/s",
            -speed,
            speed,
            False,
            velocity,
            lambda v: SetVelocity(pick.lane, number, v),
            live=True,
        )
    )
    return found + _of_surroundings(session, lane, pick)


def _of_surroundings(session: Session, lane: LiveLane, pick: Pick) -> list[Parameter]:
    """The drive of a bead and the friction of the bed under all of them, where the scene or an edit has brought them."""
    opened, chain, found = session.scene.lanes[pick.lane].chain(), lane.chain, []
    if opened.drive or chain.drive:
        drives = [abs(force) for row in (opened, chain) for force in row.drive or (0.0,)]
        now, most = (chain.drive or (0.0,) * len(chain.mass))[pick.index], 2.0 * max(*drives, 1e-6)
        found.append(
            Parameter(
                "drive", "steady force", "N", -most, most, False, now, lambda f: SetDrive(pick.lane, pick.index, f)
            )
        )
    if opened.friction or chain.friction:
        most = max(MOST_FRICTION, chain.friction)
        found.append(
            Parameter(
                "friction", "friction of the bed", "", 0.0, most, False, chain.friction,
                lambda coefficient: SetFriction(pick.lane, coefficient),
            )
        )  # fmt: skip
    return found


def _of_contact(session: Session, lane: LiveLane, pick: Pick) -> list[Parameter]:
    law, length = lane.chain.contact[pick.index], session.scene.view.length
    gap = max(0.0, -float(lane.state.overlap[pick.index]))
    change = _changer(pick, law)
    gear = law.preload > 0.0
    alpha_name = "alpha (exponent)" if not gear else "exponent (1: spring)"
    factor_name, factor_unit = ("stiffness k", "N/m") if gear and law.exponent == 1.0 else ("f0 (stiffness)", "N/m^a")
    found = []
    if law.stiffness > 0.0:
        low, high = _around(session, pick, law.stiffness)
        found.append(
            Parameter("stiffness", factor_name, factor_unit, low, high, True, law.stiffness, change("stiffness"))
        )
        found.append(Parameter("exponent", alpha_name, "", 0.01, 3.0, True, law.exponent, change("exponent")))
    force = max(2.0 * law.preload, _force(session, pick))
    found.append(Parameter("preload", "preload", "N", 0.0, force, False, law.preload, change("preload")))
    found.append(Parameter("loss", "loss (0: elastic)", "", 0.0, MOST_LOSS, False, law.loss, change("loss")))
    found.append(
        Parameter(
            "gap",
            "gap to the next bead",
            "m",
            0.0,
            2.0 * length,
            False,
            gap,
            lambda g: SetGap(pick.lane, pick.index, g),
            live=True,
        )
    )
    return found


def _changer(pick: Pick, law: Contact) -> Callable[[str], Callable[[float], Input]]:
    """For a field of `law`, the function that makes the input which sets it."""

    def of(field: str) -> Callable[[float], Input]:
        return lambda value: SetContact(pick.lane, pick.index, replace(law, **{field: value}))

    return of


def _scene_law(session: Session, pick: Pick) -> Contact:
    laws = session.scene.lanes[pick.lane].chain().contact
    return laws[min(pick.index, len(laws) - 1)]


def _around(session: Session, pick: Pick, now: float) -> tuple[float, float]:
    """Ends of the slider of the stiffness: around the scene's own, and wide enough for the one there is now."""
    usual = _scene_law(session, pick).stiffness or now
    return min(usual * 10**-DECADES, now), max(usual * 10**DECADES, now)


def _force(session: Session, pick: Pick) -> float:
    """A force that means something in this scene: twice that of a contact pressed at the scene's speed."""
    from softcradle.physics.scales import contact_scales

    lane = session.lanes[pick.lane]
    law = lane.chain.contact[pick.index]
    depth = contact_scales(lane.chain, [0.0] * lane.chain.contacts + [lane.setup.speed])[0][pick.index]
    return 2.0 * float(law.force(float(depth)))


def number(text: str) -> float:
    """A typed number: 0.1, 1e-3, 1/14, with a comma or a true minus sign if need be. ValueError where it is none."""
    cleaned = text.replace(MINUS, "-").replace(",", ".").strip()
    numerator, slash, denominator = cleaned.partition("/")
    if slash and float(denominator) == 0.0:
        raise ValueError(f"{text!r} divides by zero")
    return float(numerator) / float(denominator) if slash else float(cleaned)
