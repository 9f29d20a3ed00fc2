"""A cluster that just touches, driven by a steady force on its first bead: the chain, and what its model gives in closed form.

The mode-coupling model of it is one overlap, for unit strength ``psi'' = F/m1 - (1/m1 + 1/M) psi**alpha``, whose energy gives
amplitude and period: for n unit beads

    psi_max = ((1 + alpha) F (n-1)/n)**(1/alpha),   T = sqrt(2 psi_max / F) B(1/(2 alpha), 1/2) / alpha
"""

from __future__ import annotations

import math

from softcradle.physics import Chain, power_law

FORCE = 1.0  # in units of f0


def driven_chain(n: int, alpha: float) -> Chain:
    """`n` unit beads that just touch, the steady force on the first."""
    return Chain([1.0] * n, power_law(1.0, alpha), drive=[FORCE] + [0.0] * (n - 1))


def amplitude(n: int, alpha: float) -> float:
    """Largest psi of the model."""
    return float(((1.0 + alpha) * FORCE * (n - 1) / n) ** (1.0 / alpha))


def period(n: int, alpha: float) -> float:
    """Period of the model."""
    x = 0.5 / alpha
    beta = math.sqrt(math.pi) * math.exp(math.lgamma(x) - math.lgamma(x + 0.5))  # B(x, 1/2)
    return math.sqrt(2.0 * amplitude(n, alpha) / FORCE) * beta / alpha
