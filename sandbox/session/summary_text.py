"""Text about a session up to the visible frame: which beads collided, for how long, and how all beads move."""

from collections.abc import Callable
from itertools import takewhile

from softcradle.physics.contact import is_closed
from softcradle.sandbox.languages import _, scene_words
from softcradle.sandbox.motion import Array
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.contact_events import ContactEvents
from softcradle.sandbox.session.history_slices import slice_at
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.story.bodies import body_word
from softcradle.sandbox.story.lane_story import LaneStory, first_hit
from softcradle.sandbox.story.outcome import Outcome, outcome_of
from softcradle.sandbox.story.sentences import ending_words, story_words, time_text


def summary_text(session: Session) -> str:
    """Return some sentences about the motion of each lane."""
    return " ".join([_("At {time}.", time=time_text(session.time)), _of_lanes(session, _lane_words)])


def outcome_texts(session: Session) -> list[str]:
    """Return a text for each lane that describes how its beads move."""
    return [ending_words(session_story(session, lane)) for lane in range(len(session.lanes))]


def outcome_text(session: Session) -> str:
    """Return a text that describes how the beads of each lane move."""
    return _of_lanes(session, lambda session, lane: ending_words(session_story(session, lane)))


def session_outcome(session: Session, lane: int) -> Outcome:
    """Return the outcome of a lane.

    On a bed, friction continues to slow beads after they have separated. The outcome therefore contains the velocities
    at the moment of separation.
    """
    live = session.lanes[lane]
    start = live.setup.start.velocity(live.chain).tolist()
    return outcome_of(live.chain.mass, start, _told_velocity(session, lane).tolist())


def _told_velocity(session: Session, lane: int) -> Array:
    """Return the velocities for the story of a lane.

    They are usually the present velocities. On a bed, they are the velocities in the frame in which the last contact
    opened. If the scene has a duration, the present velocities are used in both cases.
    """
    live = session.lanes[lane]
    if (
        session.scene.duration is not None
        or not live.chain.on_bed
        or live.chain.brakes
        or live.endless
        or live.state.closed.any()
    ):
        return live.velocity
    events = _events(session, lane)
    opened = events.frame[~events.closed]
    if not len(opened) or _was_touched(session, int(opened[-1])):
        return live.velocity
    return slice_at(session.history, lane, int(opened[-1])).velocity[0]


def _was_touched(session: Session, frame: int) -> bool:
    """Return True if the user has edited a lane or pulled a bead at or after `frame`."""
    by_hand = inputs.LaneInput | inputs.Drag | inputs.Place
    return any(given >= frame and isinstance(item, by_hand) for given, item in session.recording.inputs)


def _events(session: Session, lane: int) -> ContactEvents:
    """Return the contact events of a lane up to the visible frame, since its number of beads last changed."""
    events, live = session.contact_events(), session.lanes[lane]
    slices = reversed(session.history_slices(lane, session.frame + 1))
    alike = takewhile(lambda part: part.chain.contacts == live.chain.contacts, slices)
    begun = events.frame > min(part.first for part in alike)
    return events.select((events.lane == lane) & begun & (events.frame <= session.frame))


def _of_lanes(session: Session, words_of: Callable[[Session, int], str]) -> str:
    """Return the words about each lane on a separate line. If there are several lanes, each line begins with the label."""
    parts = []
    for lane in range(len(session.lanes)):
        label, words = scene_words(session.label(lane)), words_of(session, lane)
        parts.append(_("{label}: {words}", label=label, words=words) if len(session.lanes) > 1 and label else words)
    return "\n".join(parts)


def _lane_words(session: Session, lane: int) -> str:
    """Return the story of a lane, followed by its first severe problem."""
    words = story_words(session_story(session, lane))
    found = (item for item in session.findings(lane) if item.first <= session.frame)
    worst = next((item for item in found if item.level == "bad"), None)
    if worst is None:
        return words
    fault = _("Do not trust it: {cause} from {time} on.", cause=worst.cause, time=time_text(worst.begin))
    return f"{words} {fault}"


def session_story(session: Session, lane: int) -> LaneStory:
    """Return the story of a lane since its number of beads last changed."""
    own, live = _events(session, lane), session.lanes[lane]
    closings, openings = own.select(own.closed), own.select(~own.closed).time
    columns = closings.time.tolist(), closings.approach.tolist(), closings.contact.tolist()
    return LaneStory(
        time=session.time,
        contacts=live.chain.contacts,
        closed=int(is_closed(live.state.overlap, live.state.force).sum()),
        opened=float(openings[-1]) if len(openings) else None,
        hit=first_hit(zip(*columns, strict=True), live.chain.mass, live.setup.speed),
        outcome=session_outcome(session, lane),
        stopped=bool(live.chain.on_bed and not live.velocity.any()),
        body=body_word(live.chain),
    )
