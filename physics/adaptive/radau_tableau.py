"""Coefficients of Radau IIA with three stages (Hairer & Wanner, Solving ODEs II, IV.5 and IV.8)."""

from __future__ import annotations

import numpy as np
from softcradle.physics.numerics.exact_matrices import exact_inverse, exact_product
from softcradle.physics.numerics.law_curve import NODES, ROOT6

TABLEAU = np.array(
    [
        [(88.0 - 7.0 * ROOT6) / 360.0, (296.0 - 169.0 * ROOT6) / 1800.0, (-2.0 + 3.0 * ROOT6) / 225.0],
        [(296.0 + 169.0 * ROOT6) / 1800.0, (88.0 + 7.0 * ROOT6) / 360.0, (-2.0 - 3.0 * ROOT6) / 225.0],
        [(16.0 - ROOT6) / 36.0, (16.0 + ROOT6) / 36.0, 1.0 / 9.0],
    ]
)
INVERSE = exact_inverse(TABLEAU)  # stage rates from stage overlaps
SQUARE_INVERSE = exact_product(INVERSE, INVERSE)
GAMMA = 1.0 / 3.637834252744496  # the one real eigenvalue of the inverse is 3 + 9**(1/3) - 3**(1/3)
EMBEDDED = GAMMA / 3.0 * np.array([-13.0 - 7.0 * ROOT6, -13.0 + 7.0 * ROOT6, -1.0])  # Hairer & Wanner, IV.8
_COARSE = np.array([0.0, 0.5 / (1.0 - NODES[1]), (0.5 - NODES[1]) / (1.0 - NODES[1])])  # quadrature of two nodes
COARSE = exact_product(TABLEAU[2] - _COARSE, INVERSE)  # its error, of one order less than the embedded one
