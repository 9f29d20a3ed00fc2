"""Explicit steps in overlap coordinates: every method is a row of drifts and kicks of different length.

    drift(c h)   d += c h w              kick(c h)   w -= c h L f(d)

    euler        drift(1) kick(1)                                        order 1; what one pymunk step does
    verlet       drift(1/2) kick(1) drift(1/2)                           order 2
    yoshida4     drift(a/2) kick(a) drift((a+b)/2) kick(b) drift((a+b)/2) kick(a) drift(a/2)
                 order 4: three leapfrogs, the middle one backwards; a = 1/(2 - 2**(1/3)), b = 1 - 2a (Yoshida 1990)

Long chains take the same steps in vector code: `long`.

A preload is set-valued at overlap 0; these methods take f = 0 there, so a contact that should only touch chatters.
"""

from __future__ import annotations

import numpy as np
from softcradle.physics.numerics.contact_law import force as law_force
from softcradle.physics.numerics.jit import jit

_OUTER = 1.0 / (2.0 - 2.0 ** (1.0 / 3.0))
_INNER = 1.0 - 2.0 * _OUTER

# (drifts, kicks) as parts of the step; one drift more than kicks
EULER = np.array([1.0, 0.0]), np.array([1.0])
VERLET = np.array([0.5, 0.5]), np.array([1.0])
YOSHIDA4 = (
    np.array([0.5 * _OUTER, 0.5 * (_OUTER + _INNER), 0.5 * (_OUTER + _INNER), 0.5 * _OUTER]),
    np.array([_OUTER, _INNER, _OUTER]),
)


@jit
def split_steps(
    most, h, drifts, kicks, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, closed
):  # fmt: skip
    """Up to `most` steps in place; stops after the first in which a contact leaves the state in `closed`.

    Returns the steps taken. The kick goes by way of the bead accelerations a_i = (f_(i-1) - f_i + push_i) / m_i:
    w_i += h (a_i - a_(i+1)).
    """
    n = overlap.size
    for step in range(most):
        for stage in range(kicks.size):
            part = h * drifts[stage]
            for i in range(n):
                overlap[i] += part * rate[i]
                force[i] = law_force(law[i, 0], law[i, 1], law[i, 2], overlap[i])
            anchor[0] += part * anchor[1]
            part = h * kicks[stage]
            if push.size:
                anchor[1] += part * push[anchor_bead] * inverse_mass[anchor_bead]
                for i in range(n):
                    rate[i] += part * (push[i] * inverse_mass[i] - push[i + 1] * inverse_mass[i + 1])
            before = force[anchor_bead - 1] if anchor_bead > 0 else 0.0
            after = force[anchor_bead] if anchor_bead < n else 0.0
            anchor[1] += part * (before - after) * inverse_mass[anchor_bead]
            left = -force[0] * inverse_mass[0]
            for i in range(n - 1):
                right = (force[i] - force[i + 1]) * inverse_mass[i + 1]
                rate[i] += part * (left - right)
                left = right
            rate[n - 1] += part * (left - force[n - 1] * inverse_mass[n])
        part = h * drifts[kicks.size]
        if part != 0.0:
            for i in range(n):
                overlap[i] += part * rate[i]
            anchor[0] += part * anchor[1]
        switched = False
        for i in range(n):
            switched |= (overlap[i] > 0.0) != (closed[i] != 0)
        if switched:
            return step + 1
    return most
