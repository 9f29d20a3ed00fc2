"""The measure of branches: which lines are kernels, what counts, and that the tests it runs are there."""

from __future__ import annotations

import ast

import pytest

from benchmarks.branch_coverage import FOLDERS, TESTS, kernel_lines, report_of
from tests.helpers.paths import ROOT

SOURCE = """LIMIT = 1.0


@jit
def kernel(x):
    if x > LIMIT:
        return x
    return LIMIT


def made(function):
    return jit(function) if function else None
"""


def test_lines_of_decorated_functions_are_kernels():
    assert kernel_lines(SOURCE) == {5, 6, 7, 8}


def test_branches_outside_kernels_do_not_count():
    name = "physics/numerics/law_kernels.py"
    source = (ROOT / name).read_text(encoding="utf-8")
    line = next(k for k, text in enumerate(source.splitlines(), 1) if "if exponent == 1.0:" in text)
    branches = {"executed_branches": [[line, line + 1], [1, 2]], "missing_branches": [[line, line + 2], [2, -1]]}
    report = report_of({"files": {name: branches}})
    assert report.data["percent"] == 50.0
    assert report.rows[0] == [f"`{name}`", "2", "1", "50 %", f"{line}-{line + 2}"]
    assert report.rows[-1][:3] == ["all", "2", "1"]


@pytest.mark.parametrize("test", TESTS)
def test_tests_of_the_measure_exist(test):
    file, _, name = test.partition("::")
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    assert not name or name.split("[")[0] in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


def test_every_folder_has_kernels():
    for folder in FOLDERS:
        assert any(kernel_lines(file.read_text(encoding="utf-8")) for file in (ROOT / folder).glob("*.py"))
