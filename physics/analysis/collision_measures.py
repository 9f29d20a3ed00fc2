"""The numbers of a collision and of each of its contacts, with title, unit and meaning as metadata of their fields."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


def _measure(title: str, unit: str, meaning: str, dissipative: bool = False) -> Any:
    """A field of a table of measures: its title, unit and meaning, and whether it is of use for dissipative chains alone."""
    return field(metadata={"title": title, "unit": unit, "meaning": meaning, "dissipative": dissipative})


@dataclass(frozen=True)
class ContactMeasures:
    """What one contact did; ``fields`` gives title, unit and meaning of every number as metadata.

    A mass that includes a wall is None, and so is the force per mass.
    """

    peak_force: float = _measure("peak force", "N", "greatest force")
    accelerated_mass: float | None = _measure(
        "mass accelerated", "kg", "of the beads beyond it, seen from the struck contact, Eq. (5)"
    )
    peak_acceleration: float | None = _measure(
        "force per mass",
        "m/s²",
        "peak force over the mass accelerated: the common A of Eq. (5), one number for all contacts of a rigid cluster",
    )
    momentum: float = _measure("momentum passed", "N s", 'integral of the force over time; "the flow rate of momentum"')
    open: float = _measure(
        "open", "s", "for how long apart, from the first touch of the struck contact to the end of the run"
    )
    touching: float = _measure(
        "touching", "s", "for how long at overlap 0 with a force between 0 and the preload, Eq. (C1)"
    )
    loaded: float = _measure("loaded", "s", "for how long at overlaps > 0")
    transmitted: float | None = _measure(
        "transmitted", "", "momentum passed over that of the beads before it at the start; the rest is reflected"
    )
    turns: int = _measure("turns", "", "turning points of the force while it acts: 1 where nothing rings")
    ringing_period: float | None = _measure(
        "ringing period", "s", "mean time between every other turning point, from four of them on"
    )
    ringing_amplitude: float | None = _measure(
        "ringing amplitude", "N", "largest distance of a turning point from the mean of its neighbours, halved"
    )
    ringing_decay: float | None = _measure(
        "ringing decay", "1/s", "rate at which the logarithm of that distance falls; negative where it grows"
    )


@dataclass(frozen=True)
class CollisionMeasures:
    """Measures of one collision; ``fields`` gives title, unit and meaning of every number as metadata.

    A number is None where it does not exist: over a mean of 0, without detachment, or for a side that is a wall alone.

    Attributes:
        struck: index of the contact where strikers meet targets.
        final_velocity: of every bead.
        contacts: one a contact, from left to right.
    """

    struck: int
    final_velocity: tuple[float, ...] = _measure("final velocities", "m/s", "of the beads, from left to right")
    rigidity_at_detachment: float | None = _measure(
        "rigidity at detachment",
        "",
        "velocity spread of the target cluster (largest less smallest) over its mean at detachment; 0 for a rigid body",
    )
    rigidity: float | None = _measure(
        "rigidity at the end",
        "",
        'the same when all is over: "the finite overlaps ... cause the velocity divergence among the cluster particles"',
    )
    restitution: float | None = _measure(
        "restitution of the striker",
        "",
        "speed at which the centres of mass of strikers and targets part at detachment over that at which they met: 1 for "
        "two rigid bodies; in an elastic collision 1 less its square is the share of the energy of approach left inside",
    )
    energy_inside_at_detachment: float | None = _measure(
        "energy inside at detachment",
        "",
        "share of the energy at the start that is inside the target cluster: what its contacts store and the motion of "
        'its beads about their centre of mass; "only in the limit alpha -> +0 ... the target cluster does not accumulate '
        'the compressive energies during the collision"',
    )
    energy_inside: float | None = _measure("energy inside at the end", "", "the same when all is over")
    momentum_deficit: float | None = _measure(
        "deficit of momentum",
        "",
        '"the relative deficits in the momentum and energy upon collision": share of the momentum at the first touch of '
        "the struck contact that is missing at detachment",
        dissipative=True,
    )
    energy_deficit: float | None = _measure("deficit of energy", "", "the same of the kinetic energy", dissipative=True)
    absorbed_by_contacts: float | None = _measure(
        "absorbed by contacts",
        "",
        "share of the energy at the start that contacts with loss have taken",
        dissipative=True,
    )
    absorbed_by_bed: float | None = _measure(
        "absorbed by the bed", "", "the same by friction on the bed", dissipative=True
    )
    detachment: float | None = _measure("detachment", "s", "time of the last opening of the struck contact")
    contact_time: float | None = _measure(
        "contact time", "s", "for how long the struck contact was closed; the paper's tau_dur"
    )
    peak_force: float = _measure("peak force", "N", "greatest force of the struck contact")
    peak_acceleration: float | None = _measure(
        "peak force per mass", "m/s²", "the same over the mass that it accelerates, the target cluster"
    )
    momentum: float = _measure("momentum passed", "N s", "by the struck contact")
    speed_ratio: float | None = _measure(
        "speed over critical", "", "of draft gears, V/v_c: up to 1 both clusters stay exactly rigid"
    )
    speed_margin: float | None = _measure(
        "margin", "", "1 less that: how far below the critical speed, negative above it"
    )
    spread_variable: float | None = _measure(
        "spread variable",
        "",
        "of one bead on n alike, (n+1) exp(-1/(2 n alpha)): where it is equal, so is the rigidity at the end",
    )
    penetration_depth: float | None = _measure(
        "penetration depth",
        "",
        "contacts over which the overlap falls by a factor e inside the target cluster: n alpha at most",
    )
    contacts: tuple[ContactMeasures, ...] = ()
