"""Words for the bodies of a row: bead, wagon or cylinder, alone, with an article, and after "drag"."""

from typing import NamedTuple

from softcradle.physics import Chain, Contact, Coupler
from softcradle.physics.chain import Joint
from softcradle.sandbox.languages import N_, NP_, gettext, pgettext

THE, DRAG = "with article", "drag"


class Body(NamedTuple):
    """Words for one kind of body, marked for translation.

    Attributes:
        one, many: one body, and several bodies.
        the, those: the same before numbers; in French with the article. Marked in the context THE.
        a: one body after "drag". Marked in the context DRAG.
    """

    one: str
    many: str
    the: str
    those: str
    a: str

    def words(self) -> dict[str, str]:
        """Return the words in the current language by their names."""
        found = {name: gettext(getattr(self, name)) for name in ("one", "many")}
        found |= {name: pgettext(THE, getattr(self, name)) for name in ("the", "those")}
        return found | {"a": pgettext(DRAG, self.a)}


# Mass [kg] from which on bodies are wagons, and all masses of a chain are written in tonnes.
HEAVY = 1e4


def is_gear(joint: Joint) -> bool:
    """Return True if the contact is drawn as a piston, because it is a preloaded spring or a coupler that pushes with
    one.
    """
    contact = joint.push if isinstance(joint, Coupler) else joint
    return isinstance(contact, Contact) and contact.preload > 0.0 and contact.stiffness > 0.0


def body_word(chain: Chain) -> str:
    """Return the word for the bodies of a chain, a key of BODIES: wagon if all are as heavy as wagons, cylinder if all
    contacts are draft gears, otherwise bead. Pages have the same rule.
    """
    if min(chain.mass) >= HEAVY:
        return "wagon"
    return "cylinder" if all(map(is_gear, chain.contact)) else "bead"


def capital(text: str) -> str:
    """Return `text` with a capital at its beginning."""
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
