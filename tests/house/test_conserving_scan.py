"""The scan of `conserving`: a part of it in every run of the tests."""

from dataclasses import replace

import pytest

from benchmarks import __main__ as command
from benchmarks.conserving_scan import FAMILIES, LARGE, error_report, errors, report, run

pytestmark = pytest.mark.slow

COUNT = 30 * len(FAMILIES)


@pytest.fixture(scope="module")
def found():
    return [run(number) for number in range(COUNT)]


def test_every_step_converges_and_conserves(found):
    assert not [one for one in found if one.unconverged or one.gave_up]
    assert max(one.momentum for one in found) < 1e-9
    assert max(one.energy for one in found) < 1e-9
    assert sum(one.steps for one in found) > 100 * COUNT


def test_the_table_names_the_seeds_that_fail(found):
    failed = replace(found[3], unconverged=True)
    table = report([failed, *found[:20]])
    row = next(row for row in table.rows if row[0] == failed.family)
    assert row[3] == "1"
    assert row[-1] == str(failed.seed)
    assert table.rows[-1][:2] == ["all", "21"]


def test_errors_beyond_a_thousandth_are_warned_of():
    """But one in hundreds, at four times the default step."""
    found = [one for number in range(40) for one in errors(number)]
    assert [one for one in found if one.error > LARGE and not one.warned] == []
    table = error_report(found)
    assert sum(int(row[2]) for row in table.rows) == len(found)


def test_the_command_writes_its_table(tmp_path, capsys):
    assert command.main(["conserving", "--count", "10", "--jobs", "1", "--markdown", str(tmp_path / "table.md")]) == 0
    assert "| all | 10 |" in (tmp_path / "table.md").read_text()
