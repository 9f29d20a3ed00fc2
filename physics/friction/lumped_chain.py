"""The lumped chain: what a dissipative chain is while its stick-slip modes last, and the margins until they end."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.contact import Contact
from softcradle.physics.friction.stick_slip import HELD, PRESSED, RELEASED, Modes, bed_force, law_force
from softcradle.physics.state import State

Array = NDArray[np.float64]

SLACK = 1e-9  # of the largest friction or force: how far a force may leave its bounds before the mode ends


@dataclass
class LumpedChain:
    """Beads that move as one, `of` (n+1,) the lump of each; the chain of lumps (None: there is one) and its start."""

    chain: Chain
    modes: Modes
    start: State
    of: NDArray[np.int64]
    between: NDArray[np.int64]
    push: Array
    mass: Array
    reduced: Chain | None
    begin: State

    @classmethod
    def at(cls, chain: Chain, state: State, modes: Modes) -> LumpedChain:
        """The lumps of `chain` in these `modes`, from `state` on."""
        external = state.external(chain)
        push = -modes.slides * bed_force(chain) + (0.0 if external is None else external)
        firm = modes.sticks | (np.isinf(chain.mass) & (state.velocity(chain) == 0.0))
        joined = (modes.contact == HELD) | (firm[:-1] & firm[1:])
        between = np.flatnonzero(~joined)
        of = np.concatenate(([0], np.cumsum(~joined)))
        mass = np.array([np.where(firm, math.inf, chain.mass)[of == g].sum() for g in range(of[-1] + 1)])
        total = np.where(np.isfinite(mass), np.bincount(of, weights=push), 0.0)
        velocity = state.velocity(chain)
        first = np.flatnonzero(np.concatenate(([True], ~joined)))
        laws = [_released(chain, int(i), modes) for i in between]
        reduced = Chain(mass, laws, drive=total) if laws else None
        lead = reduced.anchor if reduced else 0
        anchor = np.array([0.0, 0.0 if firm[of == lead].any() else velocity[first[lead]]])
        begin = State(state.time, state.overlap[between], state.rate[between], anchor, state.force[between])
        return cls(chain, modes, state, of, between, total, mass, reduced, begin)

    def whole(self, time: float, overlap: Array, rate: Array, anchor: Array, force: Array) -> State:
        """The state of all beads from that of the lumps."""
        found = self.start.copy()
        found.time = time
        found.overlap[self.between], found.rate[self.between] = overlap, rate
        found.force[self.between] = force
        found.rate[np.setdiff1d(np.arange(self.chain.contacts), self.between)] = 0.0
        small = State(time, overlap, rate, anchor, force)
        lead = int(self.of[self.chain.anchor])
        if self.reduced is None:
            moved, speed = float(anchor[0]), float(anchor[1])
        else:
            before, now = self.begin.position(self.reduced), small.position(self.reduced)
            moved, speed = float(now[lead] - before[lead]), float(small.velocity(self.reduced)[lead])
        if np.isinf(self.mass[lead]) and self.start.anchor[1] == 0.0:
            moved, speed = 0.0, 0.0
        found.anchor[:] = self.start.anchor[0] + moved, speed
        self._carry(found)
        found.absorbed[:] = self.start.absorbed + self._absorbed(found)
        return found

    def velocity(self, state: State) -> Array:
        """(n+1,) bead velocities, exactly 0 where beads stick."""
        return np.where(self.modes.sticks, 0.0, state.velocity(self.chain))

    def _absorbed(self, now: State) -> Array:
        """(2,) energy [J] absorbed since the start of the modes."""
        by_contacts = 0.0
        for i in np.flatnonzero(self.modes.contact == RELEASED):
            law = self.chain.contact[i]
            by_contacts += law.loss * float(law.energy(self.start.overlap[i]) - law.energy(now.overlap[i]))
        path = now.position(self.chain) - self.start.position(self.chain)
        return np.array([by_contacts, float((self.modes.slides * bed_force(self.chain)) @ path)])

    def _bounds(self, state: State) -> tuple[Array, Array]:
        """(n,) what forces of contacts inside lumps may be; of those between lumps, what they are."""
        full = law_force(self.chain, state.overlap)
        low, high = np.where(self.chain.loss > 0.0, (1.0 - self.chain.loss) * full, full), full
        touching = state.overlap == 0.0
        preload = np.array([law.preload for law in self.chain.contact])
        low, high = np.where(touching, 0.0, low), np.where(touching, preload, high)
        low[self.between] = high[self.between] = state.force[self.between]
        return low, high

    def _carry(self, state: State) -> float:
        """Put forces inside lumps into `state`; returns by how much [N] the least of all bounds is kept (< 0: broken)."""
        chain, most = self.chain, bed_force(self.chain)
        low, high = self._bounds(state)
        external = state.external(chain)
        push = -self.modes.slides * most + (0.0 if external is None else external)
        room, now = math.inf, (0.0, 0.0)
        for j in range(chain.contacts + 1):
            lump = int(self.of[j])
            give = math.inf if np.isinf(chain.mass[j]) else (float(most[j]) if self.modes.sticks[j] else 0.0)
            bent = 0.0 if np.isinf(self.mass[lump]) else chain.mass[j] * self._acceleration(lump, state)
            a, b = now[0] + push[j] - bent - give, now[1] + push[j] - bent + give
            least, largest = (low[j], high[j]) if j < chain.contacts else (0.0, 0.0)
            inside = j < chain.contacts and self.of[j + 1] == lump
            if inside or give > 0.0:
                room = min(room, b - least, largest - a)
            if j < chain.contacts:
                now = (max(a, least), min(b, largest)) if inside else (low[j], low[j])
                if inside:
                    state.force[j] = min(max(0.5 * (now[0] + now[1]), least), largest)
        return room

    def _acceleration(self, lump: int, state: State) -> float:
        before = state.force[self.between[lump - 1]] if lump > 0 else 0.0
        after = state.force[self.between[lump]] if lump < self.between.size else 0.0
        return float((before - after + self.push[lump]) / self.mass[lump])

    def margin(self, state: State, fresh: bool = False) -> float:
        """How far these modes are from their end: negative past it. Velocities that begin at 0 do not count when `fresh`."""
        velocity, modes = self.velocity(state), self.modes
        force_scale = float(bed_force(self.chain).max(initial=0.0) + np.abs(state.force).max(initial=0.0)) or 1.0
        speed = float(np.abs(np.append(velocity, state.rate)).max()) or 1.0
        found = self._carry(state) / force_scale + SLACK
        for began, now in ((modes.slides * self.velocity(self.start), modes.slides * velocity), *self._rates(state)):
            counted = np.where((began == 0.0) & (fresh | (now == 0.0)), math.inf, now)
            found = min(found, float(counted.min(initial=math.inf)) / speed if counted.size else math.inf)
        return found

    def _rates(self, state: State) -> list[tuple[Array, Array]]:
        """Rates, signed so that they are positive in their mode, of contacts with loss that are pressed or ease."""
        lossy, modes = self.chain.loss > 0.0, self.modes
        pressed = lossy & (modes.contact == PRESSED) & (state.overlap > 0.0)
        released = lossy & (modes.contact == RELEASED) & (state.overlap > 0.0)
        gone = lossy & (modes.contact == RELEASED) & (state.overlap < 0.0)
        return [
            (self.start.rate[pressed], state.rate[pressed]),
            (-self.start.rate[released], -state.rate[released]),
            (np.ones(int(gone.sum())), state.overlap[gone]),
        ]


def _released(chain: Chain, index: int, modes: Modes) -> Contact:
    """Contact `index` without loss, as it pushes in these modes."""
    law = chain.contact[index]
    part = 1.0 - law.loss if modes.contact[index] == RELEASED else 1.0
    return replace(law, preload=part * law.preload, stiffness=part * law.stiffness, loss=0.0)
