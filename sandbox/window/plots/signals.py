"""The signals of a session: every number that a bead, a contact or the chain has, to be plotted against any other."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from softcradle.sandbox.draw.number_format import subscript
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.quantities import BEAD, CHAIN, CONTACT, QUANTITIES, Quantity

KEY = N_(
    "t time; x v p e and a bead: place, velocity, momentum, energy; d r f and a contact: overlap, rate, force; s stored"
)


BEADS_NUMBERED = N_("{text!r}: the beads of this lane are numbered 0 to {last}")
CONTACTS_NUMBERED = N_("{text!r}: the contacts of this lane are numbered 0 to {last}")


@dataclass(frozen=True)
class Signal:
    """One number over time: a letter of QUANTITIES, and the bead or the contact, counted from the left."""

    letter: str
    index: int = 0

    @property
    def quantity(self) -> Quantity:
        """What it is."""
        return QUANTITIES[self.letter]

    @property
    def label(self) -> str:
        """Symbol and unit."""
        owner = self.quantity.owner
        index = {BEAD: subscript(self.index), CONTACT: subscript(self.index, self.index + 1), CHAIN: ""}[owner]
        return f"{self.quantity.symbol}{index} ({self.quantity.unit})"

    def values(self, motion: Motion, length: float) -> Array:
        """(T,) its values in a motion of beads `length` long [m]; nan where the motion has no such bead or contact."""
        columns = self.quantity.values(motion, length)
        if self.index >= columns.shape[1]:
            return np.full(len(motion.time), np.nan)
        column: Array = columns[:, self.index]
        return column

    def __str__(self) -> str:
        return self.letter if self.quantity.owner == CHAIN else f"{self.letter}{self.index}"


def signal_of(text: str, beads: int) -> Signal:
    """The signal that is written as v0, f1 or t, of a lane with so many beads. ValueError in a sentence else."""
    found = re.fullmatch(r"([a-z])_?(\d*)(?:-\d+)?", text.strip().lower())
    if found is None or found[1] not in QUANTITIES:
        known = ", ".join(QUANTITIES)
        wrong = _("{text!r} is no signal; there are {known}, with a number: v0, f1", text=text.strip(), known=known)
        raise ValueError(wrong)
    letter, digits = found[1], found[2]
    owner = QUANTITIES[letter].owner
    if owner == CHAIN:
        return Signal(letter)
    count = beads if owner == BEAD else beads - 1
    if not digits or int(digits) >= count:
        numbered = BEADS_NUMBERED if owner == BEAD else CONTACTS_NUMBERED
        raise ValueError(_(numbered, text=text.strip(), last=count - 1))
    return Signal(letter, int(digits))


def pair_of(text: str, beads: int) -> tuple[Signal, Signal]:
    """The signals of "f0 against d0": the vertical one, and the horizontal one. ValueError in a sentence else."""
    between = _("{vertical} against {horizontal}", vertical="", horizontal="").strip()
    parts = re.split(rf"\s+(?:against|{re.escape(between)})\s+|\s*,\s*|\s+", text.strip())
    if len(parts) != 2:
        raise ValueError(_("{text!r}: write two signals, as f0 against d0", text=text))
    return signal_of(parts[0], beads), signal_of(parts[1], beads)
