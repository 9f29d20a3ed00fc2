"""Tests of the command `softcradle compare`.

The tests check its numbers against reference values, the fit of the nearest contact law, and the report as text, film
and web page.
"""

import json
import re
import sys
from unittest.mock import Mock

import av
import numpy as np
import pytest
from softcradle.sandbox.console import ProgressShown
from softcradle.sandbox.film.scene_film import MOST_BEFORE_HIT, film_shots
from softcradle.sandbox.film.scene_motion import first_force, scene_motions_quietly, strongest_row
from softcradle.sandbox.story.numbers import number_text
from softcradle.sandbox.studies.compare.report import ComparisonReport, FilmSettings
from softcradle.sandbox.studies.compare.results import solve_sides
from softcradle.sandbox.studies.compare.sides import comparison_of, short_text
from softcradle.sandbox.user_error import UserError

from tests.helpers.drawn_text import colliding, film_texts
from tests.sandbox.page.conftest import TagChecker
from tools.browser import Browser, found


@pytest.fixture
def compared(softcradle):
    def run(*arguments):
        printed, errors = softcradle("compare", *arguments, "--json")
        assert errors.strip() == ""  # The progress bar of a film leaves an empty line on the standard error.
        return json.loads(printed)

    return run


PAIR = ["one-on-four", "--contact", "power_law(1,0.1)", "--contact", "draft_gear(5,0.2)"]


def test_sides_of_a_comparison_are_ordered_and_named(compared):
    content, by_step = compared(*PAIR), compared(*PAIR, "--method", "conserving")
    for key in ("name", "contact"):
        assert [side[key] for side in content["sides"]] == ["power_law(1, 0.1)", "draft_gear(5, 0.2)"]
    soft, gear = (side["measures"] for side in content["sides"])
    assert soft["rigidity"] < gear["rigidity"]
    assert content["versions"]
    assert {side["method"] for side in by_step["sides"]} == {"conserving"}
    for a, b in zip(by_step["sides"], content["sides"], strict=True):
        assert a["measures"]["final_velocity"] == pytest.approx(b["measures"]["final_velocity"], abs=2e-3)


def test_the_nearest_contact_is_one_more_side(compared, tmp_path):
    path = tmp_path / "x.html"
    arguments = ["draft-gear-two-on-two", "--match", "--contact", "hertz(1e6)", "-o", str(path)]
    content = compared(*arguments)
    names = [side["name"] for side in content["sides"]]
    assert names[:2] == ["draft_gear(770, 0.0177)", "hertz(1e+06)"]
    # The name contains rounded numbers, as in the film.
    assert names[2] == f"nearest: {short_text(content['match']['contact'])}"
    assert content["match"]["near"]
    assert content["match"]["residual"] < 0.05
    given, _, nearest = (side["measures"] for side in content["sides"])
    assert nearest["contact_time"] == pytest.approx(given["contact_time"], rel=0.02)
    assert nearest["peak_force"] == pytest.approx(given["peak_force"], rel=0.1)
    assert content["match"]["sentence"].partition(" in this collision")[0] in path.read_text()


def test_where_no_contact_is_near_a_sentence_says_so(compared, monkeypatch):
    shown = []
    monkeypatch.setattr(ProgressShown, "tell", lambda self, *told: shown.append(told))
    match = compared("hertz-cradle", "--match")["match"]
    assert shown == [("collisions", done) for done in range(1, len(shown) + 1)]
    assert len(shown) > 50
    assert not match["near"]
    assert match["ends"] == ["precompression"]
    assert match["sentence"].startswith("No draft gear comes near hertz(")
    assert "lies at the end of the range searched" in match["sentence"]
    assert compared("one-on-four", "--match", "outcome")["match"]["distance"] == "outcome"


def test_scenes_of_every_kind_are_compared(compared):
    names = [s["name"] for s in compared("one-on-four", "one-on-four", "two-on-two")["sides"]]
    assert names == ["one-on-four", "one-on-four (2)", "two-on-two"]
    sides = compared("galilean")["sides"]
    assert [s["name"] for s in sides] == ["four on one", "one on four"]
    a, b = (s["measures"] for s in sides)
    # The two collisions differ only by the frame of reference, so their measures must be equal.
    assert a["restitution"] == pytest.approx(b["restitution"], rel=1e-6)
    assert a["peak_force"] == pytest.approx(b["peak_force"], rel=1e-6)
    gears, solid = (side["measures"] for side in compared("train-shunting", "train-solid")["sides"])
    assert solid["peak_force"] > 1.5 * gears["peak_force"]
    assert (solid["speed_ratio"], solid["spread_variable"]) == (None, None)


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    comparison = comparison_of(["draft-gear-one-on-three"], ["power_law(16, 1/10)", "hertz(1e6)"])
    results = solve_sides(comparison)
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(ComparisonReport(comparison, results, FilmSettings(slow=20.0)).html(), encoding="utf-8")
    return path, path.read_text(encoding="utf-8"), results


