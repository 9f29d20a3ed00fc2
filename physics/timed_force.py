"""Time-dependent forces on chosen beads, such as the traction and the brakes of a train. The forces are piecewise
linear.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.checked_input import LARGEST, number_array, require_kind, shown, whole_number
from softcradle.physics.messages import N_, InputError, Message

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TimedForce:
    """A time-dependent force on chosen beads.

    The force is linear between breakpoints in time. The force is 0 before the first breakpoint and constant after the
    last. Two breakpoints at the same time make a step. In ``Chain(forces=...)`` a positive force pushes to the right.
    In ``Chain(brakes=...)`` the force is the largest friction force of a brake. A brake acts against the motion, and it
    holds a bead at rest.

    Parameters
    ----------
    beads : int or sequence of int
        Index of one bead, or indices of several beads. The full force acts on each of them.
    time : array_like, shape (K,)
        Times [s] >= 0, ascending, K >= 1.
    force : float or array_like, shape (K,)
        Force [N] at these times. One number means a constant force from the first time on.

    Raises
    ------
    ValueError
        A bead is not an index, the times do not ascend, or a number is out of range.

    Examples
    --------
    >>> TimedForce(0, [0.0, 2.0, 2.0], [0.0, 4.0, 1.0]).at([1.0, 5.0])
    array([2., 1.])
    """

    beads: tuple[int, ...]
    time: tuple[float, ...]
    force: tuple[float, ...]

    def __init__(self, beads: int | Sequence[int], time: ArrayLike, force: ArrayLike) -> None:
        object.__setattr__(self, "beads", _checked_beads(beads))
        times, forces = np.atleast_1d(number_array("time", time)), number_array("force", force)
        if times.ndim != 1 or not times.size or not (times >= 0.0).all() or not (times <= LARGEST).all():
            raise InputError(
                "force_times",
                "force times must be a list of numbers from 0 to {most:g}, not {given}",
                most=LARGEST,
                given=shown(time),
            )
        if (np.diff(times) < 0.0).any():
            raise InputError("ascending_times", "force times must ascend, not {given}", given=shown(time))
        # One force for all times, or one force for each time.
        if forces.shape not in ((), times.shape):
            raise InputError(
                "timed_force_count",
                "{count} times of a force need {count} forces, not {given}",
                count=times.size,
                given=shown(force),
            )
        if not (np.abs(forces) <= LARGEST).all():
            raise InputError(
                "timed_force",
                "every force over time must be a number up to {most:g}, not {given}",
                most=LARGEST,
                given=shown(force),
            )
        object.__setattr__(self, "time", tuple(times.tolist()))
        object.__setattr__(self, "force", tuple(np.broadcast_to(forces, times.shape).tolist()))

    @property
    def steady(self) -> bool:
        """True if the force is the same from t = 0 on."""
        return self.time[0] == 0.0 and len(set(self.force)) == 1

    @property
    def lasts(self) -> bool:
        """True if the force is not 0 after its last breakpoint."""
        return self.force[-1] != 0.0

    def at(self, time: ArrayLike) -> Array:
        """Return the force [N] at `time` [s], any shape. At a step it is the value after the step."""
        return np.asarray(np.interp(np.asarray(time), *self._points[:2], left=0.0))

    @cached_property
    def _points(self) -> tuple[Array, Array, Array]:
        """Times (K,) [s], forces (K,) [N], and impulses (K,) [N s] up to each time."""
        time, force = np.array(self.time), np.array(self.force)
        return time, force, np.append(0.0, np.cumsum(0.5 * np.diff(time) * (force[1:] + force[:-1])))

    def impulse(self, end: ArrayLike) -> Array:
        """Return the momentum [N s] that the force has transferred to each of its beads by the time `end` [s], any
        shape.
        """
        ends, (time, force, given) = np.asarray(end, dtype=np.float64), self._points
        # Impulse up to the last breakpoint before `end`, plus the area of the trapezium after it.
        last = np.maximum(np.searchsorted(time, ends, side="right") - 1, 0)
        found: Array = given[last] + 0.5 * (ends - time[last]) * (force[last] + self.at(ends))
        return np.where(ends < time[0], 0.0, found)


def _checked_beads(beads: int | Sequence[int]) -> tuple[int, ...]:
    given = [beads] if np.ndim(beads) == 0 else list(beads)  # type: ignore[arg-type]  # a sequence by its dimension
    indices = tuple(whole_number(N_("every bead of a force"), bead) for bead in given)
    if not indices or min(indices) < 0 or len(set(indices)) < len(indices):
        raise InputError(
            "force_beads",
            "beads of a force must be one or more indices from 0 on, each once, not {given}",
            given=shown(beads),
        )
    return indices


def checked_forces(what: str, forces: object, mass: Sequence[float], brakes: bool = False) -> tuple[TimedForce, ...]:
    """Return `forces` as a tuple of TimedForce. Brakes must never be negative.

    Raise ValueError if an entry is not a TimedForce, or if it acts on a wall or on a bead that does not exist. `mass`
    [kg] contains the masses of all beads.
    """
    beads = len(mass)
    given = (forces,) if isinstance(forces, TimedForce) else forces
    if isinstance(given, str) or not isinstance(given, Sequence):
        raise InputError(
            "timed_forces", "{what} must be a TimedForce or a list of them, not {given}", what=what, given=shown(forces)
        )
    for item in given:
        require_kind(Message("entry", "every entry of {key}", key=what), item, TimedForce)
        if max(item.beads) >= beads:
            raise InputError(
                "force_on_no_bead",
                "{what} act on bead {bead}, but there are only beads 0 to {last}",
                what=what,
                bead=max(item.beads),
                last=beads - 1,
            )
        # A wall cannot be moved by a force, and a brake never pushes.
        walls = [bead for bead in item.beads if mass[bead] == math.inf]
        if walls:
            raise InputError(
                "force_on_wall",
                "{what} act on bead {bead}, but it is a wall (infinite mass), which no force moves",
                what=what,
                bead=walls[0],
            )
        if brakes and min(item.force) < 0.0:
            raise InputError(
                "brake",
                "every brake must be >= 0 at all times, not {given:g}: it acts against the motion",
                given=min(item.force),
            )
    return tuple(given)


def summed(forces: Sequence[TimedForce], time: ArrayLike, beads: int) -> Array:
    """Return the sum (..., beads) of `forces` [N] at `time` (...) [s]."""
    total = np.zeros((*np.shape(time), beads))
    for item in forces:
        total[..., list(item.beads)] += item.at(time)[..., None]
    return total


def on_other_beads(forces: Sequence[TimedForce], new: Sequence[int | None]) -> tuple[TimedForce, ...]:
    """Return `forces` for a chain whose beads have been renumbered.

    Bead k has become bead ``new[k]``. None means that it was removed.
    """
    found = []
    for item in forces:
        beads = [moved for bead in item.beads if (moved := new[bead]) is not None]
        if beads:
            found.append(TimedForce(beads, item.time, item.force))
    return tuple(found)
