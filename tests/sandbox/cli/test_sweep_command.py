"""Tests of the command `softcradle sweep`. The tests cover study files, error messages, missing points and points that
were computed earlier.
"""

import re
from unittest.mock import Mock

import pytest
from softcradle.sandbox.sweeps import run_sweep
from softcradle.sandbox.sweeps.measure_table import MEASURES
from softcradle.sandbox.sweeps.study_file import load_study
from softcradle.sandbox.sweeps.work import Work, lost
from softcradle.sandbox.user_error import POINTS_LOST

from tests.helpers.paths import ROOT

xr = pytest.importorskip("xarray")
GOOD = """
title = "two speeds"
scene = "one-on-four"
measures = ["final_velocity", "rigidity"]
[set]
"lanes.0.contact.alpha" = 1
tolerance = 1e-4
[grid]
"lanes.0.velocity.0" = {values = [0.5, 1], name = "speed"}
"""
SOBOL = """
[sobol]
count = 8
[sobol.over]
"lanes.0.contact.alpha" = {between = ["1/10", 1], scale = "log"}
"""


def changed(old: str, new: str) -> str:
    assert old in GOOD
    return GOOD.replace(old, new)


GRID, VALUES = GOOD.partition("[grid]")[2], "values = [0.5, 1]"


@pytest.fixture
def swept(tmp_path, softcradle):
    def run(*words, text=GOOD, code=0):
        # Some text editors write a byte order mark at the beginning of a file.
        (tmp_path / "study.toml").write_text(text, encoding="utf-8-sig")
        return softcradle("sweep", f"{tmp_path}/study.toml", "-o", f"{tmp_path}/found.nc", *words, code=code)

    return run


def test_a_study_is_computed_once_and_says_how_far_it_is(tmp_path, swept, monkeypatch, softcradle, refused):
    output = tmp_path / "found.nc"
    assert swept("--status").out == "two speeds: not begun, none of 2 points is computed\n"
    monkeypatch.setattr(run_sweep, "write_dataset", Mock(side_effect=KeyboardInterrupt))
    swept("--workers", "1", code=130)
    told = f"2 of 2 points are in {output}.partial, and no sweep is at it, the same command goes on\n"
    assert swept("--status").out == f"two speeds: {told}"
    monkeypatch.undo()
    printed = swept("-q", "--workers", "1").out
    assert "two speeds: 2 speed" in printed
    assert "final_velocity [m/s]" in printed
    assert swept("--status").out == f"two speeds: complete, 2 points are in {output}\n"
    monkeypatch.chdir(tmp_path)
    assert "not begun" in softcradle("sweep", "study.toml", "--status").out
    assert "must end in .zarr or .nc" in refused("sweep", "study.toml", "--status", "-o", ".")
    with xr.open_dataset(output, engine="h5netcdf") as found:
        assert found["final_velocity"].dims == ("speed", "bead")
        assert found["final_velocity"].sum("bead").values == pytest.approx(found["speed"].values)
    changed_at = output.stat().st_mtime_ns
    told = f"complete, 2 points are in {output}\n"
    assert swept().out == printed + told
    assert output.stat().st_mtime_ns == changed_at
    assert sorted(path.name for path in tmp_path.iterdir()) == ["found.nc", "study.toml"]
    other = changed(VALUES, "values = [0.5, 2]")
    for words in (), ("--status",):
        assert "holds another study" in swept(*words, text=other, code=2).err


def test_lost_points_have_an_exit_code(monkeypatch, swept):
    monkeypatch.setattr(Work, "compute", lambda work, begin, end, _: lost(begin, 3))
    told = "2 points without numbers: the process that computed it died, 3 times"
    assert told in swept("--workers", "1", code=POINTS_LOST).out
    assert "2 of them lost" in swept("--status", code=POINTS_LOST).out


def test_beads_that_smaller_targets_lack_are_no_missing_numbers(swept):
    printed = swept("--workers", "1", text=GOOD.replace(GRID, '\n"lanes.0.beads.1" = [2, 3]')).out
    (row,) = [line.split() for line in printed.splitlines() if "final_velocity" in line]
    assert row[-1] == "0"


def test_samples_of_a_file_and_the_example(tmp_path):
    (tmp_path / "study.toml").write_text(GOOD.partition("[set]")[0] + SOBOL)
    points = load_study(str(tmp_path / "study.toml")).points
    assert (points.design, points.count, points.axes[0].low) == ("sobol", 8, 0.1)
    example = load_study(str(ROOT / "examples" / "softness-and-size.toml"))
    assert (example.points.shape, example.scene.tolerance) == ((24, 5), 1e-6)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (changed("[grid]", "[gird]"), r"unknown key 'gird' \(did you mean 'grid'\?\)"),
        (changed("[grid]" + GRID, ""), "needs one of the tables grid, list, sobol, latin_hypercube, not 0"),
        (GOOD + SOBOL, "needs one of the tables grid, list, sobol, latin_hypercube, not 2"),
        (changed(VALUES, "between = [1, 0.5]"), r"study.toml: lanes.0.velocity.0 must lie .* 1 and 0.5"),
        (changed(VALUES, "between = [0.5, 1]"), "count is missing"),
        (changed(VALUES, f"between = [0, 1], count = {10**15}"), r"velocity.0 has at most 16777216 values, not 10+"),
        (changed(VALUES, 'between = [1, 1e15], scale = "whole"'), r"velocity.0 has at most 16777216 values, not 10+"),
        (changed(VALUES, f"between = [1, {10**400}], count = 2"), r"two numbers of at most 1e\+30, .*, not 1 and 10+"),
        (
            changed(VALUES, f"values = [1, {10**23}]"),
            "whole numbers must be from -9007199254740992 to 9007199254740992",
        ),
        (changed(VALUES, 'between = [2, 20], scale = "whole", count = 4'), r"velocity.0.*: .* leave out count"),
        (changed(VALUES, f'{VALUES}, scale = "log"'), r"velocity.0.*: scale is allowed .*, not beside values"),
        (changed(VALUES, "values = [1, nan]"), r"velocity.0.values\[1\] must be a finite number, not nan"),
        (changed(VALUES, "values = [1, true]"), r"velocity.0.values\[1\] must be a whole number, not True"),
        (changed(VALUES, 'between = [0, "x"], count = 2'), r"velocity.0.between\[1\] must be a number, not 'x'"),
        (changed(VALUES, "values = []"), r"needs either values = \[...\] or between"),
        (changed('"rigidity"', '"rigid"'), "there is no measure 'rigid'"),
        (changed("one-on-four", "one\\u0000.toml"), r"study.toml: cannot find the file 'one\\x00.toml'"),
        (changed("one-on-four", "o" * 300 + ".toml"), r"study.toml: cannot read o+.toml: "),
        (changed('contact.alpha" = 1', 'contact.alpha" = -1'), r"contact.alpha must be greater than 0, not -1"),
        (changed('scene = "one-on-four"', ""), "key 'scene' is missing"),
        ("title = ", "not valid TOML"),
    ],
)
def test_bad_study_file(text, sentence, tmp_path, refused):
    (tmp_path / "study.toml").write_text(text)
    assert re.search(sentence, refused("sweep", f"{tmp_path}/study.toml", "-o", f"{tmp_path}/found.nc"))
    assert [path.name for path in tmp_path.iterdir()] == ["study.toml"]


def test_measures_are_listed(softcradle):
    printed = softcradle("sweep", "--measures").out
    assert all(measure.name in printed for measure in MEASURES)
