"""Tests of the command line: the help, the output and the files of each subcommand.

The tests also check narrow terminals, limited text encodings, a full disk and a computer without a display.
"""

import csv
import io
import json
import math
import os
import re
import subprocess
import sys
import warnings
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from rich.console import Console
from softcradle.physics import Chain, Trajectory, hertz, simulate
from softcradle.physics.fixed_step import runner
from softcradle.physics.methods import METHODS, known_methods
from softcradle.sandbox import console
from softcradle.sandbox.cli.commands.run import print_report
from softcradle.sandbox.cli.main import COMMANDS, main
from softcradle.sandbox.scene_runs import run_scene
from softcradle.sandbox.story.numbers import fixed
from softcradle.sandbox.story.sentences import describe
from softcradle.sandbox.trajectory_summary import bead_table, contact_table, summarise

from softcradle import scenes
from tests.helpers.own_process import python
from tests.helpers.paths import ROOT

FINAL = [-0.56758562, 0.17392147, 0.45407871, 0.46978361, 0.46980183]


@pytest.mark.parametrize("command", [command.name for command in COMMANDS])
def test_every_command_has_help_and_can_be_quiet(command, capsys):
    with pytest.raises(SystemExit, match="0"):
        main([command, "--help"])
    shown = capsys.readouterr().out
    assert f"usage: softcradle {command}" in shown
    assert "--quiet" in shown
    with pytest.raises(SystemExit, match="0"):
        main(["--help"])
    assert f"    {command} " in capsys.readouterr().out


def test_without_a_subcommand_the_window_opens(monkeypatch):
    monkeypatch.setattr("softcradle.sandbox.cli.commands.play.main", lambda args: args.scene)
    assert main([]) is None
    assert main(["play", "one-on-four"]) == "one-on-four"


@pytest.mark.parametrize("words", ["scenes mixed", "methods"])
def test_a_closed_pipe_is_no_error(words):
    shell = f"{sys.executable} -m softcradle {words} | true; exit ${{PIPESTATUS[0]}}"
    result = subprocess.run(["bash", "-c", shell], capture_output=True, text=True, check=False)
    assert result.stderr == ""
    # The exit code is 0 if the command wrote all its output before the reader closed the pipe.
    assert result.returncode in (0, 141)


def test_methods_and_scenes_are_listed(softcradle):
    text = softcradle("methods").out
    assert all(name in text for name in known_methods())
    listed = json.loads(softcradle("methods", "--json").out)
    assert [method["name"] for method in listed] == known_methods()
    assert [method["purpose"] for method in listed[1:]] == [method.purpose for method in METHODS]
    out = softcradle("scenes").out
    for name in scenes.names():
        assert name in out
        # A long title is wrapped in the table. Each word of the title is therefore searched separately.
        assert all(word in out for word in scenes.load(name).title.split())
    found = json.loads(softcradle("scenes", "--json").out)
    assert [(one["name"], one["title"]) for one in found] == [
        (name, scenes.load(name).title) for name in scenes.names()
    ]
    assert scenes.parse(softcradle("scenes", "galilean").out) == scenes.load("galilean")
    assert json.loads(softcradle("scenes", "mixed", "--json").out)["title"] == scenes.load("mixed").title


def test_the_file_of_a_scene_is_printed_in_utf_8_whatever_the_encoding():
    command = ("-m", "softcradle", "scenes", "train-braking")
    text = python(*command, encoding="utf-8", PYTHONIOENCODING="cp1252").stdout
    assert text == scenes.text_of("train-braking")
    assert not text.isascii()


def test_run_prints_velocities_contacts_errors_and_cost(softcradle):
    out, err = softcradle("run", "one-on-four", "--method", "verlet", "--step", "1/2000")
    assert err == ""
    rows = {line.split()[0]: line.split() for line in out.splitlines() if line.strip()}
    assert float(rows["4"][3]) == pytest.approx(FINAL[4], abs=3e-3)
    struck = [float(rows["0-1"][column]) for column in (1, 2, 4, 5)]
    assert struck == pytest.approx([1.0, 2.80128, 0.44966, 0.92318], abs=1e-3)
    words = "One bead on four", "Fig. 1b", "energy error", "momentum error", "steps", "evaluations", "ms"
    assert [word for word in (*words, "verlet, step 0.0005 s") if word not in out] == []


