"""Table of the quantities of a motion. The table contains the name, unit, symbol, owner and values of each quantity.
Plots, pictures, tables and notebooks use this table.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from softcradle.sandbox.languages import N_, NP_
from softcradle.sandbox.motion import Array, Motion

BEAD, CONTACT, CHAIN = "bead", "contact", "chain"


class Quantity(NamedTuple):
    """Quantity of a motion. A quantity belongs to every bead, to every contact, or to the chain.

    Attributes:
        title: name and unit, as on an axis; marked for translation.
        column: short name and unit, as above a narrow column; marked for translation in the context "column".
        symbol: symbol of the quantity, to which an index can be added.
        owner: 'bead', 'contact' or 'chain'.
        values: function that returns the (T, k) values of a motion. The arguments of the function are the motion and
            the length of a bead [m].
    """

    title: str
    column: str
    symbol: str
    owner: str
    values: Callable[[Motion, float], Array]

    @property
    def name(self) -> str:
        """The title of the quantity without the unit."""
        return self.title.rpartition(" (")[0]

    @property
    def unit(self) -> str:
        """The unit that the title contains."""
        return self.title.rpartition(" (")[2].removesuffix(")")

    @property
    def label(self) -> str:
        """Name and unit of the quantity in the style of the paper's figures."""
        return f"{self.name} [{self.unit}]"


TIME = Quantity(N_("time (s)"), "time (s)", "t", CHAIN, lambda motion, _: motion.time[:, None])
MASS = Quantity("mass (kg)", NP_("column", "mass (kg)"), "m", BEAD, lambda motion, _: np.array(motion.chain.mass)[None])
POSITION = Quantity(
    N_("position (m)"), NP_("column", "position (m)"), "x", BEAD, lambda motion, length: motion.middles(length)
)
VELOCITY = Quantity(N_("velocity (m/s)"), NP_("column", "velocity (m/s)"), "v", BEAD, lambda motion, _: motion.velocity)
MOMENTUM = Quantity(N_("momentum (N s)"), NP_("column", "momentum (N s)"), "p", BEAD, lambda motion, _: motion.momentum)
KINETIC = Quantity(
    N_("kinetic energy (J)"), NP_("column", "kinetic energy (J)"), "E", BEAD, lambda motion, _: motion.kinetic
)
OVERLAP = Quantity(N_("overlap (m)"), NP_("column", "overlap (m)"), "δ", CONTACT, lambda motion, _: motion.overlap)
RATE = Quantity(
    N_("rate of the overlap (m/s)"), NP_("column", "rate (m/s)"), "dδ/dt", CONTACT, lambda motion, _: motion.rate
)
FORCE = Quantity(N_("contact force (N)"), NP_("column", "force (N)"), "f", CONTACT, lambda motion, _: motion.force)
STORED = Quantity(
    N_("stored energy (J)"), NP_("column", "stored energy (J)"), "S", CHAIN, lambda motion, _: motion.stored[:, None]
)

# Quantities by the letter that a user types to choose them.
QUANTITIES: dict[str, Quantity] = {
    "t": TIME,
    "x": POSITION,
    "v": VELOCITY,
    "p": MOMENTUM,
    "e": KINETIC,
    "d": OVERLAP,
    "r": RATE,
    "f": FORCE,
    "s": STORED,
}
