"""Explanation of a collision at the moment of the largest push. The explanation contains the overlap of each contact
and its share of the largest force.

Pages write the same sentence by the same rule. The rule has three steps:

1. :func:`push_of` chooses the contacts. If the strongest contact is in the right half of the chain, the contacts are
   listed from right to left. A chain with up to MOST contacts is listed completely. A longer chain is listed from its
   strongest contact on: the strongest contact, the contacts that follow it, and the last contact, MOST in total.
2. :func:`push_of` compares the share of each contact in the largest force with its share in a solid block. In a solid
   block, the share is the mass beyond the contact divided by the mass beyond the strongest contact. The result is
   AT_ONCE if no share differs by more than the factor SOLID. The result is WAVE if the contact at the end carries less
       than the
   fraction NOTHING of its share. Otherwise the result is PARTLY.
3. :func:`why_words` writes the lengths with :func:`length_text`, the shares with :func:`share_texts`, and a conclusion.

Tests: tests/sandbox/story/test_why.py
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from softcradle.sandbox.languages import N_, NP_, _, pgettext
from softcradle.sandbox.story.numbers import plain, scientific

# Largest number of contacts that the sentence lists.
MOST = 5
# Largest factor between the force of a contact and its force in a solid block at which the chain still moves like a
# solid block.
SOLID = 1.5
# Smallest force of a contact that the push has reached, as a fraction of its force in a solid block. The force bar of a
# smaller force is invisible.
NOTHING = 0.02
# Largest overlap at the end of the chain in an evanescent mode, relative to the overlap of the strongest contact.
DECAYED = 0.01
# Largest denominator of a fraction with an arbitrary numerator, and largest denominator of a fraction with the
# numerator 1.
DENOMINATOR, UNIT_DENOMINATOR = 5, 12
# Largest relative difference between a share and the fraction that represents it.
ROUNDED = 0.05
# Smallest share of a force that is not written as 0.
LEAST_SHARE = 0.005
# Units of lengths, from the largest to the smallest. The first number is the smallest length [m] for which a unit is
# used.
LENGTHS = ((1.0, 1.0, "m"), (1e-2, 1e-2, "cm"), (1e-4, 1e-3, "mm"), (1e-7, 1e-6, "µm"), (1e-10, 1e-9, "nm"))

ALONE, AT_ONCE, PARTLY, WAVE, UNKNOWN = "alone", "at once", "partly", "wave", "unknown"

SQUEEZED = {
    ALONE: N_("The contact is squeezed by {lengths}."),
    AT_ONCE: N_("Squeezed by {lengths}, the contacts still push with {shares} of the force."),
    PARTLY: N_("Squeezed by {lengths}, the contacts push with {shares} of the force."),
    WAVE: N_("Squeezed by {lengths}, the contacts push with {shares} of the force."),
    UNKNOWN: N_("Squeezed by {lengths}, the contacts push with {shares} of the force."),
}
CONCLUSIONS = {
    AT_ONCE: N_("So the push reaches {last} at once, without a wave."),
    "evanescent": N_("So the push reaches {last} at once, without a wave: an evanescent mode."),
    PARTLY: N_("So only a part of the push reaches {last} at once. The rest runs along the row as a wave."),
    WAVE: N_("So the push has not reached {last} yet: it runs along the row as a wave."),
}
LISTED = N_("{some} and {one}")
LAST = {
    "bead": NP_("object", "the last bead"),
    "wagon": NP_("object", "the last wagon"),
    "cylinder": NP_("object", "the last cylinder"),
}


@dataclass(frozen=True)
class Push:
    """State of a chain at the moment of its largest push.

    Attributes:
        contacts: the listed contacts, in the order of the sentence.
        overlaps: overlaps of the listed contacts [m]; 0 for an open contact.
        shares: forces of the listed contacts, relative to the largest force.
        way: AT_ONCE, PARTLY or WAVE; ALONE for a single contact, UNKNOWN if other forces act as well.
        evanescent: True if the push reaches the end at once although the overlaps decay steeply along the chain.
        gap: True if contacts between the last two listed contacts are omitted.
    """

    contacts: tuple[int, ...]
    overlaps: tuple[float, ...]
    shares: tuple[float, ...]
    way: str
    evanescent: bool
    gap: bool


def push_of(mass: Sequence[float], overlap: Sequence[float], force: Sequence[float], alone: bool = True) -> Push | None:
    """Return the state of a chain at the moment of its largest force. Return None if the strongest contact pulls or no
    contact carries a force.

    Arguments:
        mass: (n+1,) masses [kg]; infinite for walls.
        overlap: (n,) overlaps [m]; negative for open contacts.
        force: (n,) contact forces [N].
        alone: True if no drive and no brakes act, and no contact pushed before the collision.
    """
    count = len(force)
    strongest = max(range(count), key=lambda i: abs(force[i]))
    if not force[strongest] > 0.0:
        return None
    order = range(count - 1, -1, -1) if strongest > (count - 1) / 2 else range(count)
    begin = order.index(strongest) if count > MOST else 0
    listed = list(order)[begin:]
    gap = len(listed) > MOST
    if gap:
        listed = [*listed[: MOST - 1], listed[-1]]
    shares = [force[i] / force[strongest] for i in range(count)]
    way = ALONE if count == 1 else _way(mass, shares, strongest, order[-1]) if alone else UNKNOWN
    decayed = 0.0 < overlap[order[-1]] <= DECAYED * overlap[strongest]
    return Push(
        contacts=tuple(listed),
        overlaps=tuple(max(0.0, overlap[i]) for i in listed),
        shares=tuple(shares[i] for i in listed),
        way=way,
        evanescent=way == AT_ONCE and decayed,
        gap=gap,
    )


def _way(mass: Sequence[float], shares: Sequence[float], strongest: int, end: int) -> str:
    """Return AT_ONCE, PARTLY or WAVE. `shares` contains the shares of all contacts. `end` is the last contact in the
    direction of the push.
    """
    if not all(map(math.isfinite, mass)):
        return UNKNOWN
    solid = [_solid_share(mass, i, strongest) for i in range(len(shares))]
    if all(expected / SOLID <= share <= expected * SOLID for share, expected in zip(shares, solid, strict=True)):
        return AT_ONCE
    return WAVE if shares[end] < NOTHING * solid[end] else PARTLY


def _solid_share(mass: Sequence[float], contact: int, strongest: int) -> float:
    """Return the force of a contact relative to the strongest contact, if all beads moved as one solid block."""
    if contact >= strongest:
        return sum(mass[contact + 1 :]) / sum(mass[strongest + 1 :])
    return sum(mass[: contact + 1]) / sum(mass[: strongest + 1])


def why_words(push: Push, body: str) -> str:
    """Return one or two sentences that explain a collision. `body` is the word for the bodies, a key of LAST."""
    said = [
        _(SQUEEZED[push.way], lengths=_listed(list(map(length_text, push.overlaps)), push.gap), shares=_shares(push))
    ]
    key = "evanescent" if push.evanescent else push.way
    if key in CONCLUSIONS:
        said.append(_(CONCLUSIONS[key], last=pgettext("object", LAST[body])))
    return " ".join(said)


def _shares(push: Push) -> str:
    return _listed(share_texts(push.shares), push.gap)


def _listed(texts: list[str], gap: bool) -> str:
    """Return texts as a list such as "1, 3/4 and 1/2". If `gap` is True, write an ellipsis before the last text."""
    *some, last = [*texts[:-1], "…", texts[-1]] if gap else texts
    return _(LISTED, some=", ".join(some), one=last) if some else last


def length_text(length: float) -> str:
    """Return a length [m] in an everyday unit, such as 45 cm, 3 cm, 0.6 mm or 0.6 µm.

    Numbers of 10 and more, and numbers that begin with 1, have two significant digits. Other numbers have one digit.
    Lengths below 0.1 nm are written with a power of ten.
    """
    if length <= 0.0:
        return "0"
    size, unit = next(((size, unit) for least, size, unit in LENGTHS if length >= least), (0.0, ""))
    if not unit:
        return f"{scientific(length, 0)}\u00a0m"
    value = length / size
    digits = 2 if value >= 10.0 or f"{value:.1e}".startswith("1") else 1
    return f"{plain(value, digits)}\u00a0{unit}"


def share_texts(shares: Sequence[float]) -> list[str]:
    """Return shares of a force as fractions such as 3/4. If one share is not near a simple fraction, return all shares
    in percent.
    """
    fractions = [_fraction(share) for share in shares]
    if all(fractions):
        return fractions
    return [f"{plain(100.0 * share, 2) if share >= LEAST_SHARE else 0}\u00a0%" for share in shares]


def _fraction(share: float) -> str:
    """Return the fraction with the smallest denominator that is near `share`. If a near fraction does not exist, return
    an empty text.
    """
    if abs(share) < LEAST_SHARE:
        return "0"
    for denominator in range(1, UNIT_DENOMINATOR + 1):
        numerator = round(share * denominator)
        simple = denominator <= DENOMINATOR or numerator == 1
        if numerator > 0 and simple and abs(numerator / denominator - share) <= ROUNDED * share:
            return str(numerator) if denominator == 1 else f"{numerator}/{denominator}"
    return ""
