"""Tests of the function `fit`, which fits parameters of a chain to measured data.

The tests check fitted values and error bars, parameters that the data cannot determine, the columns of the data, and
the command.
"""

import json
import math
import re

import numpy as np
import pytest
from softcradle.sandbox.studies.fitting.determined import determine, not_random
from softcradle.sandbox.studies.fitting.fit_scene import shown_value
from softcradle.sandbox.studies.fitting.observations import observations, table_from
from softcradle.sandbox.studies.fitting.parameters import FreeValue, scene_values
from softcradle.sandbox.user_error import StudyError

from benchmarks import fit as coverage
from softcradle import Chain, draft_gear, fit, hertz, hooke, scenes, simulate


def scene_of(chain, velocity, **settings):
    return scenes.Scene(title="a test", lanes=[scenes.Lane.of(chain, velocity)], **settings)


def noisy(chain, velocity, duration, count, level, quantities=("velocity",), seed=1):
    """Return samples of a simulated motion with added normal noise. The standard deviation of the noise is `level`."""
    draw = np.random.default_rng(seed)
    time = np.linspace(0.0, duration, count)
    run = simulate(chain, velocity, duration, samples=time, tolerance=1e-10)
    data = {"time": time}
    for quantity in quantities:
        values = getattr(run, quantity)
        data |= {f"{quantity} {k}": values[:, k] + level * draw.normal(size=count) for k in range(values.shape[1])}
    return data


def test_error_bars_hold_the_truth_and_scale_with_the_noise():
    truth = Chain([0.2, 0.3, 0.25], hertz(200.0, loss=0.4), gap=[0.02, 0.03])
    start = scene_of(Chain([0.2, 0.2, 0.25], hertz(120.0, loss=0.1), gap=[0.02, 0.03]), [1.0, 0.0, 0.0])
    free = ["lanes.0.contact.loss", "lanes.0.contact.stiffness", "lanes.0.mass[1]"]
    coarse, fine = (fit(start, noisy(truth, [1.0, 0.0, 0.0], 1.0, 200, level), free) for level in (1e-2, 1e-4))
    for found, level in ((coarse, 1e-2), (fine, 1e-4)):
        assert found.determined.all()
        assert (np.abs(found.values - [0.4, 200.0, 0.3]) < 3.0 * found.errors).all()
        assert found.noise["velocity"] == pytest.approx(level, rel=0.1)
        assert found.restitution["lanes.0.contact.loss"][0] == pytest.approx(math.sqrt(0.6), rel=0.05)
    assert coarse.errors / fine.errors == pytest.approx([100.0] * 3, rel=0.2)
    assert fine.scene.lanes[0].mass[1] == pytest.approx(fine.values[2], abs=1e-2 * fine.errors[2])
    assert fine.scene.lanes[0].contact.loss == pytest.approx(0.4, abs=1e-3)


def test_the_covariance_is_that_of_a_linear_problem():
    """Compare the fit of a straight line with its closed form: the errors of both coefficients and their correlation."""
    x = np.linspace(0.0, 1.0, 50)
    free = [FreeValue(name, name, 1.0, -math.inf, math.inf, 1.0, False) for name in ("a", "b")]
    found = determine(free, np.zeros(2), np.stack([np.ones(50), x], axis=1), 0.04, 0.0)
    spread = float(np.sum((x - x.mean()) ** 2))
    assert found.errors[1] == pytest.approx(0.2 / math.sqrt(spread))
    assert found.errors[0] == pytest.approx(0.2 * math.sqrt(1.0 / 50.0 + x.mean() ** 2 / spread))
    assert found.correlation[0, 1] == pytest.approx(-x.mean() / math.sqrt(np.mean(x**2)))


def test_random_cases_of_all_contacts_are_covered():
    """Fit the first random cases of the benchmark and check their error bars.

    With 24 cases, error bars that are wrong by a factor of 2 would exceed the bound of this test.
    """
    cases = [coverage.case_of(number, 1).solve() for number in range(24)]
    report = coverage.summary(cases)
    assert report.data["values"] > 35
    assert report.data["share"] >= 0.85
    assert 0.7 < report.data["spread"] < 1.4
    assert report.data["reported"] == report.data["hidden"] == 3


