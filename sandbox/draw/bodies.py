"""What bodies look like, without drawing them: which contacts are gears, how tall bodies are, which masses are written."""

from __future__ import annotations

import math
from collections.abc import Iterable

from softcradle.physics import Chain, Contact, Coupler
from softcradle.physics.chain import Joint
from softcradle.sandbox.languages import _, localized

CYLINDER_LENGTH = 0.80  # of a draft gear's length; the rest is its piston
CYLINDER_HEIGHT = 0.66  # of a draft gear's length
HEAVY = 1e4  # [kg] masses from here on are written in tonnes
EQUAL_MASSES = 1.02  # ratio of masses up to which beads look alike and no masses are written


def is_gear(joint: Joint) -> bool:
    """Whether the contact is drawn as a piston: a preloaded spring, in a coupler or by itself."""
    contact = joint.push if isinstance(joint, Coupler) else joint
    return isinstance(contact, Contact) and contact.preload > 0.0 and contact.stiffness > 0.0


def solid_force(joint: Joint, force: float) -> float:
    """Size of the force [N] from which on the gear of a coupler that pushes, or pulls with `force` < 0, is solid; inf: never."""
    if not isinstance(joint, Coupler) or math.isinf(joint.travel):
        return math.inf
    gear = joint.push if force >= 0.0 else joint.pull
    return math.inf if gear is None else gear.force(joint.travel)


def body_height(chains: Iterable[Chain]) -> float:
    """Height of the tallest body in lengths of a bead; that of all lanes, so that they have one scale."""
    all_gears = all(is_gear(contact) for chain in chains for contact in chain.contact)
    return CYLINDER_HEIGHT if all_gears else 1.0


def mass_labels(chain: Chain) -> tuple[str, ...]:
    """A label for each bead where masses differ visibly, else none."""
    finite = [mass for mass in chain.mass if math.isfinite(mass)]
    if max(finite) <= EQUAL_MASSES * min(finite):
        return ()
    unit, size = ("t", 1e3) if max(finite) >= HEAVY else ("kg", 1.0)
    return tuple(localized(f"{mass / size:.3g} {unit}") if math.isfinite(mass) else _("wall") for mass in chain.mass)