def test_large_forces_have_a_unit_prefix(softcradle):
    """Check that a large force is printed as 1.33 MN, not as 1329350 N.

    Also check that momentum lost to friction with the ground is not reported as an error.
    """
    out = softcradle("run", "train-shunting").out
    assert "force [MN]" in out
    assert re.search(r"\b0-1 .* 1\.329\d* +0\.25\d* *$", out, re.MULTILINE)
    assert re.search(r"absorbed +\d{3}\.\d+ kJ by contacts, 8\.\d+ kJ by the bed", out)
    assert re.search(r"momentum error +not defined *$", out, re.MULTILINE)
    assert "pull [MN]" in out
    assert "pull [kN]" in softcradle("run", "train-starting").out
    assert "pull [" not in softcradle("run", "one-on-four").out


def test_the_motion_is_described_in_words(softcradle):
    said = softcradle("run", "one-on-four", "--describe").out
    assert "Bead 0 hit bead 1 at 1\u00a0s with 1\u00a0m/s." in said
    assert "Bead 1 moves right at 0.17\u00a0m/s. Beads 2 to 4 move right together at 0.46\u00a0m/s." in said
    assert softcradle("run", "galilean", "--describe").out.startswith("Who hits whom?\n")


def test_results_say_how_well_the_final_velocities_are_known(softcradle):
    results = json.loads(softcradle("run", "one-on-four", "--json", "--method", "accurate").out)
    (lane,) = results["lanes"]
    assert results["versions"]["softcradle"]
    assert lane["status"] == "separated"
    assert lane["energy_error"] < 1e-3
    assert lane["momentum_error"] < 1e-12
    assert lane["contacts"][0]["closed"] == pytest.approx(1.0, abs=1e-3)
    for bead, exact in zip(lane["beads"], FINAL, strict=True):
        # The expected velocities are known to eight digits.
        assert abs(bead["final_velocity"] - exact) < bead["velocity_error"] + 1e-8
        assert bead["velocity_error"] <= lane["velocity_error"] < 1e-6
    assert "velocity error" in softcradle("run", "one-on-four", "--method", "accurate").out
    (fixed,) = json.loads(softcradle("run", "one-on-four", "--json", "--method", "verlet").out)["lanes"]
    assert fixed["velocity_error"] is None
    assert "velocity error" not in softcradle("run", "one-on-four", "--method", "verlet").out


@pytest.mark.filterwarnings("always")
def test_a_warning_is_a_sentence(softcradle, monkeypatch):
    warned = partial(warnings.warn, "the step is too long", RuntimeWarning, stacklevel=1)
    monkeypatch.setattr("softcradle.sandbox.cli.commands.check.main", lambda _: warned() or 0)
    assert softcradle("check", "mixed").err == "softcradle: warning: the step is too long\n"


def test_errors_are_relative_to_the_start():
    found = simulate(scenes.load("one-on-four").lanes[0].chain(), [1.0, 0.0, 0.0, 0.0, 0.0], samples=2)
    slowed = replace(
        found, rate=found.rate * [[1.0], [0.5]], anchor=found.anchor * [[1.0, 1.0], [1.0, 0.5]],
        contact_intervals=(((0.1, 0.2), (0.9, math.inf)), (), (), ()),
    )  # fmt: skip
    fast = replace(found, final_velocity=1e308 * np.ones(5))  # The mean of these velocities overflows to infinity.
    assert describe("", fast) == "The motion by accurate did not stay finite: choose a smaller step."
    summary = summarise("lane", slowed)
    errors = summary.energy_error, summary.energy_error_at_end, summary.momentum_error
    assert errors == pytest.approx((0.75, 0.75, 0.5))
    first, second = summary.contacts[:2]
    assert (first.closed, first.opened, first.times, first.still_closed) == (0.1, 0.2, 2, True)
    assert (second.closed, second.opened, second.times, second.still_closed) == (None, None, 0, False)
    assert [row[2] for row in contact_table(summary).rows[:2]] == ["still closed", "never"]
    heavy = summarise("", simulate(Chain([1.2e6, math.inf], hertz(1.0)), [1.0, 0.0], duration=0.1))
    assert [row[1] for row in bead_table(heavy).rows] == ["1200000", "wall"]


