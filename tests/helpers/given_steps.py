"""Steps of an adaptive method with prescribed contact forces. The events in such a step are known in closed form."""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics import Chain, State, hertz
from softcradle.physics.adaptive.corner_search import first_corner, guard_of
from softcradle.physics.adaptive.step_records import VELOCITY_AFTER, VELOCITY_BEFORE, Bounds, empty_trial
from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.law_curve import NODES
from softcradle.physics.numerics.records import LOADED, OPEN, TOUCHING

from tests.helpers.plain_kernels import context_of, effective_records, row_matrix

H = 0.4  # Length of the steps [s].
NODE_TIMES = H * NODES


class Step:
    """A step of length H in which the contact forces are polynomials of time. Overlaps and velocities follow by
    integration.
    """

    def __init__(self, chain, velocity, overlap, modes, forces, slide=0, easing=0):
        self.chain = chain
        state = State.at_start(chain, velocity)
        state.overlap[:] = overlap
        self.forces = [np.polynomial.Polynomial(np.atleast_1d(force)) for force in forces]
        state.force[:] = [force(0.0) for force in self.forces]
        self.data, self.regime, self.motion = effective_records(chain, state)
        self.motion.mode[:], self.regime.slide[:], self.regime.easing[:] = modes, slide, easing
        self.trial = empty_trial(chain.contacts)
        matrix = row_matrix(chain)
        external = self.data.external[:-1] if self.data.external.size else np.zeros(chain.contacts)
        for k, time in enumerate(NODE_TIMES):
            self.trial.force[k] = [force(time) for force in self.forces]
            once, twice = ([force.integ(times)(time) for force in self.forces] for times in (1, 2))
            self.trial.rate[k] = self.motion.rate + external * time - matrix @ once
            free = self.motion.overlap + self.motion.rate * time + 0.5 * external * time**2
            self.trial.overlap[k] = free - matrix @ twice
        self.trial.anchor[:] = state.anchor
        # In these tests the anchor is a wall or a bead without contact force. Only the external force accelerates the
        # anchor.
        if self.data.external.size:
            self.trial.anchor[1] += H * self.data.external[-1]

    def corner(self, landing=(-1, 0), slow=0.0):
        """Return the result of `first_corner` for this step."""
        return first_corner(H, *landing, self.context(slow))

    def context(self, slow=0.0):
        """Return the context of this step, in which rates up to `slow` count as zero."""
        bounds = Bounds(0.0, slow, 0.0, 0.0, 0.0, 0.0)
        return context_of(self.data, self.regime, self.motion, bounds, self.trial)

    def find(self, landing=(-1, 0), slow=0.0):
        """Return the first event of this step: the contact or bead, the name of the event, and the fraction of the
        step.
        """
        row, side, part, *_ = self.corner(landing, slow)
        n = self.chain.contacts
        if row < 0:
            return row, "nothing", part
        if row >= n:
            return row - n, "stops" if self.regime.slide[row - n] else "slips", part
        eases = "eases" if self.motion.overlap[row] > 0.0 else "opens"
        names = {OPEN: ("closes",), LOADED: ("opens", "turns"), TOUCHING: (eases, "yields")}
        return row, names[int(self.motion.mode[row])][side], part

    def guard(self, row, side):
        """Return the value and the slope of the guard function at the end of the step."""
        context = self.context()
        work, anchor_bead = context.scratch.work, self.data.anchor_bead
        bead_velocities(self.motion.rate, anchor_bead, self.motion.anchor[1], work[VELOCITY_BEFORE])
        bead_velocities(self.trial.rate[2], anchor_bead, self.trial.anchor[1], work[VELOCITY_AFTER])
        b = guard_of(row, side, H, context)
        return b[5], 5.0 * (b[5] - b[4]) / H


def at_wall(law, speed, overlap, mode, force, **more):
    """Return a step of a bead of 1 kg whose only contact is with a wall."""
    return Step(Chain([1.0, math.inf], law), [speed, 0.0], [overlap], [mode], [force], **more)


def thrown(speed, gap, pull=-9.8):
    """Return a step of a bead that is thrown at a wall. A constant force `pull` [N] acts on the bead."""
    chain = Chain([1.0, math.inf], hertz(1e3), drive=[pull, 0.0])
    return Step(chain, [speed, 0.0], [-gap], [OPEN], [0.0])
