"""The colours can be distinguished."""

import numpy as np
from softcradle.sandbox.draw.palette import BEAD_COLOURS, OKABE_ITO, bead_colours


def apart(colours):
    """The least distance of two of the colours for the colour-blind.

    Deuteranopia and protanopia after Machado et al. (2009), severity 1, on linear light.
    """
    machado = {
        "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    }
    linear, least = (np.array(colours) / 255.0) ** 2.2, 1e3
    for matrix in machado.values():
        seen = np.clip(linear @ np.array(matrix).T, 0.0, 1.0) ** (1 / 2.2) * 255.0
        distance = np.linalg.norm(seen[:, None] - seen[None], axis=-1) + 1e3 * np.eye(len(seen))
        least = min(least, distance.min())
    return least


def test_colours_differ_for_the_colour_blind():
    assert apart(OKABE_ITO) > 20.0
    assert len(set(bead_colours(60))) == 60


def test_a_dozen_beads_have_colours_of_their_own():
    """Twice as far apart as the least that is told apart, also where shades of red and green look alike."""
    assert bead_colours(12) == BEAD_COLOURS
    assert len(set(BEAD_COLOURS)) == 12
    assert apart(BEAD_COLOURS) > 40.0
