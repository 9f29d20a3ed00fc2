"""Table of hits: its columns, and a log that fills it during the steps of a live chain of bodies."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Columns of the table of hits, with their units.
COLUMNS = {
    "contact": "index of the contact",
    "begin": "time at which the contact closes [s]",
    "end": "time at which it opens, or inf if it stays closed [s]",
    "impulse": "momentum passed from the left bead to the right one [N s]",
    "closing_speed": "overlap rate at the begin [m/s]",
    "largest_force": "largest force, negative for a pull [N]",
    "energy_lost": "energy dissipated by the contact [J]",
}
TYPE = np.dtype([(name, np.int64 if name == "contact" else np.float64) for name in COLUMNS])

# Largest number of finished hits that a log keeps. If nobody reads the log, older hits are removed.
MOST_KEPT = 10_000


class Hit(NamedTuple):
    """Finished hit: the time interval in which a contact was closed.

    Attributes:
        begin, end: times of closing and opening [s], counted from the first step of the contact.
        impulse: momentum transmitted from the first body to the second body [N s].
        closing_speed: rate of the overlap when the contact closes [m/s].
        largest_force: largest force [N].
        energy_lost: energy dissipated by the contact [J].
    """

    begin: float
    end: float
    impulse: float
    closing_speed: float
    largest_force: float
    energy_lost: float


class HitLog:
    """Log of the hits of n contacts, which is updated after each step.

    Attributes:
        time: time since the first step [s].
    """

    def __init__(self, contacts: int) -> None:
        self.time = 0.0
        self._acts = np.zeros(contacts, dtype=bool)
        self._begin, self._speed, self._impulse, self._largest, self._lost = np.zeros((5, contacts))
        self._finished: list[tuple[int, Hit]] = []

    def add_step(
        self,
        step: float,
        before: tuple[Array, Array],
        after: tuple[Array, Array],
        force: Array,
        largest: Array,
        lost: Array,
    ) -> None:
        """Add a step of length `step` [s].

        `before` and `after` are overlaps (n,) [m] and overlap rates (n,) [m/s]. `force` (n,) is the mean force [N],
        `largest` (n,) the largest force [N], and `lost` (n,) the dissipated energy [J].
        """
        pushes = force > 0.0
        self.time += step
        if not pushes.any() and not self._acts.any():
            return
        # Log the hits of contacts that have opened by the end of the last step.
        for i in np.flatnonzero(self._acts & ~pushes).tolist():
            self._finish(i, self.time - step)
        for i in np.flatnonzero(pushes & ~self._acts).tolist():
            overlap, rate = float(before[0][i]), float(before[1][i])
            wait = -overlap / rate if overlap < 0.0 < rate else 0.0
            self._begin[i] = self.time - step + min(wait, step)
            self._speed[i], self._impulse[i], self._largest[i], self._lost[i] = rate, 0.0, 0.0, 0.0
        self._impulse[pushes] += step * force[pushes]
        self._largest[pushes] = np.maximum(self._largest, largest)[pushes]
        self._lost[pushes] += lost[pushes]
        self._acts = pushes
        for i in np.flatnonzero(pushes & (after[0] < 0.0)).tolist():
            overlap, rate = float(after[0][i]), float(after[1][i])
            since = overlap / rate if rate < 0.0 else 0.0
            self._finish(i, max(self.time - min(since, step), float(self._begin[i])))
            self._acts[i] = False

    def _finish(self, contact: int, end: float) -> None:
        columns = self._begin, self._impulse, self._speed, self._largest, self._lost
        begin, *numbers = (float(column[contact]) for column in columns)
        self._finished.append((contact, Hit(begin, end, *numbers)))
        del self._finished[:-MOST_KEPT]

    def take(self, threshold: float = 0.0) -> NDArray[np.void]:
        """Return the finished hits with an impulse of at least `threshold` [N s], sorted by their begin.

        All finished hits are removed from the log.
        """
        kept = [(contact, *hit) for contact, hit in self._finished if hit.impulse >= threshold]
        self._finished.clear()
        return np.array(sorted(kept, key=lambda row: (row[1], row[0])), TYPE)

    def forget(self) -> None:
        """Remove all finished and current hits, for example after a jump of the motion."""
        self._finished.clear()
        self._acts[:] = False


class LiveHit:
    """Current hit of a contact whose force is evaluated once per step."""

    def __init__(self) -> None:
        self.time = 0.0
        self._begin = math.nan
        self._speed = self._impulse = self._largest = self._lost = self._stored = 0.0

    def step(self, step: float, overlap: float, rate: float, force: float, stored: float, loss: float) -> Hit | None:
        """Add a step of length `step` [s], with the overlap, rate, force and stored energy of the contact.

        Return the hit if it ended in this step, otherwise None.
        """
        self.time += step
        if overlap <= 0.0:
            if math.isnan(self._begin):
                return None
            since = overlap / rate if rate < 0.0 else 0.0
            self._lost += loss * self._stored
            end = max(self.time - min(since, step), self._begin)
            found = Hit(self._begin, end, self._impulse, self._speed, self._largest, self._lost)
            self._begin = math.nan
            return found
        if math.isnan(self._begin):
            self._begin = self.time - (min(overlap / rate, step) if rate > 0.0 else 0.0)
            self._speed, self._impulse, self._largest, self._lost, self._stored = rate, 0.0, 0.0, 0.0, 0.0
        self._impulse += step * force
        self._largest = max(self._largest, force)
        self._lost += loss * max(self._stored - stored, 0.0)
        self._stored = stored
        return None
