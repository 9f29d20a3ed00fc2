"""The command: its help, and what its subcommands print and write."""

import json
import re
import subprocess
import sys
import warnings

import numpy as np
import pytest
from softcradle.physics import Trajectory
from softcradle.physics.fixed_step import runner
from softcradle.physics.methods import METHODS, known_methods
from softcradle.sandbox.cli.main import COMMANDS, main
from softcradle.sandbox.trajectory_summary import contact_table, summarise

from softcradle import scenes

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
    opened = []
    monkeypatch.setattr("softcradle.sandbox.cli.commands.play.main", lambda args: opened.append(args.scene) or 0)
    assert main([]) == 0
    assert main(["play", "one-on-four"]) == 0
    assert opened == [None, "one-on-four"]


def test_a_closed_pipe_is_no_error():
    shell = f"{sys.executable} -m softcradle scenes mixed | true; exit ${{PIPESTATUS[0]}}"
    result = subprocess.run(["bash", "-c", shell], capture_output=True, text=True, check=False)
    assert result.stderr == ""


def test_scenes_are_listed_printed_to_start_from_and_checked(softcradle):
    out = softcradle("scenes").out
    for name in scenes.names():
        assert name in out
        assert scenes.load(name).title in out
    assert [scene["name"] for scene in json.loads(softcradle("scenes", "--json").out)] == [*scenes.names()]
    assert scenes.parse(softcradle("scenes", "galilean").out) == scenes.load("galilean")
    assert json.loads(softcradle("scenes", "mixed", "--json").out)["title"] == scenes.load("mixed").title
    assert softcradle("check", "galilean").out == "galilean: ok, 'Who hits whom?' with 5 and 5 beads\n"


def test_methods_are_listed_with_what_they_are_for(softcradle):
    text = softcradle("methods").out
    assert all(name in text for name in known_methods())
    listed = json.loads(softcradle("methods", "--json").out)
    assert [method["name"] for method in listed] == known_methods()
    assert [method["purpose"] for method in listed[1:]] == [method.purpose for method in METHODS]


def test_run_prints_velocities_contacts_errors_and_cost(softcradle):
    out, err = softcradle("run", "one-on-four", "--method", "verlet", "--step", "1/2000")
    assert err == ""
    assert "One bead on four" in out
    assert "Fig. 1b" in out
    row = next(line.split() for line in out.splitlines() if line.strip().startswith("4 "))
    assert float(row[3]) == pytest.approx(FINAL[4], abs=3e-3)
    struck = next(line.split() for line in out.splitlines() if line.strip().startswith("0-1 "))
    assert float(struck[1]) == pytest.approx(1.0, abs=1e-3)
    assert float(struck[2]) == pytest.approx(2.80128, abs=1e-3)
    assert float(struck[4]) == pytest.approx(0.44966, abs=1e-3)
    assert float(struck[5]) == pytest.approx(0.92318, abs=1e-3)
    for word in ("verlet, step 0.0005 s", "energy error", "momentum error", "steps", "evaluations", "ms"):
        assert word in out


def test_large_forces_have_the_prefix_of_their_unit(softcradle):
    """1.33 MN, not 1330980 N; what the bed takes of the momentum is no error."""
    out = softcradle("run", "train-shunting").out
    assert "force [MN]" in out
    assert re.search(r"\b0-1 .* 1\.33\d* *$", out, re.MULTILINE)
    assert re.search(r"absorbed +\d{3}\.\d+ kJ by contacts, 9\.\d+ kJ by the bed", out)
    assert re.search(r"momentum error +not defined *$", out, re.MULTILINE)


