"""Shares of the force if clusters were rigid."""

import math

from softcradle.sandbox.draw.rigid_clusters import rigid_shares


def test_rigid_shares_are_those_of_equation_4():
    assert rigid_shares([1.0] * 5, [1, 0, 0, 0, 0]) == (0, (1.0, 0.75, 0.5, 0.25))
    assert rigid_shares([1.0, 3.0, 2.0, 2.0], [1, 1, 0, 0]) == (1, (0.25, 1.0, 0.5))
    assert rigid_shares([1.0, 1.0, math.inf], [1, 0, 0])[1] == (0.0, 0.0)
    assert rigid_shares([1.0, 1.0, 1.0], [0, 0, 1])[1] == (0.0, 0.0)