@pytest.mark.parametrize("velocity", [[0.5, 0.0, -0.3], [0.0, 0.0, -0.3]], ids=["moving", "at rest"])
def test_work_of_a_moving_wall_is_no_error_of_energy(velocity):
    """Check the energy error of a chain of beads with a moving wall.

    The error is relative to the largest energy, because the energy at the start can be 0. The error is None if friction
    with the ground also takes momentum.
    """
    chain = Chain([1.0, 1.0, math.inf], hertz(30.0), gap=[0.1, 0.0])
    known = summarise("", simulate(chain, velocity, 2.0))
    assert max(known.energy_error, known.energy_error_at_end) < 1e-6
    unknown = summarise("", simulate(replace(chain, friction=0.01), velocity, 2.0))
    assert (unknown.energy_error, unknown.energy_error_at_end) == (None, None)


def test_a_run_that_gave_up_has_exit_code_3(softcradle, tmp_path, monkeypatch):
    monkeypatch.setattr(runner, "MOST_FIXED_STEPS", 1000)
    gives_up = ("--method", "verlet", "--step", "1e-12")  # The run stops after 1000 steps, long before the beads touch.
    out = " ".join(softcradle("run", "one-on-four", *gives_up, code=3).out.split())
    assert "velocity when it gave up" in out
    assert "final velocity" not in out
    assert "verlet gave up after" in out
    for output in ("film.mp4", "frames/", "x.kymograph.png"):
        err = softcradle("render", "one-on-four", *gives_up, "-o", f"{tmp_path}/{output}", code=3).err
        assert "a film needs the whole motion: verlet gave up" in err
    assert list(tmp_path.iterdir()) == []
    said = softcradle("run", "one-on-four", *gives_up, "--json", "-o", str(tmp_path / "part.npz"), code=3).out
    assert json.loads(said)["lanes"][0]["gave_up"] is True
    assert (tmp_path / "part.npz").exists()
    softcradle("compare", "one-on-four", "--contact", "hertz(1)", *gives_up, "--json", code=3)


def test_a_run_that_is_not_finite_is_reported_in_every_output(tmp_path, softcradle):
    path = tmp_path / "stiff.toml"
    path.write_text(
        'title = "A bead between walls"\nduration = 100.0\n[[lanes]]\nmass = [inf, 1.0, inf]\n'
        'contact = {law = "hertz", stiffness = 1e6}\nvelocity = [0.0, 1.0, 0.0]\ngap = 1.0\n'
    )
    words = ("run", str(path), "--method", "euler", "--step", "1/2")
    out, err = softcradle(*words)
    assert err == ""
    assert "nan" not in out
    assert re.search(r"1 +1 +1\.00000000 +-", out)
    (lane,) = json.loads(softcradle(*words, "--json").out)["lanes"]
    assert [bead["final_velocity"] for bead in lane["beads"]] == [None, None, None]
    assert lane["contacts"][0]["largest_force"] is None
    said = softcradle(*words, "--describe").out
    assert said == "A bead between walls.\nThe motion by euler did not stay finite: choose a smaller step.\n"


@pytest.mark.parametrize("width", [30, 38, 39, 40, 41, 60, 80, 100])
def test_no_number_of_a_run_is_lost(width, monkeypatch):
    scene = scenes.load("one-on-four")
    summary = summarise("lane", run_scene(scene, method="verlet", step=1e-2)[0])
    numbers = [fixed(bead.final_velocity, 8) for bead in summary.beads]
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
        else:  # If the output is a pipe, a table row can be wider than the terminal.
            assert any({"1.00000000", numbers[0]} <= set(line.split()) for line in text.splitlines())


