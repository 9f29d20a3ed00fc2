"""Every command of the README runs, in a folder where it leaves nothing outside of out/, which git ignores."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from softcradle.sandbox.cli.command_list import COMMANDS
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.stability import failure_scans, rigid_cradle

from tests.helpers.paths import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")
LINES = [line.partition("  #")[0].strip() for line in re.findall(r"^    (?=\S)(.+)$", README, re.MULTILINE)]
SHORTER = {  # the same commands on less: what is left out runs in the test of the command
    "figures": ["1b"],
    "maps": ["power-law", "--points", "4x3"],
    "chart": ["--ours"],
}
ELSEWHERE = {
    "mkdir -p out": "makes the folder",
    "make demo": "tests/sandbox/cli/test_commands.py and test_films.py run its commands",
    "make test": "runs this",
    "make docs": "tests/house/test_documentation.py",
    "make bench": "tests/house/test_benchmarks.py",
    "softcradle claims": "tests/sandbox/studies/claims/test_claims.py",
    "softcradle experiment": "tests/sandbox/studies/test_bed_experiment.py",
    'eval "$(softcradle completion bash)"': "tests/sandbox/cli/test_terminal.py",
}
TOUR = [line for line in LINES if line.startswith("softcradle") and line not in ELSEWHERE]


def test_every_line_is_known():
    commands = {command.name for command in COMMANDS}
    shell = [line for line in LINES if line.startswith(("softcradle", "make ", "mkdir", "eval"))]
    assert set(shell) - set(TOUR) == ELSEWHERE.keys()
    assert {line.split()[1] for line in TOUR if len(line.split()) > 1} <= commands
    assert len(TOUR) > 12


def test_what_runs_elsewhere_is_there():
    for place in ELSEWHERE.values():
        for file in re.findall(r"tests/\S+\.py", place):
            assert (ROOT / file).is_file()


def test_out_is_ignored_by_git():
    assert "out/" in (ROOT / ".gitignore").read_text(encoding="utf-8").splitlines()


def test_recipes_that_write_to_out_make_it_first():
    """A command refuses a folder that is not there."""
    recipes = re.findall(r"^\w[\w-]*:.*\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    writing = [recipe for recipe in recipes if "softcradle" in recipe and re.search(r"-o out/\w", recipe)]
    assert len(writing) >= 2
    assert [recipe for recipe in writing if not recipe.startswith("\t@mkdir -p out\n")] == []


@pytest.fixture
def quick(monkeypatch):
    """Short scans, and a window that closes at once."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.setattr("softcradle.sandbox.window.app.App.run", lambda app: app.close())
    scan = next(scan for scan in failure_scans.SCANS if scan.name == "alpha")
    short = failure_scans.Scan("alpha", scan.label, (0.1, 1.0), scan.chain)
    monkeypatch.setattr(failure_scans, "SCANS", (short,))
    monkeypatch.setattr(failure_scans, "STEPS", (0.01, 0.3))
    monkeypatch.setattr(failure_scans, "TOLERANCES", (1e-3, 1e-2))
    monkeypatch.setattr(rigid_cradle, "STEPS", (1 / 60,))


@pytest.mark.slow
@pytest.mark.usefixtures("quick", "own_folder")
@pytest.mark.parametrize("line", TOUR)
def test_a_command_of_the_readme_runs(line, tmp_path, capsys):
    Path("out").mkdir()
    Path("out/mine.toml").write_text(
        (ROOT / "scenes/catalogue/mixed.toml").read_text(encoding="utf-8"), encoding="utf-8"
    )
    command, _, printed_to = line.partition(" > ")
    arguments = shlex.split(command)[1:]
    assert main([*arguments, *SHORTER.get((arguments or [""])[0], [])]) == 0
    if printed_to:
        assert capsys.readouterr().out == Path("out/mine.toml").read_text(encoding="utf-8")
        assert printed_to.startswith("out/")
    assert {path.name for path in tmp_path.iterdir()} - {"cache"} == {"out"}