def test_what_the_data_cannot_determine_is_said():
    truth = Chain([0.2, 0.3], hooke(1e7, loss=0.36), gap=0.1)
    data = noisy(truth, [1.0, 0.0], 1.0, 30, 1e-3, ("position",))
    start = scene_of(Chain([0.2, 0.3], hooke(2e6, loss=0.1), gap=0.1), [1.0, 0.0])
    found = fit(start, data, ["lanes.0.contact.stiffness", "lanes.0.contact.loss"])
    assert found.determined.tolist() == [False, True]
    assert any("lanes.0.contact.stiffness" in sentence and "determine" in sentence for sentence in found.statements)
    # The positions depend only on the ratios of the masses and the stiffness, so these three values cannot be
    # determined separately.
    data = noisy(Chain([0.2, 0.3], hooke(500.0), gap=0.05), [1.0, 0.0], 0.5, 100, 1e-4, ("position",))
    start = scene_of(Chain([0.2, 0.25], hooke(400.0), gap=0.05), [1.0, 0.0])
    found = fit(start, data, ["lanes.0.mass[:]", "lanes.0.contact.stiffness"])
    assert not found.determined.any()
    together = "only a combination of lanes.0.mass.0 and lanes.0.mass.1 and lanes.0.contact.stiffness"
    assert together in " ".join(found.statements)
    # The true mass is outside the given bounds, so the fit ends at a bound.
    found = fit(start, data, ["lanes.0.mass[1]=0.21..0.28"])
    assert not found.determined[0]
    assert found.statements[0] == (
        "lanes.0.mass.1 is at its bound, 0.28: the data do not determine it between the bounds"
    )


def test_start_offset_and_marker_names():
    """Fit positions whose origins and start time are unknown. The columns are sorted from left to right."""
    truth = Chain([0.2, 0.3], hooke(300.0, loss=0.36))
    time = np.arange(0.0, 1.5, 0.005)
    run = simulate(truth, [0.3, -0.2], 1.0, samples=np.clip(time - 0.7, 0.0, 1.0))
    early = np.minimum(time - 0.7, 0.0)[:, None] * [0.3, -0.2]
    place = run.position + early + [0.25, 0.31] + 1e-4 * np.random.default_rng(3).normal(size=(time.size, 2))
    data = {"time": time, "right x (m)": place[:, 1], "left x (m)": place[:, 0]}
    start = scene_of(Chain([0.2, 0.3], hooke(1000.0, loss=0.1)), [0.1, -0.1])
    free = ["start", "offset", "lanes.0.velocity[:]", "lanes.0.contact.loss", "lanes.0.contact.stiffness"]
    lost = fit(start, {name: data[name] for name in ("time", "right x (m)", "left x (m)")}, free[2:])
    assert any("--free offset" in sentence for sentence in lost.statements)
    found = fit(start, data, free, window=0.3, starts=2)
    assert found.names[-2:] == ("offset of left x", "offset of right x")
    assert found.starts == 2
    truths = [0.3, -0.2, 0.36, 300.0, 0.7, 0.25, 0.31]
    assert (np.abs(found.values - truths) < 3.5 * found.errors).all()
    assert found.time[[0, -1]] == pytest.approx([0.4, 1.0], abs=0.01)
    assert found.noise["position"] == pytest.approx(1e-4, rel=0.15)


def test_forces_and_positions_get_their_own_weights():
    truth = Chain([0.2, 0.3], draft_gear(500.0, 0.005, loss=0.3), gap=0.05)
    data = noisy(truth, [1.0, 0.0], 0.4, 200, 1e-4, ("position",))
    data |= {"force": noisy(truth, [1.0, 0.0], 0.4, 200, 0.5, ("force",), seed=2)["force 0"]}
    start = scene_of(Chain([0.2, 0.3], draft_gear(400.0, 0.005, loss=0.2), gap=0.05), [1.0, 0.0])
    found = fit(start, data, ["lanes.0.contact.stiffness", "lanes.0.contact.loss"])
    assert found.noise == pytest.approx({"position": 1e-4, "force": 0.5}, rel=0.15)
    assert (np.abs(found.values - [500.0, 0.3]) < 3.0 * found.errors).all()


CHAIN = Chain([1.0, 1.0, math.inf], hooke(1.0))


@pytest.mark.parametrize(
    ("names", "places"),
    [
        (("v0", "v2"), [0, 2]),
        (("v1", "v2", "v3"), [0, 1, 2]),
        (("velocity 1", "velocity 0"), [0, 1]),
        (("left x (mm)", "right x (mm)"), [0, 1]),  # The position of the wall is not measured.
    ],
)
def test_columns_belong_to_beads(names, places):
    time = np.linspace(0.0, 1.0, 5)
    table = table_from({"t": time} | dict.fromkeys(names, time))
    assert [one.index for one in observations(table, CHAIN)] == places


