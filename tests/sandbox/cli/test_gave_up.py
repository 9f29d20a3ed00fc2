"""A run that gave up before its end: its last velocities are not called final, and the exit code is 3."""

import json

import pytest
from softcradle.physics.fixed_step import runner
from softcradle.sandbox.cli.main import main

GIVES_UP = ("--method", "verlet", "--step", "1e-12")


@pytest.fixture(autouse=True)
def few_steps(monkeypatch):
    """A thousand steps of a picosecond end long before the beads touch."""
    monkeypatch.setattr(runner, "MOST_FIXED_STEPS", 1000)


def test_run_marks_the_velocities_and_says_it_in_json(capsys, tmp_path):
    assert main(["run", "one-on-four", *GIVES_UP]) == 3
    out = " ".join(capsys.readouterr().out.split())
    assert "velocity when it gave up" in out
    assert "final velocity" not in out
    assert "verlet gave up after" in out
    assert main(["run", "one-on-four", *GIVES_UP, "--json", "-o", str(tmp_path / "part.npz")]) == 3
    assert json.loads(capsys.readouterr().out)["lanes"][0]["gave_up"] is True
    assert (tmp_path / "part.npz").exists()


def test_compare_ends_with_the_same_code(capsys):
    assert main(["compare", "one-on-four", "--contact", "hertz(1)", *GIVES_UP, "--json"]) == 3
    assert json.loads(capsys.readouterr().out)["sides"]


@pytest.mark.parametrize("output", ["film.mp4", "still.png", "frames/", "x.kymograph.png"])
def test_there_is_no_film_of_a_part(output, tmp_path, capsys):
    assert main(["render", "one-on-four", *GIVES_UP, "-o", f"{tmp_path}/{output}"]) == 3
    err = capsys.readouterr().err
    assert "a film needs the whole motion: verlet gave up" in err
    assert list(tmp_path.iterdir()) == []
