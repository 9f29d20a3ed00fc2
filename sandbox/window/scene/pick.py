"""A pick: a bead or a contact of a lane, as it is found under the pointer or selected, and what it is called."""

from __future__ import annotations

from dataclasses import dataclass

from softcradle.sandbox.draw.number_format import subscript
from softcradle.sandbox.languages import _, label_words
from softcradle.sandbox.session.session import Session


@dataclass(frozen=True)
class Pick:
    """Number of the lane, "bead" or "contact", and its index."""

    lane: int
    kind: str
    index: int


def pick_title(session: Session, pick: Pick) -> str:
    """Bead or contact with its number, and with the name of its lane where there are two."""
    if pick.kind == "bead":
        title = _("Bead {number}", number=pick.index)
    else:
        title = _("Contact {number}", number=subscript(pick.index, pick.index + 1))
    label = label_words(session.label(pick.lane))
    return f"{title} · {label}" if len(session.lanes) > 1 and label else title
