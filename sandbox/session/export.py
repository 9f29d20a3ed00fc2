"""Export of a session. The start with all edits is exported as a scene or as a line of text. The history is exported as
a trajectory.
"""

import base64
import binascii
import math
import zlib
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from pydantic import ValidationError
from softcradle.physics.chain import Chain, Joint
from softcradle.physics.contact import Contact, is_closed
from softcradle.physics.coupler import Coupler
from softcradle.physics.messages import Message
from softcradle.physics.methods import refusal_of_fineness
from softcradle.physics.simulation import endless
from softcradle.physics.state import State
from softcradle.physics.status import CodedWarning, WarningCode
from softcradle.physics.trajectory import Interval, Trajectory
from softcradle.sandbox.languages import _
from softcradle.sandbox.session.contact_conversion import kind_of
from softcradle.sandbox.session.contact_events import ContactEvents
from softcradle.sandbox.session.history_slices import HistorySlice
from softcradle.sandbox.session.lane_setup import DURATION, LaneSetup, Setup
from softcradle.sandbox.session.ledger import BY_BED, BY_CONTACTS, IMPULSE_GIVEN, VELOCITY_ERROR, WORK_GIVEN
from softcradle.scenes import Lane, Scene, load, names, parse
from softcradle.scenes.scene_errors import scene_error

LARGEST_DENOMINATOR = 60  # Largest denominator of an exponent that is written as a fraction.
EPSILON = float(np.finfo(float).eps)
PREFIX = "softcradle:"
MOST_BYTES = 2**20  # Largest size of the text of a scene in bytes.


def lane_label(label: str, before: Chain, now: Chain) -> str:
    """Return the label of a lane with the chain `now`. The lane had the label `label` with the chain `before`."""
    if (words := contacts_text(now.contact)) != contacts_text(before.contact):
        return words
    # The label of a scene file is plain text. Do not add the word "edited" twice.
    again = label.code == "edited" if isinstance(label, Message) else label.endswith(", edited")
    if _differ_by_gaps(before, now) or not label or again:
        return label
    return Message("edited", "{label}, edited", label=label)


def _differ_by_gaps(before: Chain, now: Chain) -> bool:
    """Return True if the chains differ only in their gaps."""
    return before.contacts == now.contacts and replace(before, gap=now.gap) == now


def contacts_text(contacts: tuple[Joint, ...]) -> str:
    """Return a short description of contacts, such as "alpha = 1/50" or "draft gear"."""
    laws, kinds = list(dict.fromkeys(map(_law_text, contacts))), set(map(kind_of, contacts))
    if len(laws) == 1:
        return laws[0]
    two = Message("two_laws", "{first} and {second}", first=laws[0], second=laws[1])
    if len(laws) == 2:
        return two
    return Message("more_laws", "{laws} ...", laws=two) if kinds == {"power"} else Message("mixed", "mixed contacts")


def _law_text(law: Joint) -> str:
    if not isinstance(law, Contact):
        return Message("coupler", "coupler") if isinstance(law, Coupler) else law.name
    if law.preload > 0.0 and law.exponent == 1.0:
        return Message("draft_gear", "draft gear")
    if law.preload > 0.0:
        return Message("preloaded", "preloaded contact")
    alpha = exponent_text(law.exponent)
    if law.exponent == 1.0:
        return Message("hooke", "Hooke, alpha = {alpha}", alpha=alpha)
    if law.exponent == 1.5:
        return Message("hertz", "Hertz, alpha = {alpha}", alpha=alpha)
    return Message("power", "alpha = {alpha}", alpha=alpha)


def exponent_text(exponent: float) -> str:
    """Return the exponent as text: a simple fraction if possible, otherwise a number with three digits."""
    fraction = Fraction(exponent).limit_denominator(LARGEST_DENOMINATOR)
    simple = fraction.numerator in (1, 3) and abs(float(fraction) - exponent) < 1e-9 * exponent
    return str(fraction) if simple else Message("digits", "{number:.3g}", number=exponent)


def scene_of(scene: Scene, setup: Setup, labels: Sequence[str]) -> Scene:
    """Return `scene` in the state `setup`, with one of the `labels` for each lane.

    Slow motion, method and step are included if all lanes share them. A lane without edits keeps its original form. A
    locked piston is written as the hard contact that replaces it. Raise SceneError if a scene file cannot express the
    state.
    """
    try:
        return _scene_of(scene, setup, labels)
    except ValidationError as error:
        raise scene_error("the scene", error) from None


def _scene_of(scene: Scene, setup: Setup, labels: Sequence[str]) -> Scene:
    lanes = tuple(_lane(*both) for both in zip(scene.lanes, setup.lanes, labels, strict=True))
    changed: dict[str, Any] = {**scene.model_dump(), "lanes": [lane.model_dump() for lane in lanes]}
    changed |= words_for(scene, lanes)
    changed["view"] = {**changed["view"], "slow": setup.slow}
    changed |= _method(scene, setup)
    if scene.duration is None and any(endless(lane.chain(), lane.velocity) for lane in lanes):
        changed["duration"] = DURATION
    return Scene.model_validate(changed)


def words_for(scene: Scene, lanes: tuple[Lane, ...]) -> dict[str, str]:
    """Return the texts of `scene` for `lanes`. Texts written by the user are kept. Texts of the catalogue are dropped
    if the lanes differ from the scene.
    """
    others = lanes != scene.lanes and scene.text in _catalogue_texts()
    said = {"text": "", "source": ""} if others else {"text": scene.text, "source": scene.source}
    return {"title": scene.title, "question": scene.question, **said}


@cache
def _catalogue_texts() -> frozenset[str]:
    return frozenset(load(name).text for name in names())


