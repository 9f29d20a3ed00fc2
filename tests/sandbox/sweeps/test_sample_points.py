"""Tests of the sample points of a parameter sweep.

The values of a point must depend only on its number, not on the chunk in which it is computed. The tests also compare
random samples with SciPy and check error messages.
"""

import pickle

import numpy as np
import pytest
from scipy.stats import qmc
from softcradle.physics import Chain, power_law
from softcradle.sandbox.sweeps import Axis, grid, latin_hypercube, listed, sobol
from softcradle.sandbox.sweeps.scene_points import ScenePoints, changed
from softcradle.sandbox.user_error import StudyError
from softcradle.scenes import SceneError, load, parse

SCENE = load("one-on-four")
OWN = changed(SCENE, {"lanes.0.velocity.1": 0.5})
BOUNDS = {"x": (0.0, 2.0), "y": (0.01, 1.0, "log"), "n": (2, 5, "whole")}
DESIGNS = {
    "grid": grid({"x": np.linspace(0, 1, 7), "y": [1, 2, 3], "z": ["a", "b"]}),
    "list": listed({"x": np.linspace(0, 1, 42), "y": range(42)}),
    "sobol": sobol(BOUNDS, 42, seed=3),
    "latin_hypercube": latin_hypercube(BOUNDS, 42, seed=3),
}


@pytest.mark.parametrize("points", DESIGNS.values(), ids=DESIGNS)
def test_chunks_do_not_change_the_points(points):
    whole = points.columns(0, 42)
    # These ranges of points can occur when an interrupted sweep is resumed.
    for begin, end in ((0, 1), (1, 2), (2, 20), (20, 42), (0, 41), (41, 42), (30, 42), (5, 10)):
        chunk = points.columns(begin, end)
        for path, values in whole.items():
            np.testing.assert_array_equal(chunk[path], values[begin:end])


def test_a_grid_has_every_combination_in_order():
    columns = DESIGNS["grid"].columns(0, 42)
    expected = [(0.0, y, z) for y in (1, 2, 3) for z in "ab"]
    assert list(zip(columns["x"][:6], columns["y"][:6], columns["z"][:6], strict=True)) == expected
    assert DESIGNS["grid"].shape == (7, 3, 2)
    far = grid({"x": range(10_000), "y": range(10_000)}).columns(99_999_999, 100_000_000)
    assert (far["x"].item(), far["y"].item()) == (9999, 9999)


def test_samples_are_those_of_scipy_between_their_bounds():
    for name, engine in (("sobol", qmc.Sobol), ("latin_hypercube", qmc.LatinHypercube)):
        unit = engine(3, rng=np.random.default_rng(3)).random(64 if name == "sobol" else 42)[:42]
        columns = DESIGNS[name].columns(0, 42)
        np.testing.assert_array_equal(columns["x"], 2.0 * unit[:, 0])
        np.testing.assert_allclose(columns["y"], 0.01 * 100.0 ** unit[:, 1], rtol=1e-14)
        np.testing.assert_array_equal(columns["n"], 2 + np.floor(4 * unit[:, 2]))
        assert set(columns["n"]) == {2, 3, 4, 5}
    np.testing.assert_array_equal(sobol(BOUNDS, 1000, 3).columns(0, 42)["y"], DESIGNS["sobol"].columns(0, 42)["y"])


def at(path):
    return changed(SCENE, {path: 1.0})


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: grid({}), "at least one parameter"),
        (lambda: grid({"x": []}), "x needs at least one value"),
        (lambda: grid({"x": 3}), "x must be a list of values, not 3"),
        (lambda: listed({"x": [1, 2], "y": [1]}), r"as many values of each parameter, not \{'x': 2, 'y': 1\}"),
        (lambda: sobol({"x": 1}, 8), r"x must be \(low, high\) or \(low, high, scale\), not 1"),
        (lambda: sobol({"x": (0, 1, "log")}, 8), "x: bounds on a log scale must be at least 1e-30, not 0 and 1"),
        (lambda: sobol({"x": (0.5, 2, "whole")}, 8), "x: bounds of whole numbers must be whole"),
        (lambda: sobol({"x": (0, 1, "cubic")}, 8), "x: scale must be one of linear, log, whole, not 'cubic'"),
        (lambda: sobol({"x": (0, 1)}, 0), "from 1 to .* points, not 0"),
        (lambda: grid({"x": range(2**16), "y": range(2**16)}), "from 1 to 1073741824 points, not 4294967296"),
        (lambda: sobol({"x": (0, 1)}, 2**31), "samples of 1 parameters have at most"),
        (lambda: sobol({"x": (0, 1)}, 8, -1), "seed must be at least 0, not -1"),
        (lambda: latin_hypercube(BOUNDS, 10_000_000), "at most 5592405 points, not 10000000"),
        (lambda: grid([Axis("x", (1,), name="a"), Axis("y", (2,), name="a")]), "two parameters are called 'a'"),
        (lambda: changed(OWN, {"lanes.0.beads.1": 5}), "velocity is a list of 5, but 6 beads need 6"),
        (lambda: at("lane.0.mass"), r"lane.0.mass: there is no 'lane' \(did you mean 'lanes'\?\); allowed: title"),
        (lambda: at("lanes.1.mass"), r"lanes.1.mass: '1' must be a number from 0 to 0, or \* for all"),
        (lambda: at("lanes.0.contact.alfa"), r"there is no 'alfa' \(did you mean 'alpha'\?\)"),
        (lambda: at("lanes.0.contact.alpha.1"), "there is nothing below 'lanes.0.contact.alpha', which is 0.1"),
    ],
)
def test_invalid_sample_points_are_rejected(make, sentence):
    with pytest.raises((StudyError, SceneError), match=sentence):
        make()


