"""Schema of a scene file. A Scene contains lanes with one chain each, and a view. All objects are immutable."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, Strict, ValidationInfo, WrapValidator, field_validator, model_validator
from softcradle.physics import notebook_views
from softcradle.physics.chain import GRAVITY
from softcradle.physics.checked_input import magnitude, shown
from softcradle.physics.messages import Message
from softcradle.physics.methods import AUTO, refusal_of, refusal_of_fineness
from softcradle.physics.scales import require_computable
from softcradle.physics.simulation import checked_tolerance, endless
from softcradle.physics.state import checked_velocity
from softcradle.scenes.contact_table import ContactTable, table_of
from softcradle.scenes.other_names import remedy_of
from softcradle.scenes.toml_table import (
    AtLeastOne,
    Mass,
    NotNegative,
    Number,
    OneOrMany,
    Positive,
    Table,
    is_number,
    problem,
    raise_problems,
    suggestion,
)

from softcradle import physics

# Largest number of beads of a lane. This limit prevents a typing error from filling the memory.
MOST_BEADS = 100_000
# Largest ratio of film time to motion time, and of motion time to film time. The times of frames then remain valid
# times of a run.
MOST_SLOW = 1e20
# Places in a scene file. Messages use them after the word "belongs".
ABOVE_LANES = Message("above_lanes", "above the first [[lanes]]")
BELOW_LANES = Message("below_lanes", "to a lane, below [[lanes]]")
BELOW_VIEW = Message("below_view", "below [view]")
ONE_VELOCITY = Message(
    "one_velocity", "one velocity for all strikers needs beads = [strikers, targets]; else give a list of them"
)
Count = Annotated[int, Strict(), Field(ge=1, le=MOST_BEADS)]
Text = Annotated[str, BeforeValidator(lambda text: " ".join(text.split()) if isinstance(text, str) else text)]
# Text of a scene. A Message keeps its code and values, because a window may translate it. A file contains its English
# text.
Label = Annotated[Text, WrapValidator(lambda text, check: text if isinstance(text, Message) else check(text))]


class ForceTable(Table):
    """Force over time on some beads, or a brake.

    Attributes:
        beads: an index or a list of indices, from 0.
        time: a time [s] >= 0, or an ascending list of times. The force is linear between them, 0 before the first, and
            constant after the last.
        force: force [N] at each of these times, positive to the right. A brake acts against the motion, and its force
            is >= 0.
    """

    beads: OneOrMany[Annotated[int, Strict(), Field(ge=0)]]
    time: OneOrMany[NotNegative]
    force: OneOrMany[Number]

    @model_validator(mode="after")
    def _check(self) -> Self:
        self.timed_force()
        return self

    def timed_force(self) -> physics.TimedForce:
        """Return the force over time."""
        return physics.TimedForce(self.beads, self.time, self.force)


def is_count(value: Any) -> bool:
    """Return True if `value` is a valid number of beads."""
    return type(value) is int and 1 <= value <= MOST_BEADS


def count_of(lane: Mapping[str, Any]) -> int | None:
    """Return the number of beads of a lane, from the key `beads` or else from the length of a list.

    Return None if both are missing or invalid.
    """
    beads, mass, velocity = (lane.get(key) for key in ("beads", "mass", "velocity"))
    if isinstance(beads, list | tuple):
        return sum(beads) if len(beads) == 2 and all(map(is_count, beads)) else None
    if beads is not None:
        return beads if is_count(beads) else None
    lists = [given for given in (mass, velocity) if isinstance(given, list | tuple)]
    return len(lists[0]) if lists else None


def strikers_at(speed: Any, clusters: Any) -> tuple[Any, ...]:
    """Return the start velocities of all beads: strikers with the velocity `speed`, then targets at rest.

    `clusters` contains the numbers of strikers and targets. Return () if these numbers are not valid.
    """
    if not all(map(is_count, clusters)):
        return ()
    strikers, targets = clusters
    return (speed,) * strikers + (0.0,) * targets


class Lane(Table):
    """Lane of a scene: a chain and its start.

    Attributes:
        label: name of the lane in pictures and tables.
        beads: number of beads, or [strikers, targets]. The number is optional if `mass` or `velocity` is a list.
        mass: mass [kg], one number for all beads or a list. A bead with the mass inf is a wall.
        contact: contact law, one for all contacts, or a list from left to right.
        velocity: list of the velocities of all beads [m/s]. In a file with ``beads = [strikers, targets]`` it can
            be one number, the velocity of the strikers. The targets are then at rest.
        gap: gap [m], one number for all contacts or a list. With a gap of 0 two beads just touch. A negative gap is
            an overlap at the start.
        approach: gap between strikers and targets [m]. This key requires ``beads = [strikers, targets]``.
        drive: steady external force on every bead [N] from t = 0 on. The scene then needs a duration.
        friction: Coulomb coefficient of the bed on which the beads slide; 0 means no friction.
        forces: time-dependent forces on some beads, in addition to the drive.
        brakes: time-dependent brakes on some beads, in addition to the friction of the bed.
        strings: length [m] of the strings on which all beads hang. The scene then needs a duration. Each bead
            swings about its place at the start.
        gravity: acceleration of gravity [m/s²] for beads on strings. None means standard gravity.
    """

    label: Label = ""
    beads: OneOrMany[Count] | None = None
    mass: OneOrMany[Mass] = 1.0
    contact: OneOrMany[ContactTable]
    velocity: tuple[Number, ...]
    gap: OneOrMany[Number] = 0.0
    approach: NotNegative | None = None
    drive: tuple[Number, ...] | None = None
    friction: NotNegative = 0.0
    forces: tuple[ForceTable, ...] = ()
    brakes: tuple[ForceTable, ...] = ()
    strings: Positive | None = None
    gravity: Positive | None = None

    @classmethod
    def keys_elsewhere(cls) -> Mapping[str, str]:
        """Return the keys that belong to the scene or to its view, and where to write them."""
        above = dict.fromkeys(set(Scene.model_fields) - set(cls.model_fields), ABOVE_LANES)
        return dict.fromkeys(View.model_fields, BELOW_VIEW) | above

    @classmethod
    def mistakes(cls, table: dict[str, Any]) -> Iterator[str]:
        """Yield messages about unknown keys and about lists of wrong length.

        If `velocity` is a single number, replace it by a list in which all strikers have this velocity.
        """
        yield from super().mistakes(table)
        beads, velocity = table.get("beads"), table.get("velocity")
        if isinstance(beads, list | tuple):
            if len(beads) != 2:
                yield Message(
                    "clusters", "beads must be a number or [strikers, targets], not {given}", given=str(list(beads))
                )
            elif not isinstance(velocity, list | tuple) and is_number(velocity):
                table["velocity"] = strikers_at(velocity, beads)
        if table.get("approach") is not None and (
            not isinstance(beads, list | tuple) or isinstance(table.get("gap"), list | tuple)
        ):
            yield Message("approach", "approach needs beads = [strikers, targets] and no list of gaps")
        if table.get("gravity") is not None and table.get("strings") is None:
            remedy = remedy_of("gravity", table, [*cls.model_fields])
            table.pop("gravity")
            yield Message(
                "gravity",
                "gravity needs strings, a length in m; without strings {remedy}",
                remedy=remedy.sentence if remedy else "",
            )
        count = count_of(table)
        if count is None:
            return
        if not 2 <= count <= MOST_BEADS:
            yield Message(
                "lane_beads", "a chain needs from 2 to {most} beads, not {given}", most=MOST_BEADS, given=count
            )
            return
        expected = {"mass": count, "contact": count - 1, "velocity": count, "gap": count - 1, "drive": count}
        for key, length in expected.items():
            given = table.get(key)
            if isinstance(given, list | tuple) and len(given) != length:
                decimals = Message("decimals", "; decimals are written with a point")
                yield Message(
                    "list_length",
                    "{key} is a list of {given}, but {count} beads need {length}{comma}",
                    key=key,
                    given=len(given),
                    count=count,
                    length=length,
                    comma=decimals if len(given) == 2 * length else "",
                )

    @field_validator("velocity", mode="before")
    @classmethod
    def _require_list(cls, value: Any) -> Any:
        if isinstance(value, list | tuple):
            return value
        if not is_number(value):
            raise problem(
                Message(
                    "numbers",
                    "{what} must be a number or a list of numbers, not {given}",
                    what="velocity",
                    given=shown(value),
                )
            )
        raise problem(ONE_VELOCITY)

    @model_validator(mode="after")
    def _check_motion(self) -> Self:
        require_computable(self.chain(), checked_velocity(self.chain(), self.velocity))
        return self

    def _count(self) -> int:
        """Return the number of beads of this lane."""
        count = count_of({"beads": self.beads, "mass": self.mass, "velocity": self.velocity})
        assert count is not None  # After the checks, a lane always has a number of beads.
        return count

    @classmethod
    def of(cls, chain: physics.Chain, velocity: Sequence[float], label: str = "") -> Self:
        """Return the lane with the given chain and start velocities.

        User-defined contact laws cannot be written to a scene file.
        """
        laws = [
            table_of(contact) for contact in chain.contact if isinstance(contact, physics.Contact | physics.Coupler)
        ]
        table = {name: getattr(chain, name) for name in ("mass", "gap", "drive", "friction", "strings", "gravity")}
        if chain.strings is None:
            del table["strings"], table["gravity"]
        table |= {name: tuple(map(asdict, getattr(chain, name))) for name in ("forces", "brakes")}
        contact = laws[0] if all(law == laws[0] for law in laws) else laws
        return cls.model_validate({**table, "label": label, "contact": contact, "velocity": tuple(velocity)})

    def chain(self) -> physics.Chain:
        """Return the chain of this lane."""
        count = self._count()
        masses = self.mass if isinstance(self.mass, tuple) else (self.mass,) * count
        contacts = (
            [table.contact() for table in self.contact] if isinstance(self.contact, tuple) else self.contact.contact()
        )
        forces, brakes = ([table.timed_force() for table in tables] for tables in (self.forces, self.brakes))
        return physics.Chain(
            masses,
            contacts,
            self._gaps(count - 1),
            self.drive,
            self.friction,
            forces,
            brakes,
            self.strings,
            self.gravity or GRAVITY,
        )

    def _gaps(self, contacts: int) -> tuple[float, ...]:
        if isinstance(self.gap, tuple):
            return self.gap
        gaps = [self.gap] * contacts
        if self.approach is not None and isinstance(self.beads, tuple):
            gaps[self.beads[0] - 1] = self.approach
        return tuple(gaps)


class View(Table):
    """Settings of the picture of a scene.

    Attributes:
        slow: factor of slow motion: film time in seconds per second of motion.
        length: length of a bead [m].
        magnify: factor by which overlaps are drawn larger than they are. None means an automatic choice.
        after: time [s] for which a film continues after the last contact has opened. None means an automatic
            choice.
        labels: True if the numbers of the beads are drawn.
    """

    slow: Positive = 1.0
    length: Positive = 1.0
    magnify: AtLeastOne | None = None
    after: NotNegative | None = None
    labels: Annotated[bool, Strict()] = True

    @field_validator("length", "magnify", "after")
    @classmethod
    def _check_size(cls, number: float | None, info: ValidationInfo) -> float | None:
        magnitude(info.field_name or "", number or 1.0)
        return number

    @field_validator("slow")
    @classmethod
    def _check_slow(cls, slow: float) -> float:
        if not 1.0 / MOST_SLOW <= slow <= MOST_SLOW:
            raise problem(
                Message(
                    "slow_motion",
                    "{what} must be from {least:g} to {most:g}, not {given:g}",
                    what="slow",
                    least=1.0 / MOST_SLOW,
                    most=MOST_SLOW,
                    given=slow,
                )
            )
        return slow


class Scene(notebook_views.Moving, Table):
    """Scene: chains and their starts, the method, and the settings of the picture.

    Attributes
    ----------
    title : str
        Title, as the gallery shows it.
    text : str
        Description of the motion in two or three sentences.
    question : str
        Question to the viewer before the motion is played. The desktop window shows `text` only after the motion. A
        page shows both from the beginning.
    source : str
        Place in the paper.
    lanes : tuple of Lane
        Lanes with one chain each. All lanes are shown together.
    duration : float or None
        Duration [s]. None means that the run ends when every contact is open and none can close again.
    method : str or None
        Method of `simulate`. None usually means the default of `simulate`. None means `conserving` if a step is
        given, or if the default cannot compute a lane.
    step : float or None
        Time step of a fixed-step method [s]. None means the default of `simulate`.
    tolerance : float or None
        Tolerance of an adaptive method. None means the default of `simulate`. A tolerance is not allowed with a
        fixed-step method.
    view : View
        Settings of the picture.
    """

    title: Annotated[Text, Field(min_length=1)]
    text: Text = ""
    question: Text = ""
    source: Text = ""
    lanes: tuple[Lane, ...]
    duration: Positive | None = None
    method: str | None = None
    step: Positive | None = None
    tolerance: Positive | None = None
    view: View = View()

    @classmethod
    def keys_elsewhere(cls) -> Mapping[str, str]:
        """Return the keys that belong to a lane or to the view, and where to write them."""
        lane = dict.fromkeys(set(Lane.model_fields) - {"label"}, BELOW_LANES)
        return lane | dict.fromkeys(View.model_fields, BELOW_VIEW)

    @classmethod
    def mistakes(cls, table: dict[str, Any]) -> Iterator[str]:
        """Yield messages about unknown keys, and about a lane in single brackets.

        A lane in single brackets is then read as a list with one lane.
        """
        yield from super().mistakes(table)
        if isinstance(table.get("lanes"), Mapping):
            table["lanes"] = [table["lanes"]]
            yield Message("single_lane", "write [[lanes]] in double brackets, also for a single lane")

    @field_validator("lanes")
    @classmethod
    def _check_lanes(cls, lanes: tuple[Lane, ...]) -> tuple[Lane, ...]:
        if not lanes:
            raise problem(Message("no_lane", "a scene needs at least one lane"))
        return lanes

    @field_validator("method")
    @classmethod
    def _check_method(cls, name: str | None) -> str | None:
        known = [AUTO, *(method.name for method in physics.METHODS)]
        if name is not None and name not in known:
            words = suggestion(name, known)
            raise problem(Message("scene_method", "unknown method {name!r}{suggestion}", name=name, suggestion=words))
        return name

    @field_validator("duration", "step", "tolerance")
    @classmethod
    def _check_size(cls, number: float | None, info: ValidationInfo) -> float | None:
        if number is not None and info.field_name is not None:
            if info.field_name == "tolerance":
                checked_tolerance(number)
            else:
                magnitude(info.field_name, number)
        return number

    @model_validator(mode="after")
    def _check_settings(self) -> Self:
        chains = [lane.chain() for lane in self.lanes]
        reasons = []
        if self.method is not None:
            reasons = [refusal_of(self.method, chain) for chain in chains]
            reasons.append(refusal_of_fineness(self.method, self.step, self.tolerance))
        if self.duration is None:
            reasons += [endless(chain, lane.velocity) for chain, lane in zip(chains, self.lanes, strict=True)]
        raise_problems("Scene", filter(None, reasons), self)
        return self

    def settings(self, **overrides: Any) -> dict[str, Any]:
        """Return the keyword arguments for `physics.simulate`. The arguments are the settings of the scene, replaced by
        those `overrides` that are not None.

        If another method is given, the step and the tolerance of the scene are ignored, because they were chosen for
        the method of the scene. The tolerance of a scene without a method applies to every method. A step without a
        method means `conserving`, as in the desktop window. `conserving` also replaces `accurate` if `accurate` cannot
        compute a lane.
        """
        settings: dict[str, Any] = {"duration": self.duration}
        if overrides.get("method") in (None, self.method):
            settings |= {"method": self.method, "step": self.step, "tolerance": self.tolerance}
        elif self.method is None:
            settings["tolerance"] = self.tolerance
        settings |= {key: value for key, value in overrides.items() if value is not None}
        if settings.get("method") is None and (
            settings.get("step") is not None or any(refusal_of("accurate", lane.chain()) for lane in self.lanes)
        ):
            settings["method"] = "conserving"
        return {key: value for key, value in settings.items() if value is not None}

    def to_toml(self) -> str:
        """Return the text of a scene file that describes an equal scene. Keys with default values are left out."""
        import tomli_w

        return tomli_w.dumps(self.model_dump(exclude_defaults=True))

    def __repr__(self) -> str:
        lanes = " and ".join(f"{len(lane.velocity)} beads" for lane in self.lanes)
        return f"Scene({self.title!r}, {lanes})"

    __str__ = __repr__

    def live(self, slow: float | None = None) -> Any:
        """Return a page with the live simulation of the scene, for a cell of a notebook.

        With the extra [widget], the page has an attribute `state`, which follows the simulation, and a method `set`,
        which changes the settings.
        """
        return notebook_views.live_of(self, slow)