@pytest.mark.parametrize(
    ("free", "message"),
    [
        (["lanes.0.contact.lss"], r"there is no 'lss' \(did you mean 'loss'\?\)"),
        (["lanes.0.mass"], r"lanes.0.mass: is a list: write lanes.0.mass\[0\]"),
        (["lanes.0.mass[3]"], "'3' must be a number from 0 to 2"),
        (["lanes.0.mass[2]"], "a wall cannot be a free value"),
        (["lanes.0.label"], "must be a number of the scene, not ''"),
        (["lanes.0.mass[0]=1"], "bounds must be LOW..HIGH, such as lanes.0.mass.0=0.1..0.5, not '1'"),
        (["lanes.0.mass[0]=2..1"], "two finite numbers, the lower one first"),
        (["lanes.0.contact.loss=-1..0.5"], "bounds must be 0 or more, and at most 1, not -1..0.5"),
        (["lanes.0.mass[0]", "lanes.0.mass.0"], "lanes.0.mass.0 is given twice"),
        (["offset"], "offset needs data with positions"),
        ([], "free must be a list of at least one path"),
    ],
)
def test_wrong_free_values_are_refused(free, message):
    scene = scene_of(CHAIN, [1.0, 0.0, 0.0], duration=1.0)
    with pytest.raises(StudyError, match=message):
        fit(scene, {"t": np.arange(9.0), "v0": np.zeros(9)}, free)


def test_limits_of_values_come_from_the_schema():
    gear = scene_of(Chain([1.0, 1.0], draft_gear(2.0, 0.1, loss=0.5)), [1.0, 0.0])
    paths = ["lanes.0.contact.loss", "lanes.0.contact.precompression", "lanes.0.mass[*]", "lanes.0.velocity[1]"]
    loss, gear_at_rest, mass, speed = scene_values(gear, paths, 0, 1.0)
    assert (loss.low, loss.high) == (0.0, math.nextafter(1.0, 0.0))
    assert (gear_at_rest.low, gear_at_rest.high) == (0.0, math.inf)
    assert mass.logarithmic
    assert (speed.low, speed.high) == (-math.inf, math.inf)
    power = scene_of(Chain([1.0, 1.0], hooke(2.0)), [1.0, 0.0])
    assert len(scene_values(power, ["lanes.0.mass[:]"], 0, 1.0)) == 2


def test_random_residuals_are_told_from_others():
    draw, which = np.random.default_rng(5), np.repeat([0, 1], 300)
    assert not not_random(draw.normal(size=600), which)
    assert not_random(np.sin(np.linspace(0.0, 9.0, 600)) + 0.5 * draw.normal(size=600), which)


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [(0.3612, 0.0123, "0.361 ± 0.012"), (1234.5, 56.7, "1234 ± 57"), (2.0, math.inf, "2"), (0.5, math.nan, "0.5")],
)
def test_values_have_two_digits_of_their_error(value, error, text):
    assert shown_value(value, error) == text


QUALISYS = """NO_OF_FRAMES\t{frames}
NO_OF_CAMERAS\t2
NO_OF_MARKERS\t2
FREQUENCY\t200
DATA_INCLUDED\t3D
MARKER_NAMES\tNew 0000\tNew 0001
"""


@pytest.fixture
def gliders(tmp_path):
    """Write two synthetic recordings of gliders in the export format of Qualisys, and the scene file."""
    truth = Chain([0.2, 0.3], hooke(300.0, loss=0.36))
    paths = []
    for number, speeds in enumerate(([0.3, -0.2], [0.4, 0.0])):
        time = np.arange(240) / 200.0
        run = simulate(truth, speeds, 1.0, samples=np.clip(time - 0.5, 0.0, 1.0))
        place = run.position + np.minimum(time - 0.5, 0.0)[:, None] * speeds + [0.25, 0.31]
        place += 1e-4 * np.random.default_rng(number).normal(size=place.shape)
        rows = [f"{1e3 * a:.3f}\t457.0\t397.7\t{1e3 * b:.3f}\t496.4\t399.3" for a, b in place.tolist()]
        paths.append(tmp_path / f"run {number}.tsv")
        paths[-1].write_text(QUALISYS.format(frames=240) + "\n".join(rows) + "\n", encoding="utf-8")
    scene = tmp_path / "gliders.toml"
    scene.write_text(scene_of(Chain([0.2, 0.3], hooke(1000.0, loss=0.1)), [0.1, -0.1]).to_toml(), encoding="utf-8")
    return str(scene), [str(path) for path in paths]


