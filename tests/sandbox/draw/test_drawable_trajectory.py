"""Drawable trajectories: free flight before the start, and errors along the motion."""

import math
from dataclasses import replace

import numpy as np
import pytest
from softcradle.sandbox.draw import longest_lead
from softcradle.sandbox.film.scene_motion import scene_motions
from softcradle.scenes.catalogue import parse

SOFT = parse("""
title = "Soft"
[[lanes]]
beads = [1, 3]
contact = {law = "power_law", f0 = 1.0, alpha = 0.25}
velocity = 1.0
""")


@pytest.fixture(scope="module")
def motion():
    return scene_motions(SOFT, 40.0)[0]


def test_free_flight_before_the_start(motion):
    early = motion.time < 0.0
    assert early.any()
    assert motion.position[early, 0] == pytest.approx(motion.time[early])
    assert (motion.position[early, 1:] == 0.0).all()
    assert (motion.force[early] == 0.0).all()
    assert motion.energy_error[early].max() == 0.0
    chain = SOFT.lanes[0].chain()
    assert longest_lead(chain, np.array([1.0, 0.0, 0.0, 0.0])) == math.inf
    assert longest_lead(chain, np.array([0.0, 0.0, 0.0, 1.0])) == 0.0


def test_errors_are_those_of_the_motion(motion):
    energy = motion.kinetic.sum(axis=1) + motion.stored
    assert motion.energy_error[-1] == pytest.approx(np.abs(energy / energy[0] - 1.0).max())
    slowed = replace(motion, rate=0.5 * motion.rate, anchor=motion.anchor * [1.0, 0.5])
    assert slowed.momentum_error[-1] == pytest.approx(motion.momentum_error[-1], abs=1e-12)
    assert slowed.energy_error[-1] > 0.1