def test_progress_in_a_file_is_a_line_now_and_then(monkeypatch, capsys):
    monkeypatch.setattr(console, "LINE_AFTER", 0.0)
    with console.ProgressShown("cases") as progress:
        progress.tell("points", 100, 2000)
        progress.tell("points", 135, 2000)
        told = ""
        while "135 of 2000" not in told:
            told += capsys.readouterr().err
    told += capsys.readouterr().err  # No progress line may be printed after the work has ended.
    assert all(line.startswith("softcradle: cases: ") for line in told.splitlines())
    assert progress.line(70.0) == "cases: 135 of 2000, after 1 min, 0.5 a second, about 1.0 h left"


def test_a_film_shows_how_far_it_is_unless_it_is_to_be_quiet(tmp_path, monkeypatch, softcradle):
    monkeypatch.setattr(console, "LINE_AFTER", 0.0)
    film = ["render", "one-on-four", "-o", str(tmp_path / "film.gif")]
    film += ["--size", "320x180", "--fps", "5", "--slow", "0.5"]
    told = re.findall(r"frames: (\d+) of (\d+)", softcradle(*film).err)
    assert told
    # The number of finished frames must not exceed the total, even if the film repeats a picture.
    assert all(int(done) <= int(count) for done, count in told)
    assert softcradle(*film, "-q").err == ""


@pytest.mark.parametrize("encoding", ["cp1252", "ascii"])
def test_a_poor_encoding_is_no_error(encoding):
    done = python("-m", "softcradle", "run", "one-on-four", encoding=encoding, PYTHONIOENCODING=encoding)
    assert "velocity" in done.stdout


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no /dev/full")
@pytest.mark.parametrize("arguments", ["scenes", "check mixed", "--help", "-V"])
def test_a_full_disk_behind_standard_output(arguments):
    command = [sys.executable, "-m", "softcradle", *arguments.split()]
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.stderr == "softcradle: cannot write to standard output: no space left on device\n"
    assert done.returncode == 2


@pytest.mark.skipif(os.name != "posix", reason="other systems have no bash")
@pytest.mark.parametrize(
    ("line", "code", "told"),
    [
        ("$0 -m softcradle check /dev/zero", 2, "cannot read /dev/zero: file too large"),
        (
            "mkdir x; cd x; rmdir ../x; $0 -m softcradle run mixed",
            2,
            "cannot write to the current folder: no such file",
        ),
    ],
)
def test_endless_files_and_missing_folders_are_handled(line, code, told, tmp_path):
    words, environment = ["bash", "-c", line, sys.executable], os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, told in done.stderr) == (code, True)


@pytest.mark.parametrize(
    ("scene", "lacks"),
    [
        ("mixed", "there is no display"),
        ("x.toml", "cannot find the file x.toml"),
        ("x.npz", "cannot find the file x.npz"),
    ],
)
def test_without_a_display_the_window_is_refused_at_once(scene, lacks):
    """Check that an invalid scene is reported before a missing display."""
    displays = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER", "SDL_VIDEO_DRIVER")
    kept = {key: value for key, value in os.environ.items() if key not in displays}
    done = python("-m", "softcradle", "play", scene, check=False, env=kept)
    assert done.returncode == 2
    assert re.fullmatch(rf"softcradle: .*{lacks}.*\n", done.stderr)


def test_several_files_are_written(tmp_path, softcradle):
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
    assert trajectory.chain == scenes.load("galilean").lanes[1].chain()
    rows = list(csv.DictReader((tmp_path / "b-2.csv").read_text(encoding="utf-8").splitlines()))
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
    asked |= {"_ARGCOMPLETE_STDOUT_FILENAME": str(answer), "_ARGCOMPLETE_SUPPRESS_SPACE": "1"}
    python("-m", "softcradle", check=False, **asked)
    assert answer.read_text(encoding="utf-8").split() == words


def test_the_lines_for_a_shell_and_the_version(capsys, softcradle):
    for shell in ("bash", "zsh", "fish"):
        assert "softcradle" in softcradle("completion", shell).out
    for flag in ("-V", "--version"):
        with pytest.raises(SystemExit, match="0"):
            main([flag])
        assert capsys.readouterr().out.startswith("softcradle ")
