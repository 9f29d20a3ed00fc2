"""Table of editable numbers. Each number is declared once, and appears in the inspector, the table of values and the
sweeps.

Each number has an edit that sets it. Undo, recordings and replay use this edit. The scene file is written from the
edited lane.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

from softcradle.physics.contact import Contact
from softcradle.physics.coupler import Coupler
from softcradle.physics.scales import scales_at
from softcradle.sandbox.languages import N_, NP_, error_words
from softcradle.sandbox.motion import Motion
from softcradle.sandbox.quantities import BEAD, CONTACT, MASS, OVERLAP, VELOCITY
from softcradle.sandbox.session.contact_conversion import plain_contact
from softcradle.sandbox.session.inputs import Input, SetContact, SetDrive, SetFriction, SetGap, SetMass, SetVelocity
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Scene

DECADES = 2.0  # Range of a logarithmic slider in decades, above and below the value of the scene.
MOST_SPEED = 3.0  # Largest speed on the slider, relative to the closing speed of the scene.
MOST_LOSS = 0.95  # Largest loss on the slider. Draft gears absorb 0.8 and more.
MOST_FRICTION = 1.0  # Largest friction coefficient on the slider.
MOST_GAP = 2.0  # Largest gap on the slider, in lengths of a bead.
EXPONENTS = 0.01, 3.0  # Range of exponents on the slider.
# Exponents at which the slider stops. They include the values of the paper, springs (1) and Hertz contacts (3/2).
ROUND_EXPONENTS = (1 / 40, 1 / 20, 1 / 14, 1 / 10, 1 / 5, 1 / 2, 1.0, 3 / 2)
# Largest distance at which a slider stops at a round value, as a fraction of the slider's length. It is smaller than
# the step of the arrow keys (0.02). Otherwise the arrow keys could not move the slider away from a round value.
CATCH = 0.018
FEWEST_STOPS = 50  # Smallest number of stops of a linear slider.
LEAST = 1e-6  # Half the range of a slider if all its values are 0.

Ends = tuple[float, float]


@dataclass(frozen=True)
class Owner:
    """A bead or contact of a session, identified by its lane and index."""

    session: Session
    lane: int
    index: int

    @property
    def live(self) -> LiveLane:
        """The lane that contains the bead or contact."""
        return self.session.lanes[self.lane]

    @property
    def impact_force(self) -> float:
        """Force [N] in an impact at the speed of the scene. For a bead, it is the force of one of its contacts."""
        live = self.live
        contact = min(self.index, live.chain.contacts - 1)
        depth = scales_at(live.chain, live.setup.scale)[0][contact]
        return float(live.chain.contact[contact].force(float(depth)))


class EditableNumber(NamedTuple):
    """A number of every bead or contact that the user can change.

    Attributes:
        key: name of its widgets.
        owner: 'bead' or 'contact'.
        name, unit: text next to the slider, marked for translation.
        column: name and unit in the header of the table of values, marked in the context "column".
        values: function that returns the values of all beads or contacts of a lane; NaN if one has no such number.
        ends: function that returns the ends of the slider for the present value. A typed number may be outside.
        edit: function that returns the input that sets the number. It raises ValueError if the number is invalid.
        logarithmic: True if the slider is logarithmic.
        stops: values at which the slider stops, in addition to values with two digits.
    """

    key: str
    owner: str
    name: str
    unit: str
    column: str
    values: Callable[[LiveLane], Sequence[float]]
    ends: Callable[[Owner, float], Ends]
    edit: Callable[[Owner, float], Input]
    logarithmic: bool = False
    stops: Sequence[float] = ()


def _decades_around(value: float) -> Ends:
    return value * 10**-DECADES, value * 10**DECADES


def _masses(live: LiveLane) -> list[float]:
    return [mass if math.isfinite(mass) else math.nan for mass in live.chain.mass]


def _mass_ends(owner: Owner, _: float) -> Ends:
    masses = owner.session.scene.lanes[owner.lane].chain().mass
    return _decades_around(next((mass for mass in masses if math.isfinite(mass)), 1.0))


def _velocity_ends(owner: Owner, _: float) -> Ends:
    most = MOST_SPEED * max(owner.live.setup.speed, LEAST)
    return -most, most


def _of_beads(live: LiveLane, values: Sequence[float]) -> list[float]:
    """Return `values` with NaN for each wall, because no force and no friction can move a wall."""
    return [value if math.isfinite(mass) else math.nan for value, mass in zip(values, live.chain.mass, strict=True)]


def _drives(live: LiveLane) -> Sequence[float]:
    return _of_beads(live, live.chain.drive or (0.0,) * len(live.chain.mass))


def _frictions(live: LiveLane) -> Sequence[float]:
    return _of_beads(live, (live.chain.friction,) * len(live.chain.mass))


def _drive_ends(owner: Owner, _: float) -> Ends:
    drives = owner.session.scene.lanes[owner.lane].chain().drive, owner.live.chain.drive
    given = max(abs(force) for drive in drives for force in drive or (0.0,))
    most = 2.0 * (given or max(LEAST, owner.impact_force))
    return -most, most


def _stiffness_ends(owner: Owner, present: float) -> Ends:
    """Return the ends of a slider for stiffness. The range lies around the value of the scene and includes the present
    value.
    """
    laws = owner.session.scene.lanes[owner.lane].chain().contact
    law = laws[min(owner.index, len(laws) - 1)]
    low, high = _decades_around((law.stiffness if isinstance(law, Contact) else 0.0) or present)
    return min(low, present), max(high, present)


def _gap_ends(owner: Owner, _: float) -> Ends:
    """Return the ends of a slider for gaps. The upper end is a large distance, or the stop of a coupler that pulls."""
    law, most = owner.live.chain.contact[owner.index], MOST_GAP * owner.session.scene.view.length
    return 0.0, law.slack + min(law.travel, most) if isinstance(law, Coupler) and law.pull else most


def _of_law(field: str, has: Callable[[Contact], bool]) -> Callable[[LiveLane], list[float]]:
    def values(live: LiveLane) -> list[float]:
        return [
            getattr(law, field) if isinstance(law, Contact) and has(law) else math.nan for law in live.chain.contact
        ]

    return values


def _set_law(field: str) -> Callable[[Owner, float], Input]:
    def edit(owner: Owner, value: float) -> Input:
        law = plain_contact(owner.live.chain, owner.index)
        return SetContact(owner.lane, owner.index, replace(law, **{field: value}))

    return edit


def _is_power(law: Contact) -> bool:
    return law.stiffness > 0.0 and law.preload == 0.0


def _is_gear(law: Contact) -> bool:
    return law.stiffness > 0.0 and law.preload > 0.0


def _is_spring_gear(law: Contact) -> bool:
    return _is_gear(law) and law.exponent == 1.0


NUMBERS = (
    EditableNumber(
        "mass", BEAD, MASS.name, MASS.unit, MASS.column,
        _masses, _mass_ends, lambda at, value: SetMass(at.lane, at.index, value), logarithmic=True,
    ),
    EditableNumber(
        "velocity", BEAD, VELOCITY.name, VELOCITY.unit, VELOCITY.column,
        lambda live: live.velocity.tolist(), _velocity_ends, lambda at, value: SetVelocity(at.lane, at.index, value),
    ),
    EditableNumber(
        "drive", BEAD, N_("steady force"), "N", NP_("column", "steady force (N)"),
        _drives, _drive_ends, lambda at, value: SetDrive(at.lane, at.index, value),
    ),
    EditableNumber(
        "friction", BEAD, N_("friction of the bed"), "", NP_("column", "friction"),
        _frictions,
        lambda at, present: (0.0, max(MOST_FRICTION, present)), lambda at, value: SetFriction(at.lane, value),
    ),
    EditableNumber(
        "stiffness", CONTACT, N_("f0 (stiffness)"), "N/m^a", NP_("column", "f0 (N/m^a)"),
        _of_law("stiffness", lambda law: law.stiffness > 0.0 and not _is_spring_gear(law)),
        _stiffness_ends, _set_law("stiffness"), logarithmic=True,
    ),
    EditableNumber(
        "stiffness", CONTACT, N_("stiffness k"), "N/m", NP_("column", "k (N/m)"),
        _of_law("stiffness", _is_spring_gear), _stiffness_ends, _set_law("stiffness"), logarithmic=True,
    ),
    EditableNumber(
        "exponent", CONTACT, N_("alpha (exponent)"), "", NP_("column", "alpha"),
        _of_law("exponent", _is_power), lambda at, _: EXPONENTS, _set_law("exponent"), logarithmic=True, stops=ROUND_EXPONENTS,
    ),
    EditableNumber(
        "exponent", CONTACT, N_("exponent (1: spring)"), "", NP_("column", "exponent"),
        _of_law("exponent", _is_gear), lambda at, _: EXPONENTS, _set_law("exponent"), logarithmic=True, stops=ROUND_EXPONENTS,
    ),
    EditableNumber(
        "preload", CONTACT, N_("preload"), "N", NP_("column", "preload (N)"),
        _of_law("preload", lambda law: True),
        lambda at, present: (0.0, max(2.0 * present, 2.0 * at.impact_force)), _set_law("preload"),
    ),
    EditableNumber(
        "loss", CONTACT, N_("loss (0: elastic)"), "", NP_("column", "loss"),
        _of_law("loss", lambda law: True), lambda at, _: (0.0, MOST_LOSS), _set_law("loss"),
    ),
    EditableNumber(
        "gap", CONTACT, N_("gap to the next bead"), "m", OVERLAP.column,
        lambda live: (0.0 - live.state.overlap).tolist(),
        _gap_ends, lambda at, value: SetGap(at.lane, at.index, value),
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Parameter:
    """An editable number of one bead or contact, with its present value. See EditableNumber.

    The value is NaN if several beads or contacts have different values.
    """

    key: str
    name: str
    unit: str
    low: float
    high: float
    logarithmic: bool
    value: float
    edit: Callable[[float], Input]
    stops: Sequence[float] = ()

    def share(self) -> float:
        """Return the position of the value on the slider, from 0 to 1."""
        return self.share_of(self.value)

    def share_of(self, value: float) -> float:
        """Return the position of `value` on the slider, from 0 to 1."""
        if math.isnan(value):
            return 0.5
        if not math.isfinite(value):
            return 1.0
        low, high = self.low, self.high
        if self.logarithmic:
            low, high, value = (math.log(max(number, 1e-300)) for number in (low, high, value))
        return min(max((value - low) / (high - low), 0.0), 1.0)

    def at(self, share: float) -> float:
        """Return the round number nearest to the position `share` on the slider. At an end of the slider, return the
        end.
        """
        low, high = self.low, self.high
        ends = {0.0: low, 1.0: high}
        stops = ends if share in ends else {self.share_of(stop): stop for stop in self.stops}
        near = min(stops, key=lambda place: abs(place - share), default=math.inf)
        if abs(near - share) <= CATCH:
            return stops[near]
        if self.logarithmic:
            return float(f"{low * (high / low) ** share:.2g}")
        step = _round_step((high - low) / FEWEST_STOPS)
        return float(f"{round((low + share * (high - low)) / step) * step:.4g}") + 0.0


def _round_step(most: float) -> float:
    """Return the largest number of the form 1, 2 or 5 times a power of ten that is at most `most` > 0."""
    power = 10.0 ** math.floor(math.log10(most))
    return max(k * power for k in (1.0, 2.0, 5.0) if k * power <= most)


def parameters(session: Session, lane: int, kind: str, index: int) -> list[Parameter]:
    """Return the editable numbers of the bead or contact `index`; `kind` is 'bead' or 'contact'."""
    owner, found = Owner(session, lane, index), []
    for number in NUMBERS:
        values = number.values(owner.live)[index:] if number.owner == kind else ()
        value = next(iter(values), math.nan)
        if not math.isnan(value):
            low, high = number.ends(owner, value)
            edit = partial(number.edit, owner)
            name, unit, logarithmic = number.name, number.unit, number.logarithmic
            found.append(Parameter(number.key, name, unit, low, high, logarithmic, value, edit, number.stops))
    return found


@dataclass(frozen=True, eq=False)
class Variant:
    """The scene with one value of a parameter. `motion` is the motion of the lane, or None if it could not be computed."""

    value: float
    motion: Motion | None
    problem: str = ""


def variant_of(
    scene: Scene,
    lane: int,
    value: float,
    edits: Callable[[float], Sequence[Input]],
    motions: Callable[[Scene], list[Motion]],
) -> Variant:
    """Return the scene with another `value` of a parameter. The `edits` set the value at the start of the scene.

    `motions` is a function that computes the motion of every lane of a scene.
    """
    session = Session(scene)
    try:
        session.apply_all(edits(value))
        return Variant(value, motions(session.to_scene())[lane])
    except (UserError, ValueError, RuntimeError, ArithmeticError) as error:
        return Variant(value, None, error_words(error))
