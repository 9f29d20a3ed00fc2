"""The command at a terminal: narrow ones, poor encodings, a full disk, no display; options that all commands have."""

import csv
import io
import os
import re
import subprocess
import sys

import pytest
from rich.console import Console
from softcradle.physics import Trajectory
from softcradle.sandbox import console
from softcradle.sandbox.cli.commands.run import print_report
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.console import set_quiet
from softcradle.sandbox.scene_runs import load_scene, run_scene
from softcradle.sandbox.trajectory_summary import summarise

from tests.helpers.own_process import python

SOFTWARE_DISPLAY = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER", "SDL_VIDEO_DRIVER")


def run(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    kept = {key: value for key, value in os.environ.items() if key not in SOFTWARE_DISPLAY}
    return python("-m", "softcradle", *arguments, check=False, env=kept | {"PYTHONUTF8": "0"} | environment)


@pytest.fixture
def loud():
    yield
    set_quiet(False)


@pytest.mark.parametrize("width", [30, 38, 39, 40, 41, 60, 80, 100])
def test_no_number_of_a_run_is_lost(width, monkeypatch):
    scene = load_scene("one-on-four")
    summary = summarise("lane", run_scene(scene, method="verlet", step=1e-2)[0])
    numbers = [f"{bead.final_velocity:.8f}" for bead in summary.beads]
    numbers += [f"{contact.largest_force:.6g}" for contact in summary.contacts]
    for terminal in (True, False):
        output = Console(file=io.StringIO(), width=width, force_terminal=terminal, color_system=None, markup=False)
        monkeypatch.setattr("softcradle.sandbox.cli.commands.run.console", lambda output=output: output)
        print_report(scene, [summary])
        text = output.file.getvalue()
        assert "…" not in text
        assert [number for number in numbers if number not in text] == []
        if terminal:
            assert max(map(len, text.splitlines())) <= width
            assert "final velocity [m/s]" in " ".join(text.split()) or text.count("[m/s]") == 2
        else:  # a pipe has rows of the table as wide as they are
            assert any({"1.00000000", numbers[0]} <= set(line.split()) for line in text.splitlines())


def test_progress_in_a_file_is_a_line_now_and_then(monkeypatch, capsys):
    monkeypatch.setattr(console, "LINE_AFTER", 0.0)
    with console.ProgressShown("cases") as progress:
        progress.tell("points", 100, 2000)
        progress.tell("points", 135, 2000)
        told = ""
        while "135 of 2000" not in told:
            told += capsys.readouterr().err
    told += capsys.readouterr().err  # no line comes after the end
    assert all(line.startswith("softcradle: cases: ") for line in told.splitlines())
    assert progress.line(70.0) == "cases: 135 of 2000, after 1 min, 0.5 a second, about 1.0 h left"


@pytest.mark.usefixtures("loud")
def test_a_film_shows_how_far_it_is_unless_it_is_to_be_quiet(tmp_path, monkeypatch, softcradle):
    monkeypatch.setattr(console, "LINE_AFTER", 0.0)
    film = ["render", "one-on-four", "-o", str(tmp_path / "film.gif")]
    film += ["--size", "320x180", "--fps", "5", "--slow", "0.5"]
    told = re.findall(r"frames: (\d+) of (\d+)", softcradle(*film).err)
    assert told
    assert all(int(done) <= int(count) for done, count in told)  # also of a film that draws again what stays
    assert softcradle(*film, "-q").err == ""


@pytest.mark.parametrize("encoding", ["cp1252", "ascii", "latin-1"])
def test_a_poor_encoding_is_no_error(encoding):
    program = (
        "from softcradle.sandbox.cli.main import use_plain_characters\nuse_plain_characters()\n"
        "print('v\\u2080 \\u22120.5 4\\u00b710\\u207b\\u2075 m/s\\u00b2 \\u2713 \\u03b1 \\u4e2d \\u2026')"
    )
    text = python("-c", program, encoding=encoding, PYTHONIOENCODING=encoding).stdout
    assert text.startswith("v0 -0.5 4")
    assert "10-5 m/s" in text
    assert "alpha ?" in text


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no /dev/full")
@pytest.mark.parametrize("arguments", ["scenes", "check mixed", "--help", "-V"])
def test_a_full_disk_behind_standard_output(arguments):
    command = [sys.executable, "-m", "softcradle", *arguments.split()]
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.stderr == "softcradle: cannot write to standard output: no space left on device\n"
    assert done.returncode == 2


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("play", "one-on-four"), "there is no display"),
        (("play", "nosuch.toml"), "softcradle: there is no file nosuch.toml"),  # the scene is what is told
        (("play", "x.npz"), "softcradle: there is no file x.npz"),
    ],
)
def test_without_a_display_the_window_is_refused_at_once(arguments, sentence):
    done = run(*arguments)
    assert done.returncode == 2
    assert sentence in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.usefixtures("loud")
