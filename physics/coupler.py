"""Coupler of a train: a contact that pushes, has slack (backlash), pulls, and has a solid stop.

    overlap d >= 0                  pushes by the gear `push`
    -slack < d < 0                  no force: the two beads are free
    d <= -slack                     pulls by the gear `pull`, whose displacement is -d - slack
    displacement of a gear > travel solid: a stop adds the force stop * (displacement - travel)

The force graph has several segments. A gear dissipates energy in the same way as its contact law. A coupler may be
uncoupled at the start. An uncoupled coupler only pushes. When its two beads meet, it couples, and can pull from this
time on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from softcradle.physics.checked_input import magnitude, require_kind, shown
from softcradle.physics.contact import Contact
from softcradle.physics.messages import N_, InputError
from softcradle.physics.segments import PiecewiseContact, Segment


@dataclass(frozen=True)
class Coupler(PiecewiseContact):
    """A coupler between two beads. A coupler pushes and, beyond its slack, pulls. The gears of a coupler become solid
    at full travel.

    All methods except pymunk support couplers (yoshida4 only without loss). The adaptive methods and "auto" require an
    exponent of at least 1 for a gear that pulls or has a stop; otherwise they raise a ValueError. Pulling forces are
    negative in results.

    Parameters
    ----------
    push : Contact
        Contact law of the pushing gear.
    pull : Contact, optional
        Contact law of the pulling gear. None means that the coupler does not pull.
    slack : float, optional
        Free play [m] between pushing and pulling. A slack requires `pull`.
    travel : float, optional
        Displacement [m] at which a gear becomes solid, both for pushing and for pulling. The default is infinite.
    stop : float, optional
        Stiffness [N/m] of the stop beyond the travel. The force of the stop adds to the force of the gear and does
        not dissipate energy.
    coupled : bool, optional
        True if the coupler is coupled at the start. If False, it cannot pull until its beads have met. None means
        that it is coupled unless the gap at the start is larger than the slack. Beads that touch at the start are
        always coupled.

    Raises
    ------
    ValueError
        A number is out of range, slack or `coupled` is given without a pull, or only one of travel and stop is given.

    Examples
    --------
    >>> from softcradle import Coupler, hooke
    >>> link = Coupler(hooke(10.0), pull=hooke(20.0), slack=0.5, travel=1.0, stop=1000.0)
    >>> link.force([1.0, 1.01, -0.25, -0.75])
    array([10. , 20.1,  0. , -5. ])
    """

    push: Contact
    pull: Contact | None = None
    slack: float = 0.0
    travel: float = math.inf
    stop: float = 0.0
    coupled: bool | None = None

    def __post_init__(self) -> None:
        require_kind(N_("coupler push"), self.push, Contact)
        if self.pull is not None:
            require_kind(N_("coupler pull"), self.pull, Contact)
        for name, what in (("slack", N_("coupler slack")), ("stop", N_("coupler stop"))):
            object.__setattr__(self, name, magnitude(what, getattr(self, name), zero=True))
        if self.travel != math.inf:
            object.__setattr__(self, "travel", magnitude(N_("coupler travel"), self.travel))
        # These options require each other.
        if self.coupled not in (None, True, False):
            raise InputError(
                "coupled", "coupler coupled must be True, False or None, not {given}", given=shown(self.coupled)
            )
        if self.coupled is not None and self.pull is None:
            raise InputError(
                "coupled_pull", "a coupler with the option coupled needs a pull: without one it only pushes"
            )
        if self.slack and self.pull is None:
            raise InputError(
                "slack_pull",
                "a coupler with slack {slack:g} m needs a pull beyond it; a gap is one of the chain",
                slack=self.slack,
            )
        if (self.travel == math.inf) != (self.stop == 0.0):
            raise InputError(
                "travel_stop",
                "a coupler needs both travel and stop, or neither, not travel {travel:g} m and stop {stop:g} N/m",
                travel=self.travel,
                stop=self.stop,
            )

    @property
    def segments(self) -> list[Segment]:
        """Segments of the force graph from left to right.

        The pulling segments come first, from the solid stop inwards. The pushing segments follow, from overlap 0
        outwards.
        """
        pulls = self._gear(self.pull, -1.0, -self.slack)[::-1] if self.pull else []
        return pulls + self._gear(self.push, 1.0, 0.0)

    def _gear(self, law: Contact, side: float, origin: float) -> list[Segment]:
        """Return the segments of a gear, from its origin outwards.

        There is one segment up to full travel, and one beyond it that includes the stop.
        """
        found = [gear_segment(law, side, origin, length=self.travel)]
        if self.stop:
            found.append(gear_segment(law, side, origin + side * self.travel, self.travel, self.stop))
        return found


def gear_segment(
    law: Contact, side: float, origin: float, before: float = 0.0, stop: float = 0.0, length: float = math.inf
) -> Segment:
    """Return the segment on which a gear with this `law` continues from the displacement `before` [m].

    A spring of stiffness `stop` [N/m] is added on this segment.
    """
    return Segment(side, origin, law.preload, law.stiffness, law.exponent, law.loss, length, before, stop)