def test_what_happens_is_said_in_words(softcradle):
    said = softcradle("run", "one-on-four", "--describe").out
    assert "Bead 0 hit bead 1 at 1 second with 1 metre a second." in said
    assert "Bead 1 goes to the right at 0.174 metres a second. Beads 2 to 4 go together to the right at 0.465" in said
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
        assert abs(bead["final_velocity"] - exact) < bead["velocity_error"] + 1e-8  # these have eight digits
        assert bead["velocity_error"] <= lane["velocity_error"] < 1e-6
    assert "velocity error" in softcradle("run", "one-on-four", "--method", "accurate").out
    (fixed,) = json.loads(softcradle("run", "one-on-four", "--json", "--method", "verlet").out)["lanes"]
    assert fixed["velocity_error"] is None
    assert "velocity error" not in softcradle("run", "one-on-four", "--method", "verlet").out


def test_a_warning_is_a_sentence(softcradle, monkeypatch):
    def warns(_args: object) -> int:
        warnings.warn("the step is too long", RuntimeWarning, stacklevel=1)
        return 0

    monkeypatch.setattr("softcradle.sandbox.cli.commands.check.main", warns)
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        assert softcradle("check", "mixed").err == "softcradle: warning: the step is too long\n"


def test_errors_are_relative_to_the_start():
    """A constructed motion with known losses of energy and momentum."""
    chain = scenes.load("one-on-four").lanes[0].chain()
    n = chain.contacts
    apart = np.full((2, n), -1.0)
    velocity = np.array([[2.0, 0, 0, 0, 0], [1.0, 0, 0, 0, np.sqrt(2.0)]])
    rate = velocity[:, :-1] - velocity[:, 1:]
    anchor = np.column_stack([np.zeros(2), velocity[:, chain.anchor]])
    trajectory = Trajectory(
        chain=chain, time=np.array([0.0, 1.0]), overlap=apart, rate=rate, anchor=anchor, force=np.zeros((2, n)),
        final_velocity=velocity[-1], contact_intervals=(((0.1, 0.2), (0.9, np.inf)), *((),) * (n - 1)), method="constructed",
    )  # fmt: skip
    summary = summarise("lane", trajectory)
    assert summary.energy_error == pytest.approx(0.25)
    assert summary.energy_error_at_end == pytest.approx(0.25)
    assert summary.momentum_error == pytest.approx((1.0 + np.sqrt(2.0) - 2.0) / 2.0)
    first, second = summary.contacts[:2]
    assert (first.closed, first.opened, first.times, first.still_closed) == (0.1, 0.2, 2, True)
    assert (second.closed, second.opened, second.times, second.still_closed) == (None, None, 0, False)
    assert [row[2] for row in contact_table(summary).rows[:2]] == ["still closed", "never"]


GIVES_UP = ("--method", "verlet", "--step", "1e-12")


@pytest.fixture
def few_steps(monkeypatch):
    """A thousand steps of a picosecond end long before the beads touch."""
    monkeypatch.setattr(runner, "MOST_FIXED_STEPS", 1000)


@pytest.mark.usefixtures("few_steps")
def test_last_velocities_of_a_run_that_gave_up_are_not_called_final_and_the_exit_code_is_3(softcradle, tmp_path):
    out = " ".join(softcradle("run", "one-on-four", *GIVES_UP, code=3).out.split())
    assert "velocity when it gave up" in out
    assert "final velocity" not in out
    assert "verlet gave up after" in out
    said = softcradle("run", "one-on-four", *GIVES_UP, "--json", "-o", str(tmp_path / "part.npz"), code=3).out
    assert json.loads(said)["lanes"][0]["gave_up"] is True
    assert (tmp_path / "part.npz").exists()
    softcradle("compare", "one-on-four", "--contact", "hertz(1)", *GIVES_UP, "--json", code=3)


@pytest.mark.usefixtures("few_steps")
@pytest.mark.parametrize("output", ["film.mp4", "frames/", "x.kymograph.png"])
def test_there_is_no_film_of_a_part(output, tmp_path, softcradle):
    err = softcradle("render", "one-on-four", *GIVES_UP, "-o", f"{tmp_path}/{output}", code=3).err
    assert "a film needs the whole motion: verlet gave up" in err
    assert list(tmp_path.iterdir()) == []
