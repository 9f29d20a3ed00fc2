"""Steps of an adaptive method in which the contact forces are given: what a test of events knows in closed form."""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics import Chain, State, hertz
from softcradle.physics.adaptive.event_location import NOTHING, find_event, guard_at_end
from softcradle.physics.adaptive.step_records import WORK_ROWS, Regime, empty_trial
from softcradle.physics.numerics.law_curve import NODES
from softcradle.physics.numerics.records import OPEN

from tests.helpers.plain_kernels import records_of, row_matrix

H = 0.4  # [s] length of the steps
NODE_TIMES = H * NODES


class Step:
    """A step of length H in which every contact force goes as the polynomial of time that is given for it.

    Overlaps and velocities follow exactly, by integration of the polynomials.
    """

    def __init__(self, chain, velocity, overlap, modes, forces, slide=None, easing=None):
        self.chain = chain
        state = State.at_start(chain, velocity)
        state.overlap[:] = overlap
        self.forces = [np.polynomial.Polynomial(np.atleast_1d(force)) for force in forces]
        state.force[:] = [force(0.0) for force in self.forces]
        self.data, _, self.motion = records_of(chain, state)
        self.motion.mode[:] = modes
        loss = chain.loss.copy() if chain.loss.any() else np.zeros(0)
        bed = chain.bed.copy() if chain.on_bed else np.zeros(0)
        flags = np.zeros(chain.contacts + 1, dtype=np.int8)
        if slide is not None:
            flags[:] = slide
        eased = np.zeros(chain.contacts, dtype=np.int8)
        if easing is not None:
            eased[:] = easing
        self.regime = Regime(self.data.law, self.data.inverse_mass, self.data.push, loss, bed, flags, eased)
        self.work, self.trial = np.zeros((WORK_ROWS, chain.contacts + 1)), empty_trial(chain.contacts)
        matrix = row_matrix(chain)
        external = self.data.external[:-1] if self.data.external.size else np.zeros(chain.contacts)
        for k, time in enumerate(NODE_TIMES):
            self.trial.force[k] = [force(time) for force in self.forces]
            once = np.array([force.integ()(time) for force in self.forces])
            twice = np.array([force.integ(2)(time) for force in self.forces])
            self.trial.rate[k] = self.motion.rate + external * time - matrix @ once
            self.trial.overlap[k] = (
                self.motion.overlap + self.motion.rate * time + 0.5 * external * time**2 - matrix @ twice
            )
        self.trial.anchor[:] = state.anchor
        bead = chain.anchor
        if chain.inverse_mass[bead] > 0.0:  # the tests anchor beads that no contact pushes, or walls
            self.trial.anchor[1] += H * (self.data.external[-1] if self.data.external.size else 0.0)

    def find(self, skip=-1, skipped=NOTHING, inactive=0.0, slow=0.0):
        return find_event(H, self.data, self.regime, self.motion, self.trial, skip, skipped, inactive, slow, self.work)

    def guard(self, row, kind):
        return guard_at_end(H, row, kind, self.data, self.regime, self.motion, self.trial, self.work)


def thrown(speed, gap, pull=-9.8):
    """A bead thrown at a wall against a steady force."""
    chain = Chain([1.0, math.inf], hertz(1e3), drive=[pull, 0.0])
    return Step(chain, [speed, 0.0], [-gap], [OPEN], [0.0])