def test_page_closes_its_tags_loads_nothing_and_has_every_number(page):
    _, text, results = page
    checker = TagChecker(text)
    assert checker.links
    assert all(link.startswith("data:") for link in checker.links)
    for result in results:
        for value in result.measures.final_velocity:
            assert number_text(value) in text
        assert number_text(result.measures.restitution) in text
    # The energy at the start is not a useful reference, because an external force may add energy.
    assert "share of all energy" not in text
    bars = re.findall(r"<title>0-1 (open|touching) (\S+) to (\S+) ms</title>", text)[:3]
    assert [state for state, *_ in bars] == ["open", "touching", "open"]
    assert bars[0][2] == bars[1][1]
    assert bars[1][2] == bars[2][1]
    for title in re.findall("<dt>([^<]+)</dt>", text):
        assert re.search(rf"<th [^>]*>{re.escape(title)}</th>", text), f"{title} is explained and not there"
    for table in re.findall("<table>.*?</table>", text):
        rows = [re.findall("<td>([^<]*)</td>", row) for row in re.findall("<tr>.*?</tr>", table)[1:]]
        assert all(set(values) != {"-"} for values in (*rows, *zip(*rows, strict=True))), "a measure that nothing has"


def test_labels_of_users_are_text_not_markup(tmp_path):
    lane = '[[lanes]]\nlabel="<script>alert()</script>"\nbeads=[1,1]\nvelocity=1.0\ncontact={law="hertz",stiffness=1}\n'
    (tmp_path / "x.toml").write_text(f'title = "<b>&x"\n{lane}{lane.replace("1}", "2}")}')
    comparison = comparison_of([str(tmp_path / "x.toml")], [])
    text = ComparisonReport(comparison, solve_sides(comparison)).html()
    assert not re.search("<script>alert|<b>", text)


@pytest.mark.slow
@pytest.mark.skipif(found() is None, reason="there is no browser")
def test_page_in_a_browser(page, tmp_path):
    path, _, results = page
    with Browser(tmp_path / "profile") as browser:
        moment = 0.05
        browser.visit(path, "")
        browser.run(f"page.pause(), page.go({moment})")
        assert browser.run("page.source.slow") == 20.0
        lanes = browser.run("page.specs.map((_, lane) => Array.from(page.source.values(lane).velocity))")
        for shown, result in zip(lanes, results, strict=True):
            rows = [np.interp(moment, result.trajectory.time, column) for column in result.trajectory.velocity.T]
            np.testing.assert_allclose(shown, rows, atol=2e-3)
        times = browser.run("page.charts.map((chart) => chart.timeAt(chart.across(page.source.time)))")
        # The page shows the velocities and the forces of each row of beads.
        assert times == pytest.approx([moment] * 2 * len(results))
        tables = browser.run("[...document.querySelectorAll('table')].map((t) => t.rows.length)")
        # The first table lacks a line about oscillations of forces, because no force oscillates. The table contains
        # four final velocities and their accuracy.
        assert tables == [1 + 13 + 5, 4, 4, 4]
        fits = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
        assert browser.run(fits)
        browser.device(390, 844)
        assert browser.run(fits)
        assert browser.complaints == []


APART = (
    'title = "Apart"\nduration = 1.0\n{settings}\n[[lanes]]\nvelocity = [1.0, 0.0]\ngap = 50.0\n'
    'contact = {{law = "power_law", f0 = 1.0, alpha = 0.1}}\n'
)


def test_without_contact_there_is_no_chart_of_the_law(tmp_path, compared):
    (tmp_path / "apart.toml").write_text(APART.format(settings=""))
    content = compared(str(tmp_path / "apart.toml"), "--contact", "hertz(10)", "-o", str(tmp_path / "x.html"))
    assert [side["measures"]["peak_force"] for side in content["sides"]] == [0.0, 0.0]
    text = (tmp_path / "x.html").read_text(encoding="utf-8")
    assert "Force of the struck contact" in text
    assert "Law of the struck contact" not in text


