"""Every command of the README, and what it leaves to the help, runs, and leaves nothing outside of out/, which git ignores."""

import re
import shlex
from pathlib import Path

import pytest
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
ELSEWHERE = ("softcradle claims",)  # whole studies, which tests of their own run
FURTHER = (  # what `softcradle --help` lists beside
    "softcradle scenes",
    "softcradle methods",
    "softcradle render draft-gear-two-on-two -o out/x.kymograph.png",
    "softcradle compare draft-gear-one-on-three --match",
    "softcradle verify",
    "softcradle maps",
    "softcradle chart one-on-4",
    "softcradle stability",
    "softcradle scenes mixed > out/mine.toml",
    "softcradle check out/mine.toml",
    "softcradle play out/mine.toml",
)
TOUR = [*(line for line in LINES if line.startswith("softcradle") and line not in ELSEWHERE), *FURTHER]


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
