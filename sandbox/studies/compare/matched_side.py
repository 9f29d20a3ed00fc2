"""The nearest contact of the other family as one more side, and a sentence that says how near it is."""

from __future__ import annotations

import re
from dataclasses import asdict, replace
from typing import Any

from softcradle.physics.analysis.contact_distance import Distance
from softcradle.physics.analysis.matching import ALPHAS, NEAR, Match, match, only_contact
from softcradle.sandbox.studies.compare.sides import Comparison, Side, with_contact
from softcradle.sandbox.user_error import UserError
from softcradle.scenes.contact_table import Law, law_of
from softcradle.scenes.contact_text import contact_text

DIFFERENCES = {  # by distance: what differs, and by how much
    "force": "forces of the struck contact differ by {} in the root mean square",
    "outcome": "final velocities over the closing speed and the logarithm of the contact time differ by {} together",
}


def side_to_match(comparison: Comparison) -> Side:
    """The side whose contact is to be matched: the first; UserError where it cannot be matched."""
    side = comparison.sides[0]
    if len(side.scene.lanes) > 1 or len({other.scene.title for other in comparison.sides}) > 1:
        raise UserError("--match needs one scene with one lane")
    try:
        only_contact(side.lane.chain())
    except ValueError as error:
        raise UserError(f"{side.name}: {error}") from None
    return side


def add_match(comparison: Comparison, distance: Distance) -> tuple[Comparison, Match]:
    """The comparison with the nearest contact as its last side, and the match."""
    side = side_to_match(comparison)
    found = match(side.lane.chain(), side.lane.velocity, distance)
    law: Law = law_of(found.contact)
    given = replace(side, name=contact_text(found.given))
    nearest = with_contact(side, law)
    nearest = replace(nearest, name=f"nearest: {short_text(contact_text(found.contact))}")
    sides = (given, *comparison.sides[1:], nearest)
    return Comparison(f"{side.scene.title}, and its nearest {_family(found)}", sides), found


def short_text(text: str) -> str:
    """The text of a contact with three digits a number, as labels have it; JSON has them all.

    >>> short_text("draft_gear(0.668973, 0.985412)")
    'draft_gear(0.669, 0.985)'
    """
    return re.sub(r"\d+\.\d+(?:e[-+]?\d+)?", lambda number: f"{float(number[0]):.3g}", text)


def match_sentence(found: Match) -> str:
    """Which contact is nearest, by how much it differs, and whether that is near."""
    difference = DIFFERENCES[found.distance].format(f"{100.0 * found.residual:.2g} %")
    kind, contact, given = _family(found), contact_text(found.contact), contact_text(found.given)
    if found.near:
        text = f"The {kind} nearest to {given} in this collision is {contact}: {difference}."
    else:
        text = f"No {kind} comes near {given} in this collision: with the nearest, {contact}, {difference} (near: {NEAR:.0%})."
    if found.distance == "force":
        text += f" There {DIFFERENCES['outcome'].format(f'{100.0 * found.outcome:.2g} %')}."
    if found.speed_ratio is not None:
        text += f" {_speed_sentence(found.speed_ratio)}"
    if found.ends:
        ends = " and ".join(found.ends)
        text += f" Its {ends} lies at the end of the range searched{_range(found)}: a nearer one may lie beyond."
    return text


def _speed_sentence(ratio: float) -> str:
    """On which side of its critical speed the draft gear is struck, and by which margin."""
    side = "below: the clusters stay exactly rigid" if ratio <= 1.0 else "above"
    return f"The draft gear is struck at {ratio:.3g} times its critical speed, {abs(ratio - 1.0):.0%} {side}."


def match_as_json(found: Match) -> dict[str, Any]:
    """The match as plain numbers and texts."""
    return asdict(found) | {
        "ends": list(found.ends),
        "sentence": match_sentence(found),
        "given": contact_text(found.given),
        "contact": contact_text(found.contact),
        "numbers": asdict(found.contact),
    }


def _family(found: Match) -> str:
    return "power law" if found.contact.preload == 0.0 else "draft gear"


def _range(found: Match) -> str:
    return f" ({ALPHAS[0]:g} to {ALPHAS[1]:g})" if "alpha" in found.ends else ""
