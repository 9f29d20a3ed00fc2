"""The label of a lane: that of the scene, as long as the lane is the scene's; after an edit what its contacts are now."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from softcradle.physics.chain import Chain, Joint
from softcradle.physics.contact import Contact
from softcradle.physics.coupler import Coupler
from softcradle.sandbox.session.contact_conversion import kind_of

EDITED = ", edited"  # after the label of a lane that was edited in all but its contacts
LARGEST_DENOMINATOR = 60  # of an exponent that is written as a fraction


def lane_label(label: str, before: Chain, now: Chain) -> str:
    """The label of a lane that was `label` with the chain `before`."""
    if set(now.contact) != set(before.contact):
        return contacts_text(now.contact)
    same = before.contacts == now.contacts and replace(before, gap=now.gap) == now
    return label if same or not label or label.endswith(EDITED) else label + EDITED


def contacts_text(contacts: tuple[Joint, ...]) -> str:
    """What contacts are, in some words: alpha = 1/50, draft gear, steps of contacts that differ."""
    laws = list(dict.fromkeys(contacts))
    if len(laws) == 1:
        return _law_text(laws[0])
    kinds = {kind_of(law) for law in laws}
    if len(laws) == 2 or kinds == {"power"}:
        return " and ".join(map(_law_text, laws[:2])) + (" ..." if len(laws) > 2 else "")
    return "mixed contacts"


def _law_text(law: Joint) -> str:
    if not isinstance(law, Contact):
        return "coupler" if isinstance(law, Coupler) else law.name
    if law.preload > 0.0:
        return "draft gear" if law.exponent == 1.0 else "preloaded contact"
    name = {1.0: "Hooke, ", 1.5: "Hertz, "}.get(law.exponent, "")
    return f"{name}alpha = {exponent_text(law.exponent)}"


def exponent_text(exponent: float) -> str:
    """The exponent as a fraction where it is a simple one, else to three digits."""
    fraction = Fraction(exponent).limit_denominator(LARGEST_DENOMINATOR)
    simple = fraction.numerator in (1, 3) and abs(float(fraction) - exponent) < 1e-9 * exponent
    return str(fraction) if simple else f"{exponent:.3g}"
