"""Kinds of contact: a power law, a draft gear or a hard one that push about alike at the speed a scene is about."""

from __future__ import annotations

import numpy as np

from physics.chain import Chain
from physics.contact import Contact, draft_gear, hertz, power_law
from physics.time_scale import contact_scales

KINDS = ("power", "gear", "hard")
SOFT_EXPONENT = 0.1  # of a power law made from something else: alpha = 1/10, the paper's first
PRELOAD_SHARE = 0.9  # of the largest force that a gear made from something else carries without yielding
HARD_DEPTH = 0.05  # of the depth of the soft contact: a locked piston yields twenty times less


def kind_of(contact: Contact) -> str:
    """'gear' where a preload has to be overcome, 'power' for an exponent below 1, else 'hard'."""
    if contact.preload > 0.0:
        return "gear"
    return "power" if contact.exponent < 1.0 else "hard"


def turned(chain: Chain, index: int, kind: str, speed: float) -> Contact:
    """Contact `index` of `chain` as `kind`; depth and force of an impact at `speed` [m/s] stay what they are.

    A hard one is Hertz's, and stops the same impact within a twentieth of the depth. ValueError for an unknown kind.
    """
    if kind not in KINDS:
        raise ValueError(f"unknown kind of contact {kind!r}; there are {', '.join(KINDS)}")
    contact = chain.contact[index]
    if kind_of(contact) == kind:
        return contact
    depth = float(contact_scales(chain, np.array([0.0, speed]))[0][index])
    force = float(contact.force(depth))
    if kind == "power":
        return power_law(force / depth**SOFT_EXPONENT, SOFT_EXPONENT)
    if kind == "gear":
        stiffness = (1.0 - PRELOAD_SHARE) * force / depth
        return draft_gear(stiffness, PRELOAD_SHARE * force / stiffness)
    return hardened(chain, index, speed)


def hardened(chain: Chain, index: int, speed: float) -> Contact:
    """Hertz's contact in place of contact `index`: it holds the energy of an impact within a twentieth of the depth."""
    depth = float(contact_scales(chain, np.array([0.0, speed]))[0][index])
    energy = float(chain.contact[index].energy(depth))
    return hertz(2.5 * energy / (HARD_DEPTH * depth) ** 2.5)