def test_a_second_file_is_written_too_and_each_lane_has_its_own_and_what_is_replaced_is_said(tmp_path, softcradle):
    paths = [tmp_path / "a.npz", tmp_path / "b.csv"]
    arguments = ["run", "galilean", "--method", "verlet", "--step", "1e-2", "--duration", "1.5", "--samples", "4"]
    arguments += [word for path in paths for word in ("-o", str(path))]
    for flags, written, replaced in (([], 4, 0), ([], 0, 4), (["-q"], 0, 0)):
        printed = softcradle(*arguments, *flags).out
        assert (printed.count("written: "), printed.count("replaced: ")) == (written, replaced)
        assert "final velocity" in printed
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a-1.npz", "a-2.npz", "b-1.csv", "b-2.csv"]
    trajectory = Trajectory.load(tmp_path / "a-2.npz")
    assert (trajectory.method, trajectory.time.shape) == ("verlet", (4,))
    assert trajectory.chain == load_scene("galilean").lanes[1].chain()
    with (tmp_path / "b-2.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["time [s]"]) for row in rows] == [0.0, 0.5, 1.0, 1.5]
    assert float(rows[0]["velocity 0 [m/s]"]) == 1.0


def test_open_shows_the_first_file(tmp_path, monkeypatch, softcradle):
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append(address) or True)
    path = tmp_path / "with a space.csv"
    command = ["run", "one-on-four", "--method", "verlet", "--step", "1e-2", "-o", str(path), "--open"]
    assert main(command) == main([*command, "--json"]) == 0
    assert opened == [path.as_uri()] * 2
    monkeypatch.setattr("webbrowser.open", lambda _: False)
    assert "no program was found to open it with" in softcradle(*command, code=2).err
    assert path.exists()


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("softcradle run one-on-f", ["one-on-four", "one-on-four-softer"]),
        ("softcradle run one-on-four --method y", ["yoshida4"]),
        ("softcradle render mixed --pix", ["--pixel-format"]),
    ],
)
def test_a_shell_completes(line, words, tmp_path):
    answer = tmp_path / "answer"
    asked = {"_ARGCOMPLETE": "1", "COMP_LINE": line, "COMP_POINT": str(len(line)), "_ARGCOMPLETE_IFS": "\n"}
    run(**asked, _ARGCOMPLETE_STDOUT_FILENAME=str(answer), _ARGCOMPLETE_SUPPRESS_SPACE="1")
    assert answer.read_text(encoding="utf-8").split() == words


def test_the_lines_for_a_shell_and_the_version(capsys, softcradle):
    for shell in ("bash", "zsh", "fish"):
        assert "softcradle" in softcradle("completion", shell).out
    for flag in ("-V", "--version"):
        with pytest.raises(SystemExit, match="0"):
            main([flag])
        assert capsys.readouterr().out.startswith("softcradle ")
