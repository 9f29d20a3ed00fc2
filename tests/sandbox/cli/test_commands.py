"""The command: its help, and what its subcommands print and write."""

import json
import re
import subprocess
import sys
import warnings

import numpy as np
import pytest
from softcradle.physics import Trajectory
from softcradle.sandbox.cli.main import COMMANDS, main
from softcradle.sandbox.trajectory_summary import summarise

from softcradle import scenes

FINAL = [-0.56758562, 0.17392147, 0.45407871, 0.46978361, 0.46980183]


def output(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(arguments) == 0
    out, err = capsys.readouterr()
    assert err == ""
    return out


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


def test_scenes_are_listed_printed_to_start_from_and_checked(capsys):
    out = output(capsys, "scenes")
    for name in scenes.names():
        assert name in out
        assert scenes.load(name).title in out
    assert scenes.parse(output(capsys, "scenes", "galilean")) == scenes.load("galilean")
    assert output(capsys, "check", "galilean") == "galilean: ok, 'Who hits whom?' with 5 and 5 beads\n"


def test_run_prints_velocities_contacts_errors_and_cost(capsys):
    out = output(capsys, "run", "one-on-four", "--method", "verlet", "--step", "1/2000")
    assert "One bead on four" in out
    assert "Fig. 1b" in out
    row = next(line.split() for line in out.splitlines() if line.strip().startswith("4 "))
    assert float(row[3]) == pytest.approx(FINAL[4], abs=3e-3)
    struck = next(line.split() for line in out.splitlines() if line.strip().startswith("0-1 "))
    assert float(struck[1]) == pytest.approx(1.0, abs=1e-3)
    assert float(struck[2]) == pytest.approx(2.80128, abs=1e-3)
    assert float(struck[4]) == pytest.approx(0.44966, abs=1e-3)
    assert float(struck[5]) == pytest.approx(0.92318, abs=1e-3)
    for word in ("method", "verlet, step 0.0005 s", "energy error", "momentum error", "steps", "evaluations", "ms"):
        assert word in out


def test_large_forces_have_the_prefix_of_their_unit(softcradle):
    """1.33 MN, not 1330980 N; what the bed takes of the momentum is no error."""
    printed = softcradle("run", "train-shunting").out
    assert "force [MN]" in printed
    assert re.search(r"\b0-1 .* 1\.33\d* *$", printed, re.MULTILINE)
    assert re.search(r"absorbed +\d{3}\.\d+ kJ by contacts, 9\.\d+ kJ by the bed", printed)
    assert re.search(r"momentum error +not defined *$", printed, re.MULTILINE)


def test_what_happens_is_said_in_words(capsys):
    said = output(capsys, "run", "one-on-four", "--describe")
    assert "Bead 0 hit bead 1 at 1 second with 1 metre a second." in said
    assert (
        "left at 0.568 metres a second. Bead 1 goes to the right at 0.174 metres a second. Beads 2 to 4 go tog" in said
    )
    assert "Beads 2 to 4 go together to the right at 0.465 metres a second." in said
    assert output(capsys, "run", "galilean", "--describe").startswith("Who hits whom?\n")


def test_results_say_how_well_the_final_velocities_are_known(capsys):
    results = json.loads(output(capsys, "run", "one-on-four", "--json", "--method", "accurate"))
    (lane,) = results["lanes"]
    assert results["versions"]["softcradle"]
    assert lane["status"] == "separated"
    assert lane["energy_error"] < 1e-3
    assert lane["momentum_error"] < 1e-12
    assert lane["contacts"][0]["closed"] == pytest.approx(1.0, abs=1e-3)
    for bead, exact in zip(lane["beads"], FINAL, strict=True):
        assert abs(bead["final_velocity"] - exact) < bead["velocity_error"] + 1e-8  # these have eight digits
        assert bead["velocity_error"] <= lane["velocity_error"] < 1e-6
    assert "velocity error" in output(capsys, "run", "one-on-four", "--method", "accurate")
    (fixed,) = json.loads(output(capsys, "run", "one-on-four", "--json", "--method", "verlet"))["lanes"]
    assert fixed["velocity_error"] is None
    assert "velocity error" not in output(capsys, "run", "one-on-four", "--method", "verlet")


def test_a_warning_is_a_sentence(capsys, monkeypatch):
    def warns(_args: object) -> int:
        warnings.warn("the step is too long", RuntimeWarning, stacklevel=1)
        return 0

    monkeypatch.setattr("softcradle.sandbox.cli.commands.check.main", warns)
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        assert main(["check", "mixed"]) == 0
    assert capsys.readouterr().err == "softcradle: warning: the step is too long\n"


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
        final_velocity=velocity[-1], contact_intervals=((),) * n, method="constructed",
    )  # fmt: skip
    summary = summarise("lane", trajectory)
    assert summary.energy_error == pytest.approx(0.25)
    assert summary.energy_error_at_end == pytest.approx(0.25)
    assert summary.momentum_error == pytest.approx((1.0 + np.sqrt(2.0) - 2.0) / 2.0)
    assert summary.contacts[0].closed is None
    assert summary.contacts[0].times == 0
