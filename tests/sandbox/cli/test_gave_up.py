"""A run that gave up before its end: its last velocities are not called final, and the exit code is 3."""

import json

import pytest
from softcradle.physics.fixed_step import runner

GIVES_UP = ("--method", "verlet", "--step", "1e-12")


@pytest.fixture(autouse=True)
def few_steps(monkeypatch):
    """A thousand steps of a picosecond end long before the beads touch."""
    monkeypatch.setattr(runner, "MOST_FIXED_STEPS", 1000)


def test_run_marks_the_velocities_and_says_it_in_json(softcradle, tmp_path):
    out = " ".join(softcradle("run", "one-on-four", *GIVES_UP, code=3).out.split())
    assert "velocity when it gave up" in out
    assert "final velocity" not in out
    assert "verlet gave up after" in out
    said = softcradle("run", "one-on-four", *GIVES_UP, "--json", "-o", str(tmp_path / "part.npz"), code=3).out
    assert json.loads(said)["lanes"][0]["gave_up"] is True
    assert (tmp_path / "part.npz").exists()


def test_compare_ends_with_the_same_code(softcradle):
    said = softcradle("compare", "one-on-four", "--contact", "hertz(1)", *GIVES_UP, "--json", code=3).out
    assert json.loads(said)["sides"]


@pytest.mark.parametrize("output", ["film.mp4", "still.png", "frames/", "x.kymograph.png"])
def test_there_is_no_film_of_a_part(output, tmp_path, softcradle):
    err = softcradle("render", "one-on-four", *GIVES_UP, "-o", f"{tmp_path}/{output}", code=3).err
    assert "a film needs the whole motion: verlet gave up" in err
    assert list(tmp_path.iterdir()) == []
