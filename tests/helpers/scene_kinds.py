"""Scenes of the catalogue for tests that are not about scenes: four that differ in kind, the others in `make test-all`."""

import pytest

from softcradle import scenes

# One row; two lanes beside each other; a drive without an end; couplers, forces over time and friction.
KINDS = ("one-on-four", "beads-against-gear", "driven-cluster", "train-braking")
EVERY_SCENE = [name if name in KINDS else pytest.param(name, marks=pytest.mark.slow) for name in scenes.names()]