FREE = [f"--free={one}" for one in ("start", "offset", "lanes.0.velocity[:]", "lanes.0.contact.loss")]


def test_one_command_fits_several_recordings(softcradle, gliders, tmp_path):
    scene, data = gliders
    free = [*FREE, "--free=lanes.0.contact.stiffness"]
    shown = softcradle("fit", scene, *data, *free, "-o", str(tmp_path / "fitted.toml"), "--window", "0.3").out
    (scatter,) = re.findall(r"restitution of lanes.0.contact.loss +([\d.]+) +([\d.e-]+) +[\d.]+ +[\d.]+ *\n", shown)
    assert float(scatter[0]) == pytest.approx(0.8, abs=0.01)
    assert float(scatter[1]) < 0.02
    for number in (1, 2):
        fitted = scenes.load(str(tmp_path / f"fitted-{number}.toml"))
        assert fitted.lanes[0].contact.loss == pytest.approx(0.36, abs=0.03)


def test_the_command_writes_scene_figure_and_numbers(softcradle, gliders, tmp_path):
    pytest.importorskip("matplotlib")
    scene, data = gliders
    outputs = [tmp_path / f"found.{suffix}" for suffix in ("toml", "png", "svg", "json")]
    words = [word for path in outputs for word in ("-o", str(path))]
    printed = softcradle("fit", scene, data[0], *FREE, *words, "--json", "-q").out
    numbers = json.loads(printed)
    assert json.loads(outputs[3].read_text(encoding="utf-8")) == numbers
    assert set(numbers["values"]) == {
        "start", "offset of New 0000 X", "offset of New 0001 X", "lanes.0.velocity.0", "lanes.0.velocity.1",
        "lanes.0.contact.loss",
    }  # fmt: skip
    # The stiffness of the scene is wrong, so the residuals are not random and the fit reports this.
    assert numbers["statements"]
    assert all(path.stat().st_size > 100 for path in outputs)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "fit needs a table of measurements or a --goal, and not both"),
        (["DATA", "--goal", "least peak force"], "and not both"),
        (["DATA", "-o", "x.html"], "cannot write x.html: fit writes .toml, .json, .png, .pdf, .svg"),
        (["DATA", "-o", "nowhere/x.toml"], "nowhere does not exist"),
        (["DATA", "--column", "New 0000 X"], "--column must be NAME=PLACE"),
        (["DATA", "--column", "New 0009 X=position 0"], "there is no column 'New 0009 X'; it contains 'New 0000 X'"),
        (["DATA", "--column", "New 0000 X=position 4"], "position 4 does not exist; the numbers are 0 to 1"),
        (["DATA", "--quantity", "velocity"], "no column is a velocity; it contains"),
        (["DATA", "--from", "3"], "no data from 3 to inf s; its times are 0 to 1.195 s"),
        (["DATA", "--lane", "1"], "lane must be from 0 to 0, not 1"),
        (["no.csv"], "cannot read no.csv: no such file"),
        (["--goal", "least nonsense"], "there is no measure 'nonsense'"),
        (["--goal", "least peak force", "--from", "1"], "is for data, not for a --goal"),
        (["--goal", "least peak force of bead 1"], "peak_force is a measure of a contact, not of a bead"),
        (["--goal", "most momentum of bead 7"], "bead 7 does not exist; the numbers are 0 to 1"),
        (["--goal", "momentum"], "name the bead, such as 'momentum of bead 1'"),
        (["--goal", "least momentum of bead 1 = 3"], "exclude each other"),
        (["--goal", "least peak force"], "a design needs bounds, such as --free 'lanes.0.contact.loss=LOW..HIGH'"),
    ],
)
def test_wrong_words_are_one_sentence(refused, gliders, words, message):
    scene, data = gliders
    given = [data[0] if word == "DATA" else word for word in words]
    assert message in refused("fit", scene, *given, "--free", "lanes.0.contact.loss")


def test_a_fit_needs_a_free_value(refused, gliders):
    assert "no free value is given" in refused("fit", gliders[0], gliders[1][0])
