"""The colours can be distinguished."""

import numpy as np
from softcradle.sandbox.draw.palette import OKABE_ITO, bead_colours


def test_colours_differ_for_the_colour_blind():
    """Deuteranopia and protanopia after Machado et al. (2009), severity 1, on linear light."""
    machado = {
        "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    }
    linear = (np.array(OKABE_ITO) / 255.0) ** 2.2
    for name, matrix in machado.items():
        seen = np.clip(linear @ np.array(matrix).T, 0.0, 1.0) ** (1 / 2.2) * 255.0
        apart = np.linalg.norm(seen[:, None] - seen[None], axis=-1) + 1e3 * np.eye(len(seen))
        assert apart.min() > 20.0, name
    assert len(set(bead_colours(60))) == 60