PULLED = """
title = "pulled"
duration = 4.0
[[lanes]]
mass = [2.0, 1.0, 1.0]
velocity = [1.0, 0.0, 0.0]
gap = 0.1
[lanes.contact]
law = "coupler"
slack = 0.2
push = {law = "draft_gear", stiffness = 10.0, precompression = 0.1, loss = 0.1}
pull = {law = "draft_gear", stiffness = 10.0, precompression = 0.1, loss = 0.5}
"""


def test_charts_of_couplers_agree_with_tables(tmp_path):
    """Check that the charts and the tables of a comparison agree for couplers.

    In an earlier version, a chart showed pulled contacts as touching. The chart also used the loss of the pulling gear
    for the unloading of pushing contacts.
    """
    path = tmp_path / ("pulled\udcff.toml" if sys.platform == "linux" else "pulled.toml")
    path.write_text(PULLED)
    comparison = comparison_of([str(path), "one-on-four"], [])
    results = solve_sides(comparison)
    text = ComparisonReport(comparison, results).html()
    assert text.encode(), "whatever bytes are in the name of the file"
    for k in range(2):
        bars = re.findall(rf"<title>{k}-{k + 1} loaded (\S+) to (\S+) s</title>", text)
        loaded = sum(result.measures.contacts[k].loaded for result in results)
        assert sum(float(end) - float(begin) for begin, end in bars) == pytest.approx(loaded, abs=0.02)
    law = results[0].trajectory.chain.contact[0]
    assert [law.released(d) for d in (1.0, -1.0)] == pytest.approx([0.9 * law.force(1.0), 0.5 * law.force(-1.0)])


def test_a_film_uses_the_common_method_and_magnification(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(APART.format(settings='method = "euler"\nstep = 0.01\nview = {magnify = 50.0}'))
    scene = comparison_of([str(path)], ["hertz(10)"]).as_scene(1.0)
    assert (scene.method, scene.step, scene.view.magnify) == ("euler", 0.01, 50.0)
    assert {motion.method for motion in scene_motions_quietly(scene, 30.0)[0]} == {"euler, step 0.010 s"}
    scene = comparison_of([str(path), "one-on-four"], []).as_scene(1.0)
    assert (scene.method, scene.step, scene.view.magnify) == (None, None, None)


def test_a_given_method_replaces_that_of_the_scene(tmp_path, compared):
    path, page = tmp_path / "own.toml", tmp_path / "x.html"
    path.write_text(APART.format(settings='method = "yoshida4"\nstep = 0.01'))
    content = compared(str(path), "--contact", "hertz(1, loss=0.1)", "--method", "verlet", "-o", str(page))
    assert {side["method"] for side in content["sides"]} == {"verlet"}
    assert page.exists()


def outputs(folder, *names):
    return [word for name in names for word in ("-o", str(folder / name))]


def test_a_failed_film_leaves_no_partial_file(softcradle, tmp_path, monkeypatch):
    rendered = Mock(side_effect=UserError("the film has failed"))
    monkeypatch.setattr("softcradle.sandbox.studies.compare.report.render_scene", rendered)
    (tmp_path / "old.html").write_text("old")
    words = [*outputs(tmp_path, "old.html", "new.json", "new.mp4"), "--method", "verlet", "--step", "0.002"]
    assert softcradle("compare", *PAIR, *words, code=2).err == "softcradle: the film has failed\n"
    assert [path.name for path in tmp_path.iterdir()] == ["old.html"]
    assert (tmp_path / "old.html").read_text() == "old"
    scene = rendered.call_args.args[0]
    assert (scene.method, scene.step) == ("verlet", 0.002)


def test_film_report_and_numbers_in_one_run(softcradle, tmp_path):
    names = ("film.mp4", "report.html", "numbers.json")
    printed = softcradle("compare", *PAIR, *outputs(tmp_path, *names), "--size", "480x270", "--slow", "0.5").out
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
def test_texts_of_a_comparison_film_do_not_overlap(names, contacts):
    comparison, settings = comparison_of(names, contacts), FilmSettings()
    scene, size = comparison.as_scene(2.0), settings.pixels(comparison)
    motions, _ = scene_motions_quietly(scene, 30.0 * scene.view.slow)
    shots, hit = film_shots(scene, motions, 30.0), first_force(motions)
    assert sum(shot.row < hit for shot in shots) <= MOST_BEFORE_HIT * len(shots) + 1
    last = len(motions[0].time) - 1
    for texts in film_texts(scene, motions, size, (shots[0].row, strongest_row(motions), last // 2, last)):
        assert colliding(texts) == []
