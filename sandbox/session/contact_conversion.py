"""Conversion between contact laws. A power law, a draft gear and a hard contact are converted into each other.

Power laws and draft gears stop an impact within the same depth. A hard contact stops it within a twentieth of the
depth.
"""

import math
from dataclasses import replace

from softcradle.physics.chain import Chain, Joint
from softcradle.physics.contact import Contact, hertz, power_law
from softcradle.physics.coupler import Coupler
from softcradle.physics.scales import scales_at
from softcradle.sandbox.languages import _ as gettext

KINDS = ("power", "gear", "hard")
# Exponent of a power law that was converted from another kind of contact. 1/10 is the first value used in the paper.
SOFT_EXPONENT = 0.1
PRELOAD_SHARE = 0.9  # Fraction of the impact energy that the preload of a converted draft gear absorbs.
# Depth of a hard contact relative to a soft contact. A locked piston is compressed twenty times less than a free one.
HARD_DEPTH = 0.05
# Largest depth of a converted contact, as a fraction of the length of a bead. Contacts in clusters of beads are
# compressed up to five times as deep.
DEEPEST = 0.2
# Depth of a steel ball that is compared with soft beads, as a fraction of the length of a bead. It equals the depth in
# the scene hertz-cradle. In that scene, balls of 1 kg and 1 m with the law hertz(100) meet at 1 m/s: 100 * depth**2.5 /
# 2.5 = 1/4 J.
STEEL_DEPTH = 0.00625**0.4
HALVINGS = 60  # Number of bisection steps that determine a depth to its last digit.


def kind_of(contact: Joint) -> str:
    """Return the kind of a contact: 'gear' with a preload, 'power' for an exponent below 1, 'hard' for larger
    exponents.

    Other contact laws have the kind 'coupler' or 'own'.
    """
    if not isinstance(contact, Contact):
        return "coupler" if isinstance(contact, Coupler) else "own"
    if contact.preload > 0.0:
        return "gear"
    return "power" if contact.exponent < 1.0 else "hard"


def has_soft_contacts(chain: Chain) -> bool:
    """Return True if some contact is softer than in a usual cradle. Soft contacts are preloaded, or have an exponent
    below 1.
    """
    return any(kind_of(contact) in ("power", "gear") for contact in chain.contact)


def plain_contact(chain: Chain, index: int) -> Contact:
    """Return contact `index`. Raise ValueError if it cannot be converted because it is a coupler or a user-defined law."""
    contact = chain.contact[index]
    if not isinstance(contact, Contact):
        raise ValueError(gettext("a coupler keeps its law: it is changed in the scene file"))
    return contact


def converted_contact(chain: Chain, index: int, kind: str, speed: float, length: float = math.inf) -> Contact:
    """Return contact `index` of `chain` converted to `kind`. Raise ValueError if `kind` is unknown.

    The new contact stops an impact at `speed` [m/s] within the same depth as the old contact. A hard contact is a Hertz
    contact and stops the impact within a twentieth of the depth. If the old contact is hard, the new depth is limited
    to a fifth of `length` [m], the length of a bead. With a larger depth, beads would pass through each other.
    """
    if kind not in KINDS:
        known = ", ".join(KINDS)
        raise ValueError(gettext("unknown kind of contact {kind!r}; there are {known}", kind=kind, known=known))
    contact = plain_contact(chain, index)
    present = kind_of(contact)
    if present == kind:
        return contact
    energy, depth = impact_energy(chain, index, speed)
    soft_depth = min(depth / HARD_DEPTH, max(depth, DEEPEST * length)) if present == "hard" else depth
    if kind == "power":
        return _power_law(energy, soft_depth, SOFT_EXPONENT, contact.loss)
    if kind == "gear":
        preload, stiffness = PRELOAD_SHARE * energy / soft_depth, 2.0 * (1.0 - PRELOAD_SHARE) * energy / soft_depth**2
        return Contact(preload, stiffness, 1.0, contact.loss)
    return _hertz(energy, HARD_DEPTH * soft_depth)


def at_the_same_depth(chain: Chain, index: int, alpha: float, speed: float) -> Contact:
    """Return a power law with exponent `alpha` in place of contact `index`.

    Both contacts stop an impact at `speed` [m/s] within the same depth.
    """
    return _power_law(*impact_energy(chain, index, speed), alpha, plain_contact(chain, index).loss)


def steel_ball(chain: Chain, index: int, speed: float, length: float) -> Contact:
    """Return a Hertz contact in place of contact `index`. It stops an impact at `speed` [m/s] within STEEL_DEPTH times
    `length`.

    `length` [m] is the length of a bead. The contact is much softer than real steel, because overlaps must be visible.
    Its forces must also fit on one axis with the forces of soft contacts.
    """
    return _hertz(impact_energy(chain, index, speed)[0], STEEL_DEPTH * length)


def hard_contact(chain: Chain, index: int, speed: float) -> Contact:
    """Return a Hertz contact that stops an impact at `speed` [m/s] within a twentieth of the depth of contact `index`."""
    energy, depth = impact_energy(chain, index, speed)
    return _hertz(energy, HARD_DEPTH * depth)


def _hertz(energy: float, depth: float) -> Contact:
    return hertz(2.5 * energy / depth**2.5)


def _power_law(energy: float, depth: float, alpha: float, loss: float) -> Contact:
    # Check the exponent first, because a power with an invalid exponent may be 0 or not finite.
    checked = power_law(1.0, alpha, loss)
    return replace(checked, stiffness=(1.0 + alpha) * energy / depth ** (1.0 + alpha))


def impact_energy(chain: Chain, index: int, speed: float) -> tuple[float, float]:
    """Return the energy [J] of an impact, and the depth [m] at which contact `index` has stored this energy.

    The impact is a collision of two free beads that approach each other at `speed` [m/s].
    """
    energy = 0.5 * speed**2 / float(chain.inverse_reduced_mass[index])
    low, high = 0.0, float(scales_at(chain, speed)[0][index])  # Upper limit of the depth.
    for _ in range(HALVINGS):
        depth = 0.5 * (low + high)
        low, high = (depth, high) if float(chain.contact[index].energy(depth)) < energy else (low, depth)
    return energy, high
