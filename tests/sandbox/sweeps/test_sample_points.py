"""Sample points: each follows from its number alone, whatever the chunk; SciPy's samples; refusals."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.stats import qmc
from softcradle.sandbox.sweeps import Axis, grid, latin_hypercube, listed, sobol
from softcradle.sandbox.user_error import StudyError

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
    for cuts in ((0, 1, 2, 20, 42), (0, 41, 42)):
        parts = [points.columns(*pair) for pair in itertools.pairwise(cuts)]
        for path in reversed(whole):
            np.testing.assert_array_equal(np.concatenate([part[path] for part in parts]), whole[path])
    late, early = points.columns(30, 42), points.columns(5, 10)  # backwards, as after a resumption
    for path, values in whole.items():
        np.testing.assert_array_equal(late[path], values[30:])
        np.testing.assert_array_equal(early[path], values[5:10])


def test_a_grid_has_every_combination_the_last_fastest():
    columns = DESIGNS["grid"].columns(0, 42)
    assert list(zip(columns["x"][:6], columns["y"][:6], columns["z"][:6], strict=True)) == [
        (0.0, 1, "a"), (0.0, 1, "b"), (0.0, 2, "a"), (0.0, 2, "b"), (0.0, 3, "a"), (0.0, 3, "b"),
    ]  # fmt: skip
    assert DESIGNS["grid"].shape == (7, 3, 2)


def test_samples_are_those_of_scipy_between_their_bounds():
    for name, engine in (("sobol", qmc.Sobol), ("latin_hypercube", qmc.LatinHypercube)):
        unit = engine(3, rng=np.random.default_rng(3)).random(64)[:42] if name == "sobol" else None
        unit = engine(3, rng=np.random.default_rng(3)).random(42) if unit is None else unit
        columns = DESIGNS[name].columns(0, 42)
        np.testing.assert_array_equal(columns["x"], 2.0 * unit[:, 0])
        np.testing.assert_allclose(columns["y"], 0.01 * 100.0 ** unit[:, 1], rtol=1e-14)
        np.testing.assert_array_equal(columns["n"], 2 + np.floor(4 * unit[:, 2]))
        assert set(columns["n"]) == {2, 3, 4, 5}


def test_a_longer_sobol_sequence_begins_with_the_shorter_one():
    np.testing.assert_array_equal(sobol(BOUNDS, 1000, 3).columns(0, 42)["y"], DESIGNS["sobol"].columns(0, 42)["y"])


def test_points_far_out_need_no_others():
    far = grid({"x": range(10_000), "y": range(10_000)}).columns(99_999_999, 100_000_000)
    assert (far["x"].item(), far["y"].item()) == (9999, 9999)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: grid({}), "at least one parameter"),
        (lambda: grid({"x": []}), "x needs at least one value"),
        (lambda: grid({"x": 3}), "x must be a list of values, not 3"),
        (lambda: listed({"x": [1, 2], "y": [1]}), r"as many values of each parameter, not \{'x': 2, 'y': 1\}"),
        (lambda: sobol({"x": (1, 0)}, 8), "x must lie between two numbers, the smaller one first, not 1 and 0"),
        (lambda: sobol({"x": 1}, 8), r"x must be \(low, high\) or \(low, high, scale\), not 1"),
        (lambda: sobol({"x": (0, 1, "log")}, 8), "x: bounds on a log scale must be greater than 0, not 0"),
        (lambda: sobol({"x": (0.5, 2, "whole")}, 8), "x: bounds of whole numbers must be whole"),
        (lambda: sobol({"x": (0, 1, "cubic")}, 8), "x: scale must be one of linear, log, whole, not 'cubic'"),
        (lambda: sobol({"x": (0, 1)}, 0), "from 1 to .* points, not 0"),
        (lambda: sobol({"x": (0, 1)}, 2**31), "samples of 1 parameters have at most"),
        (lambda: sobol({"x": (0, 1)}, 8, -1), "seed must be at least 0, not -1"),
        (lambda: latin_hypercube(BOUNDS, 10_000_000), "at most 5592405 points, not 10000000"),
        (lambda: grid([Axis("x", (1,), name="a"), Axis("y", (2,), name="a")]), "two parameters are called 'a'"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(make, sentence):
    with pytest.raises(StudyError, match=sentence):
        make()
