"""The story of a session up to the frame shown: who hit whom, how long it lasted, who goes where."""

from collections.abc import Callable
from itertools import takewhile

from softcradle.physics.contact import is_closed
from softcradle.sandbox.languages import _, label_words
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.story.lane_story import LaneStory, first_hit
from softcradle.sandbox.story.outcome import Outcome, outcome_of
from softcradle.sandbox.story.sentences import outcome_words, story_words, time_text


def summary_text(session: Session) -> str:
    """Return some sentences about each lane."""
    return " ".join([_("At {time}.", time=time_text(session.time)), _of_lanes(session, _lane_words)])


def outcome_text(session: Session) -> str:
    """Return who goes where, in each lane."""
    return _of_lanes(session, lambda session, lane: outcome_words(session_outcome(session, lane)))


def session_outcome(session: Session, lane: int) -> Outcome:
    """Return the outcome of a lane."""
    live = session.lanes[lane]
    return outcome_of(live.chain.mass, live.setup.start.velocity(live.chain).tolist(), live.velocity.tolist())


def _of_lanes(session: Session, words_of: Callable[[Session, int], str]) -> str:
    """Return the words of each lane in a line of its own, after its label if there are several lanes."""
    parts = []
    for lane in range(len(session.lanes)):
        label, words = label_words(session.label(lane)), words_of(session, lane)
        parts.append(_("{label}: {words}", label=label, words=words) if len(session.lanes) > 1 and label else words)
    return "\n".join(parts)


def _lane_words(session: Session, lane: int) -> str:
    """Return the story of a lane, with its gravest finding."""
    words = story_words(session_story(session, lane))
    found = (item for item in session.findings(lane) if item.first <= session.frame)
    worst = next((item for item in found if item.level == "bad"), None)
    if worst is None:
        return words
    return f"{words} {_('Do not trust it: {cause} from {time} on.', cause=worst.cause, time=time_text(worst.begin))}"


def session_story(session: Session, lane: int) -> LaneStory:
    """Return the story of a lane since it has had as many beads as now."""
    events, live = session.contact_events(), session.lanes[lane]
    slices = reversed(session.history_slices(lane, session.frame + 1))
    alike = takewhile(lambda part: part.chain.contacts == live.chain.contacts, slices)
    begun = events.frame > min(part.first for part in alike)
    own = events.select((events.lane == lane) & begun & (events.frame <= session.frame))
    closings, openings = own.select(own.closed), own.select(~own.closed).time
    columns = closings.time.tolist(), closings.approach.tolist(), closings.contact.tolist()
    return LaneStory(
        time=session.time,
        contacts=live.chain.contacts,
        closed=int(is_closed(live.state.overlap, live.state.force).sum()),
        opened=float(openings[-1]) if len(openings) else None,
        hit=first_hit(zip(*columns, strict=True), live.chain.mass, live.setup.speed),
        outcome=session_outcome(session, lane),
    )
