"""Words for the bodies of a chain: bead, wagon or cylinder. Each word exists without article, with article, and as the
object of "drag".
"""

from typing import NamedTuple

from softcradle.physics import Chain, Contact, Coupler
from softcradle.physics.chain import Joint
from softcradle.sandbox.languages import N_, NP_, gettext, pgettext

THE, DRAG = "with article", "drag"


class Body(NamedTuple):
    """Words for one kind of body, marked for translation.

    Attributes:
        one, many: the word for one body, and the word for several bodies.
        the, those: the same words in front of numbers. In French they include the article. Marked in the context THE.
        a: the word for one body after "drag". Marked in the context DRAG.
    """

    one: str
    many: str
    the: str
    those: str
    a: str

    def words(self) -> dict[str, str]:
        """Return the words in the current language, by attribute name."""
        found = {name: gettext(getattr(self, name)) for name in ("one", "many")}
        found |= {name: pgettext(THE, getattr(self, name)) for name in ("the", "those")}
        return found | {"a": pgettext(DRAG, self.a)}


# Smallest mass [kg] of a wagon. If a chain contains such a mass, all its masses are written in tonnes.
HEAVY = 1e4


def is_gear(joint: Joint) -> bool:
    """Return True if the contact is drawn as a piston.

    A preloaded spring is drawn as a piston. A coupler is drawn as a piston if its pushing side is a preloaded spring.
    """
    contact = joint.push if isinstance(joint, Coupler) else joint
    return isinstance(contact, Contact) and contact.preload > 0.0 and contact.stiffness > 0.0


def body_word(chain: Chain) -> str:
    """Return the word for the bodies of a chain, which is a key of BODIES. Pages use the same rule.

    The word is "wagon" if all bodies are as heavy as wagons. The word is "cylinder" if all contacts are draft gears.
    Otherwise the word is "bead".
    """
    if min(chain.mass) >= HEAVY:
        return "wagon"
    return "cylinder" if all(map(is_gear, chain.contact)) else "bead"


def capital(text: str) -> str:
    """Return `text` with a capital first letter."""
    return text[:1].upper() + text[1:]


BODIES = {
    "bead": Body(
        N_("bead"),
        N_("beads"),
        NP_("with article", "bead"),
        NP_("with article", "beads"),
        NP_("drag", "a bead"),
    ),
    "wagon": Body(
        N_("wagon"),
        N_("wagons"),
        NP_("with article", "wagon"),
        NP_("with article", "wagons"),
        NP_("drag", "a wagon"),
    ),
    "cylinder": Body(
        N_("cylinder"),
        N_("cylinders"),
        NP_("with article", "cylinder"),
        NP_("with article", "cylinders"),
        NP_("drag", "a cylinder"),
    ),
}
