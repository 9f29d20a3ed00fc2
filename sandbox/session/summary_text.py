"""A summary in words of what has happened in a session: who hit whom, how long it lasted, who goes where."""

from collections.abc import Callable
from functools import partial
from itertools import takewhile

from softcradle.physics.contact import is_closed
from softcradle.sandbox.languages import _, label_words, ngettext
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.trajectory_summary import clusters_in_words, first_hit_in_words, seconds_in_words, walls_of


def summary_text(session: Session) -> str:
    """Some sentences about each lane, up to the frame shown."""
    return " ".join([_("At {time}.", time=seconds_in_words(session.time)), _of_lanes(session, _lane)])


def outcome_text(session: Session) -> str:
    """Who goes where, in each lane, at the frame shown."""
    return _of_lanes(session, partial(_clusters, brief=True))


def _of_lanes(session: Session, words_of: Callable[[Session, int], str]) -> str:
    """What is said of each lane, behind its label where there are several, in a line of its own."""
    parts = []
    for lane in range(len(session.lanes)):
        label, words = label_words(session.label(lane)), words_of(session, lane)
        parts.append(_("{label}: {words}", label=label, words=words) if len(session.lanes) > 1 and label else words)
    return "\n".join(parts)


def _clusters(session: Session, lane: int, brief: bool = False) -> str:
    live = session.lanes[lane]
    return clusters_in_words(live.velocity.tolist(), walls_of(live.chain), live.setup.speed, brief)


def _lane(session: Session, lane: int) -> str:
    sentences = [_contacts(session, lane), _clusters(session, lane)]
    found = (item for item in session.findings(lane) if item.first <= session.frame)
    worst = next((item for item in found if item.level == "bad"), None)
    if worst is not None:
        text = _("Do not trust it: {cause} from {time} on.", cause=worst.cause, time=seconds_in_words(worst.begin))
        sentences.append(text)
    return " ".join(sentence for sentence in sentences if sentence)


def _contacts(session: Session, lane: int) -> str:
    """The first hit since there are as many beads, whose numbers are those of now, and how many contacts are closed."""
    events, live = session.contact_events(), session.lanes[lane]
    slices = reversed(session.history_slices(lane, session.frame + 1))
    alike = takewhile(lambda part: part.chain.contacts == live.chain.contacts, slices)
    begun = events.frame > min(part.first for part in alike)
    own = events.select((events.lane == lane) & begun & (events.frame <= session.frame))
    state = live.state
    closed = int(is_closed(state.overlap, state.force).sum())
    closings = own.select(own.closed)
    columns = closings.time.tolist(), closings.approach.tolist(), closings.contact.tolist()
    first = first_hit_in_words(list(zip(*columns, strict=True)), walls_of(live.chain), live.setup.speed)
    first += " " if first else ""
    if closed:
        return first + ngettext(
            "{n} of {all} contacts is closed.", "{n} of {all} contacts are closed.", closed, all=len(state.overlap)
        )
    last = own.select(~own.closed).time
    if not len(last):
        return first.strip()
    return first + _("The last contact opened at {time}.", time=seconds_in_words(float(last[-1])))
