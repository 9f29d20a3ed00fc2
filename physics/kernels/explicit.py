"""Explicit steps in overlap coordinates: symplectic Euler, leapfrog, and its fourth-order composition.

One step of each, from the same two moves, drift ``d += h w`` and kick ``w -= h L f(d)``:

    euler      drift(h) kick(h)                              order 1; what one pymunk step does
    verlet     drift(h/2) kick(h) drift(h/2)                 order 2
    yoshida4   verlet(a h) verlet(b h) verlet(a h)           order 4; a = 1/(2 - 2**(1/3)), b = 1 - 2a

A preload is set-valued at overlap 0; these methods take f = 0 there, so a contact that should only touch chatters.
"""

from __future__ import annotations

from physics.kernels.jit import jit
from physics.kernels.law import force as law_force

YOSHIDA_OUTER = 1.0 / (2.0 - 2.0 ** (1.0 / 3.0))
YOSHIDA_INNER = 1.0 - 2.0 * YOSHIDA_OUTER


@jit
def drift(h, overlap, rate, anchor):
    """``d += h w`` for every contact; the anchor bead moves on."""
    for i in range(overlap.size):
        overlap[i] += h * rate[i]
    anchor[0] += h * anchor[1]


@jit
def kick(h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead):
    """``w -= h L f(d)`` by way of the bead accelerations a_i = (f_(i-1) - f_i + push_i) / m_i; w_i += h (a_i - a_(i+1))."""
    n = overlap.size
    before = 0.0
    left = 0.0
    for i in range(n + 1):
        after = 0.0
        if i < n:
            if overlap[i] > 0.0:
                after = law_force(law[i, 0], law[i, 1], law[i, 2], overlap[i])
            force[i] = after
        net = before - after
        if push.size:
            net += push[i]
        acceleration = net * inverse_mass[i]
        if i > 0:
            rate[i - 1] += h * (left - acceleration)
        if i == anchor_bead:
            anchor[1] += h * acceleration
        left = acceleration
        before = after


@jit
def euler_step(h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead):
    """Symplectic Euler: drift, then kick."""
    drift(h, overlap, rate, anchor)
    kick(h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead)


@jit
def verlet_step(h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead):
    """Leapfrog: half a drift, kick, half a drift."""
    drift(0.5 * h, overlap, rate, anchor)
    kick(h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead)
    drift(0.5 * h, overlap, rate, anchor)


@jit
def yoshida4_step(h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead):
    """Fourth order from three leapfrogs, the middle one backwards (Yoshida 1990)."""
    verlet_step(YOSHIDA_OUTER * h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead)
    verlet_step(YOSHIDA_INNER * h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead)
    verlet_step(YOSHIDA_OUTER * h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead)