MIXED = parse("""
title = "mixed"
tolerance = 1e-6
[[lanes]]
mass = [1.0, 2.0, 3.0]
contact = [{law = "power_law", f0 = 1.0, alpha = 0.1}, {law = "hertz", stiffness = 100.0}]
velocity = [1.0, 0.0, 0.0]
""")


@pytest.mark.parametrize(
    ("values", "velocity", "mass"),
    [
        *(
            ({"beads.0": m, "beads.1": n, "contact.alpha": 0.25}, (1.0,) * m + (0.0,) * n, (1.0,) * (m + n))
            for m, n in ((1, 4), (2, 3), (3, 2), (2, 4), (1, 1))
        ),
        ({"velocity.0": 2.0, "beads.0": 2, "beads.1": 3}, (2.0, 1.0, 0.0, 0.0, 0.0), (1.0,) * 5),
        ({"velocity": 2.0, "beads.0": 2, "beads.1": 3}, (2.0, 2.0, 0.0, 0.0, 0.0), (1.0,) * 5),
        ({"velocity": 2.0, "velocity.1": 3.0}, (2.0, 3.0, 0.0, 0.0, 0.0), (1.0,) * 5),
        ({"velocity.1": 3.0, "velocity": 2.0}, (2.0, 0.0, 0.0, 0.0, 0.0), (1.0,) * 5),
        ({"mass.0": 2.0, "beads.1": 5}, (1.0,) + (0.0,) * 5, (2.0,) + (1.0,) * 5),
        ({"mass": 2.5}, (1.0,) + (0.0,) * 4, (2.5,) * 5),
        ({"mass.2": 5.0, "velocity.1": 0.5}, (1.0, 0.5, 0.0, 0.0, 0.0), (1.0, 1.0, 5.0, 1.0, 1.0)),
    ],
)
def test_values_fit_the_number_of_beads_in_any_order(values, velocity, mass):
    """Check that a list of values fits the number of beads, in any order of the parameters.

    The chain with two strikers and three targets has five beads, like the chain with one striker and four targets. In
    an earlier version, only the first of the two strikers moved.
    """
    gap = np.eye(1, len(mass) - 1, values.get("beads.0", 1) - 1)[0]
    chain = Chain(mass, power_law(1.0, values.get("contact.alpha", 0.1)), gap)
    values = {f"lanes.0.{path}": value for path, value in values.items()}
    (found,), lane = ScenePoints(SCENE).starts(values), changed(SCENE, values).lanes[0]
    assert tuple(found.velocity) == lane.velocity == velocity
    assert found.chain == lane.chain() == chain


def test_velocities_of_ones_own_stay_with_their_beads():
    assert changed(OWN, {"lanes.0.beads": [2, 3]}).lanes[0].velocity == (1.0, 0.5, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("paths", [("lanes.0.mass", "lanes.0.mass.2"), ("lanes.0.mass.*", "lanes.0.mass.2")])
def test_of_two_values_for_one_number_the_last_counts(paths):
    """Check that the last of two values for the same parameter is used.

    Values of one sample point must not remain in the next point.
    """
    points = ScenePoints(SCENE)
    for bead in (5.0, 6.0):
        (found,) = points.starts(dict(zip(paths, (2.0, bead), strict=True)))
        assert found.chain.mass == (2.0, 2.0, bead, 2.0, 2.0)
    assert points.starts({})[0].chain.mass == (1.0,) * 5
    assert points.starts({"lanes.0.gap.3": 0.1})[0].chain.gap == (0.0, 0.0, 0.0, 0.1)


def test_contacts_one_by_one_or_all():
    mixed, before = ScenePoints(MIXED), MIXED.model_copy(deep=True)
    values = {"lanes.0.contact.1.stiffness": 7.0, "lanes.0.contact.*.loss": 0.25, "method": "radau", "tolerance": 1e-3}
    (found,) = mixed.starts(values)
    assert [contact.stiffness for contact in found.chain.contact] == [1.0, 7.0]
    assert [contact.loss for contact in found.chain.contact] == [0.25, 0.25]
    assert (found.settings["method"], found.settings["tolerance"]) == ("radau", 1e-3)
    assert mixed.scene == before
    (train,) = ScenePoints(load("train-solid")).starts({"lanes.0.contact.push.loss": 0.7})
    assert {coupler.push.loss for coupler in train.chain.contact} == {0.7}


def test_it_can_be_sent_to_another_process():
    for known in (SCENE, MIXED, load("experiment-one-on-three"), load("train-braking")):
        values = {"lanes.0.mass.1": 3.0}
        points = ScenePoints(known)
        points.starts(values)
        sent = pickle.loads(pickle.dumps(points))
        assert sent.scene == known
        assert sent.starts(values)[0].chain == ScenePoints(known).starts(values)[0].chain