def _lane(old: Lane, new: LaneSetup, label: str) -> Lane:
    """Return `old` if `new` still has the same start. Otherwise return a lane in which each quantity is a list."""
    chain, start = new.chain, new.start
    velocity = _velocity(old, chain, start)
    gap = tuple((0.0 - start.overlap).tolist())  # Subtract from 0.0 to avoid -0.0 as a gap.
    before = old.chain()
    if _differ_by_gaps(before, chain) and (before.gap, old.velocity) == (gap, velocity):
        return old
    return Lane.of(replace(chain, gap=gap), velocity, label)


def _velocity(old: Lane, chain: Chain, start: State) -> tuple[float, ...]:
    """Return the (n+1,) initial velocities [m/s] of a chain.

    Velocities of a state are sums of rates and have rounding errors. If the velocities of `old` lead to the same state,
    they are returned with their original digits. Otherwise the same is tried with rounded velocities.
    """
    found = start.velocity(chain)
    for written in (np.array(old.velocity), found.round(12) + 0.0):  # Add 0.0 to replace -0.0 by 0.0.
        if written.size == found.size:
            begun = State.at_start(chain, written)
            off = np.abs([*(begun.rate - start.rate), begun.anchor[1] - start.anchor[1]]).max()
            if off <= 4.0 * EPSILON * np.abs(written).max():
                return tuple(written.tolist())
    return tuple(found.tolist())


def _method(scene: Scene, setup: Setup) -> dict[str, Any]:
    """Return the method and the step if all lanes share them, otherwise those of the scene. None means an automatic
    choice.

    The tolerance is kept if the method uses a tolerance.
    """
    method, *others = (None if lane.automatic else lane.method for lane in setup.lanes)
    if any(other != method for other in others):
        return {}
    step, *further = (lane.step if lane.step_given else None for lane in setup.lanes)
    if any(other != step for other in further):
        step = scene.step if method == scene.method else None
    tolerance = None if method and refusal_of_fineness(method, None, scene.tolerance) else scene.tolerance
    return {"method": method, "step": step, "tolerance": tolerance}


def trajectory_of(part: HistorySlice, lane: int, events: ContactEvents, kept: int) -> Trajectory:
    """Return `part` of the history of lane number `lane` as a Trajectory.

    If the part begins after frame 0, a warning contains the frame at which it begins. `kept` is the oldest frame of the
    history; a part that begins there has another reason in its warning.
    """
    why = "the oldest that is kept" if part.first == kept else "where the chain or its method was last changed"
    sentence = f"exported from a session: begins at frame {part.first}, {why}"
    late = CodedWarning(WarningCode.LATE_START, sentence, {"frame": part.first})
    booked, error = part.ledger - part.ledger[0], float(part.ledger[-1, VELOCITY_ERROR])
    found = Trajectory(
        chain=part.chain,
        time=part.time,
        overlap=part.overlap,
        rate=part.rate,
        anchor=part.anchor,
        force=part.force,
        final_velocity=part.velocity[-1],
        contact_intervals=_intervals(part, events.select(events.lane == lane)),
        method=part.setup.method,
        step=part.step,
        tolerance=0.0 if part.step else part.setup.tolerance,
        warnings=(late,) if part.first > 0 else (),
        absorbed_by_contacts=booked[:, BY_CONTACTS],
        absorbed_by_bed=booked[:, BY_BED],
        given=booked[:, [WORK_GIVEN, IMPULSE_GIVEN]],
        velocity_error=np.full(part.chain.contacts + 1, error if error >= 0.0 else np.nan),
    )
    # The work of a constant drive is counted from t = 0 and from the gaps of the chain. After an edit the beads start
    # at other positions.
    before = found.driven[0], found.impulse[0]
    return replace(found, given=found.given - before)


def _intervals(part: HistorySlice, events: ContactEvents) -> tuple[tuple[Interval, ...], ...]:
    """Return the (closed, opened) times of every contact within `part`.

    If a contact is closed in the first row of `part`, its interval begins at that row.
    """
    closed_first = is_closed(part.overlap[0], part.force[0])
    last = part.first + part.time.size - 1
    within = events.select((events.frame > part.first) & (events.frame <= last))
    found: list[tuple[Interval, ...]] = []
    for contact in range(part.chain.contacts):
        own = within.select(within.contact == contact)
        closings = own.time[own.closed].tolist()
        if closed_first[contact]:
            closings.insert(0, float(part.time[0]))
        openings = own.time[~own.closed].tolist()
        found.append(tuple(zip(closings, openings + [math.inf] * (len(closings) - len(openings)), strict=True)))
    return tuple(found)


def shared_text(scene: Scene) -> str:
    """Return the scene as one line of text."""
    packed = zlib.compress(scene.to_toml().encode(), 9)
    return PREFIX + base64.urlsafe_b64encode(packed).decode().rstrip("=")


def is_shared_text(text: str) -> bool:
    """Return True if `text` looks like the text of a shared scene."""
    return text.strip().startswith(PREFIX)


def scene_from_text(text: str) -> Scene:
    """Return the scene from a text written by :func:`shared_text`. Spaces and line breaks in the text are ignored.

    Raise ValueError for any other text.
    """
    letters = "".join(text.split()).removeprefix(PREFIX)
    try:
        packed = base64.urlsafe_b64decode(letters + "=" * (-len(letters) % 4))
        unpacker = zlib.decompressobj()
        toml = unpacker.decompress(packed, MOST_BYTES)
        complete = unpacker.eof
    except (binascii.Error, zlib.error, ValueError):
        complete, toml = False, b""
    if not complete:
        raise ValueError(_("the text is not a whole scene: copy all of it, from 'softcradle:' to its end"))
    return parse(toml.decode(errors="replace"), _("the pasted scene"))
