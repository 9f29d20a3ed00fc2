"""The files that `softcradle compare` writes: all or none."""

from __future__ import annotations

import json

import av
import pytest
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.film.scene_film import MOST_BEFORE_HIT, film_shots
from softcradle.sandbox.film.scene_motion import first_force, scene_motions_quietly, strongest_row
from softcradle.sandbox.studies.compare.report import FilmSettings
from softcradle.sandbox.studies.compare.sides import comparison_of
from softcradle.sandbox.user_error import UserError

from tests.helpers.drawn_text import colliding, film_texts

PAIR = ["one-on-four", "--contact", "power_law(1,0.1)", "--contact", "draft_gear(5,0.2)"]


def test_no_file_is_half_written_when_the_film_fails(refused, tmp_path, monkeypatch):
    def fail(*_, **__):
        raise UserError("the film has failed")

    monkeypatch.setattr("softcradle.sandbox.studies.compare.report.render_scene", fail)
    (tmp_path / "old.html").write_text("old")
    outputs = ["-o", str(tmp_path / "old.html"), "-o", str(tmp_path / "new.json"), "-o", str(tmp_path / "new.mp4")]
    assert "the film has failed" in refused(*PAIR, *outputs)
    assert [path.name for path in tmp_path.iterdir()] == ["old.html"]
    assert (tmp_path / "old.html").read_text() == "old"


def test_film_report_and_numbers_in_one_run(capsys, tmp_path):
    names = ("film.mp4", "report.html", "numbers.json")
    outputs = [word for name in names for word in ("-o", str(tmp_path / name))]
    assert main(["compare", *PAIR, *outputs, "--size", "480x270", "--slow", "0.5"]) == 0
    printed = capsys.readouterr().out
    assert all(f"written: {tmp_path / name}" in printed for name in names)
    assert "rigidity at detachment" in printed
    assert "known to (m/s)" in printed
    content = json.loads((tmp_path / "numbers.json").read_text())
    assert content["sides"][0]["measures"]["final_velocity"][0] == pytest.approx(-0.56758562, abs=1e-7)
    assert 0.0 < max(content["sides"][0]["velocity_error"]) < 1e-6
    with av.open(str(tmp_path / "film.mp4")) as film:
        assert film.streams.video[0].frames > 30
    report = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert all(report.count(label) > 1 for label in ("power_law(1, 0.1)", "draft_gear(5, 0.2)"))


def test_film_is_simulated_with_the_given_method(tmp_path, monkeypatch):
    given = {}

    def record(scene, path, size, **settings):
        given.update(settings)
        raise UserError("enough")

    monkeypatch.setattr("softcradle.sandbox.studies.compare.report.render_scene", record)
    assert main(["compare", *PAIR, "-o", str(tmp_path / "x.mp4"), "--method", "verlet", "--step", "0.002"]) == 2
    assert (given["method"], given["step"]) == ("verlet", 0.002)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("names", "contacts"),
    [
        (["one-on-four"], ["draft_gear(5, 0.2)"]),
        (["one-on-four"], ["hertz(1)", "hooke(1)", "power_law(1, 1/30)"]),
        (["one-on-ten", "prestressed"], []),
        (["train-shunting", "train-cut"], []),
        (["draft-gear-one-on-three"], ["power_law(15, 0.1)"]),
    ],
    ids="-".join,
)
def test_the_film_begins_near_the_hit_and_no_text_lies_on_another(names, contacts):
    comparison, settings = comparison_of(names, contacts), FilmSettings()
    scene, size = comparison.as_scene(2.0), settings.pixels(comparison)
    motions, _ = scene_motions_quietly(scene, 30.0 * scene.view.slow)
    shots, hit = film_shots(scene, motions, 30.0), first_force(motions)
    assert sum(shot.row < hit for shot in shots) <= MOST_BEFORE_HIT * len(shots) + 1
    last = len(motions[0].time) - 1
    for texts in film_texts(scene, motions, size, (shots[0].row, strongest_row(motions), last // 2, last)):
        assert colliding(texts) == []
