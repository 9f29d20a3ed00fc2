"""Sentences that describe a motion, in the current language."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics.checked_input import LARGEST
from softcradle.sandbox.languages import N_, _, ngettext
from softcradle.sandbox.story.bodies import BODIES, capital
from softcradle.sandbox.story.lane_story import Hit, LaneStory, story_of
from softcradle.sandbox.story.numbers import plain
from softcradle.sandbox.story.outcome import NEARLY_STILL, STILL, Group, Outcome

if TYPE_CHECKING:
    from softcradle.physics import Trajectory

# Largest number of groups that are described individually. Of further groups, only the number is written.
MOST_GROUPS = 6
# Number of significant digits of a speed.
SPEED_DIGITS = 2

# Sentences about groups. The key contains the kind of body and the state of the group. {The} and {Those} are words for
# the bodies (`bodies.py`).
SENTENCES = {
    "bead right": N_("{The} {beads} moves right at {speed}."),
    "beads right": N_("{Those} {beads} move right together at {speed}."),
    "wall right": N_("Wall {beads} moves right at {speed}."),
    "bead left": N_("{The} {beads} moves left at {speed}."),
    "beads left": N_("{Those} {beads} move left together at {speed}."),
    "wall left": N_("Wall {beads} moves left at {speed}."),
    "bead nearly still": N_("{The} {beads} is almost at rest."),
    "beads nearly still": N_("{Those} {beads} are almost at rest."),
    "bead still": N_("{The} {beads} is at rest."),
    "beads still": N_("{Those} {beads} are at rest."),
    "two of": N_("{first} and {last}"),
    "row of": N_("{first} to {last}"),
    "stopped": N_("Then friction stopped them."),
}


def more_groups(count: int, **values: object) -> str:
    """Return a sentence with the number of groups that are not described individually."""
    return ngettext("And {n} more group.", "And {n} more groups.", count, **values)


def outcome_words(outcome: Outcome, body: str = "bead") -> str:
    """Return one sentence for each group of the outcome. `body` is the word for the bodies, a key of BODIES."""
    said = [_group_words(group, body) for group in outcome.groups[:MOST_GROUPS]]
    rest = len(outcome.groups) - MOST_GROUPS
    if rest > 0:
        said.append(more_groups(rest))
    return " ".join(said)


def _group_words(group: Group, body: str) -> str:
    """Return the sentence that describes a group."""
    kind = "wall" if group.wall else "bead" if group.count == 1 else "beads"
    way = group.state if group.state in (STILL, NEARLY_STILL) else "right" if group.velocity > 0.0 else "left"
    between = "two of" if group.count == 2 else "row of"
    beads = str(group.first) if group.count == 1 else _(SENTENCES[between], first=group.first, last=group.last)
    speed = speed_text(abs(group.velocity))
    return _(SENTENCES[f"{kind} {way}"], beads=beads, speed=speed, **_named(body))


def _named(body: str) -> dict[str, str]:
    """Return the words for a kind of body that are inserted into sentences."""
    words = BODIES[body].words()
    return {"the": words["the"], "The": capital(words["the"]), "Those": capital(words["those"])}


def ending_words(story: LaneStory) -> str:
    """Return one sentence for each group of beads. Add a sentence if friction has stopped groups that moved."""
    said = [outcome_words(story.outcome, story.body)]
    if story.stopped and any(group.moves for group in story.outcome.groups):
        said.append(_(SENTENCES["stopped"]))
    return " ".join(said)


def story_words(story: LaneStory) -> str:
    """Return the sentences about the first hit, about the contacts and about the outcome."""
    found = (_hit_words(story.hit, story.body), _contact_words(story), ending_words(story))
    return " ".join(sentence for sentence in found if sentence)


def _hit_words(hit: Hit | None, body: str) -> str:
    """Return the sentence about the first hit. Return an empty text if `hit` is None."""
    if hit is None:
        return ""
    when, how_fast, pair = time_text(hit.time), speed_text(hit.speed), (hit.contact, hit.contact + 1)
    if not any(hit.walls):
        return _(
            "{The} {left} hit {the} {right} at {time} with {speed}.",
            left=pair[0],
            right=pair[1],
            time=when,
            speed=how_fast,
            **_named(body),
        )
    wall, bead = pair if hit.walls[0] else pair[::-1]
    return _(
        "{The} {bead} and wall {wall} hit each other at {time} with {speed}.",
        bead=bead,
        wall=wall,
        time=when,
        speed=how_fast,
        **_named(body),
    )


def _contact_words(story: LaneStory) -> str:
    """Return the sentence about the contacts at the end of the description."""
    if story.closed:
        return ngettext(
            "At {time} {n} of {all} contacts is closed.",
            "At {time} {n} of {all} contacts are closed.",
            story.closed,
            time=time_text(story.time),
            all=story.contacts,
        )
    if story.opened is None:
        return _("No contact closes until {time}.", time=time_text(story.time))
    return _("The last contact opened at {time}.", time=time_text(story.opened))


def describe(label: str, trajectory: Trajectory) -> str:
    """Return a few sentences about a complete motion. If the numbers of the motion became infinite or NaN, return a
    single sentence.
    """
    motion = trajectory.velocity, trajectory.final_velocity, trajectory.overlap, trajectory.force
    if all((np.abs(numbers) <= LARGEST).all() for numbers in motion):
        said = story_words(story_of(trajectory))
        if trajectory.status.gave_up:
            said += " " + _("The method gave up there, so this is not the end.")
    else:
        said = _("The motion by {method} did not stay finite: choose a smaller step.", method=trajectory.method)
    return f"{label}: {said}" if label else said


def time_text(time: float) -> str:
    """Return a time [s] with its unit."""
    return f"{plain(time)}\u00a0s"


def speed_text(speed: float) -> str:
    """Return a speed [m/s] with its unit."""
    return f"{plain(speed, SPEED_DIGITS)}\u00a0m/s"
