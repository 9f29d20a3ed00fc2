"""`softcradle compare`: numbers against the truth, the files it writes, the page in a real browser, refusals."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser

import av
import numpy as np
import pytest
from PIL import Image
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.draw.number_format import MINUS
from softcradle.sandbox.studies.compare.comparison_files import Report, Wishes
from softcradle.sandbox.studies.compare.comparison_results import solved
from softcradle.sandbox.studies.compare.comparison_tables import number
from softcradle.sandbox.studies.compare.sides import MOST_SIDES, chosen
from softcradle.sandbox.studies.compare.svg_charts import Axes, Curve, chart, span
from softcradle.sandbox.user_error import UserError

from tests.helpers.browser import Browser, found
from tests.helpers.truth import CRITICAL_SPEEDS, GEARS

QUICK = Wishes((480, 270), 1.0)
PAIR = ["one-on-four", "--contact", "power_law(1,0.1)", "--contact", "draft_gear(5,0.2)"]


def compared(capsys, *arguments):
    assert main(["compare", *arguments, "--json"]) == 0
    out, err = capsys.readouterr()
    assert err.strip() == ""  # the bar of a film leaves an empty line
    return json.loads(out)


def refused(capsys, *arguments):
    assert main(["compare", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("softcradle: ")
    assert err.count("\n") == 1
    assert "Traceback" not in err
    return err


def gear_scene(case):
    strikers = case.struck + 1
    mass, speed = list(case.chain.mass), float(case.start[0])
    return f"""
title = "{case.name}"
[[lanes]]
beads = [{strikers}, {len(mass) - strikers}]
mass = {mass}
contact = {{law = "draft_gear", stiffness = 770.0, precompression = 0.0177}}
velocity = {speed!r}
"""


def test_draft_gears_below_and_above_the_critical_speed(capsys, tmp_path):
    cases = [case for case in GEARS if len(case.start) == 4]
    paths = [tmp_path / f"{k}.toml" for k in range(len(cases))]
    for path, case in zip(paths, cases, strict=True):
        path.write_text(gear_scene(case))
    sides = compared(capsys, *map(str, paths))["sides"]
    kinds = set()
    for side, case in zip(sides, cases, strict=True):
        found_, inner = side["measures"], side["measures"]["contacts"][1:]
        assert found_["final_velocity"] == pytest.approx(list(case.final), abs=1e-7)
        assert found_["contact_time"] == pytest.approx(case.contact_time, rel=1e-8)
        assert [c["peak_force"] for c in found_["contacts"]] == pytest.approx(list(case.peak_force), rel=1e-5)
        above = bool(np.isfinite(case.opened[1:]).any())
        kinds.add(above)
        assert any(contact["loaded"] > 0.0 for contact in inner) == above
        assert (found_["rigidity"] > 0.1) == above
        if not above:
            assert found_["rigidity"] == pytest.approx(0.0, abs=1e-8)
            assert found_["restitution"] == pytest.approx(1.0, abs=1e-8)
        if len(set(case.chain.mass)) == 1 and case.struck == 0:
            assert (case.start[0] > CRITICAL_SPEEDS["1-on-3"]) == above
    assert kinds == {True, False}


def test_one_scene_with_contacts_shows_itself_first_and_nothing_twice(capsys):
    told = compared(capsys, *PAIR)
    assert [side["name"] for side in told["sides"]] == ["power_law(1, 0.1)", "draft_gear(5, 0.2)"]
    assert [side["contact"] for side in told["sides"]] == ["power_law(1, 0.1)", "draft_gear(5, 0.2)"]
    soft, gear = (side["measures"] for side in told["sides"])
    assert soft["rigidity"] < gear["rigidity"]
    assert told["versions"]


def test_the_nearest_contact_is_one_more_side(capsys, tmp_path):
    path = tmp_path / "x.html"
    told = compared(
        capsys, "draft-gear-one-on-three", "--match", "--contact", "hertz(1e6)", "-o", str(path), "--size", "480x270"
    )
    names = [side["name"] for side in told["sides"]]
    assert names[:2] == ["draft_gear(770, 0.0177)", "hertz(1e+06)"]
    assert names[2] == f"nearest: {told['match']['contact']}"
    assert told["match"]["near"]
    assert told["match"]["residual"] < 0.05
    given, _, nearest = (side["measures"] for side in told["sides"])
    assert nearest["contact_time"] == pytest.approx(given["contact_time"], rel=0.02)
    assert nearest["peak_force"] == pytest.approx(given["peak_force"], rel=0.1)
    text = path.read_text()
    assert told["match"]["sentence"].partition(" in this collision")[0] in text


def test_where_no_contact_comes_near_it_says_so(capsys):
    match = compared(capsys, "hertz-cradle", "--match")["match"]
    assert not match["near"]
    assert match["ends"] == ["precompression"]
    assert match["sentence"].startswith("No draft gear comes near hertz(")
    assert "lies at the end of the range searched" in match["sentence"]
    outcome = compared(capsys, "one-on-four", "--match", "outcome")["match"]
    assert outcome["distance"] == "outcome"


def test_scenes_lanes_and_the_same_scene_twice(capsys):
    assert [s["name"] for s in compared(capsys, "galilean")["sides"]] == ["four on one", "one on four"]
    names = [s["name"] for s in compared(capsys, "one-on-four", "one-on-four", "two-on-two")["sides"]]
    assert names == ["one-on-four", "one-on-four (2)", "two-on-two"]
    a, b = (s["measures"] for s in compared(capsys, "galilean")["sides"])
    assert a["restitution"] == pytest.approx(b["restitution"], rel=1e-6)  # Galilean invariance
    assert a["peak_force"] == pytest.approx(b["peak_force"], rel=1e-6)


def test_another_method_is_named_and_measured(capsys):
    by_step, default = compared(capsys, *PAIR, "--method", "conserving"), compared(capsys, *PAIR)
    assert {side["method"] for side in by_step["sides"]} == {"conserving"}
    for a, b in zip(by_step["sides"], default["sides"], strict=True):
        assert a["measures"]["final_velocity"] == pytest.approx(b["measures"]["final_velocity"], abs=2e-3)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["one-on-four"], "has nothing to be compared with"),
        (["one-on-four", "no-such"], "there is no scene 'no-such'"),
        (["one-on-four", "two-on-two", "--contact", "hertz(1)"], "--contact changes one scene, but 2 are given"),
        (["one-on-four", "--contact", "hertz(-1)"], "stiffness must be greater than 0"),
        (["one-on-four", "--contact", "herz(1)"], "did you mean 'hertz'?"),
        (["one-on-four", "two-on-two", "-o", "x.pdf"], "the name must end in .html, .json, .mp4"),
        (["one-on-four", "two-on-two", "-o", "no/such/folder/x.html"], "no/such/folder"),
        (["one-on-four", "two-on-two", "-o", "x.json", "-o", "x.json"], "given twice"),
        (["one-on-four", "two-on-two", "--size", "10x10"], "out of range"),
        (["one-on-four", "two-on-two", "--method", "vrlet", "-o", "x.json"], "unknown method"),
        (["one-on-four", "driven-cluster", "-o", "x.json"], "driven-cluster: no two neighbours approach"),
        (["mixed", "--match", "-o", "x.json"], "mixed: matching needs a chain whose contacts are all alike"),
        (["galilean", "--match"], "--match needs one scene with one lane"),
        (["one-on-four", "two-on-two", "--match"], "--match needs one scene with one lane"),
        (["one-on-four", "--match", "shape"], "invalid choice: 'shape'"),
        (["one-on-four"] * (MOST_SIDES + 1), f"at most {MOST_SIDES}"),
    ],
)
def test_refusals(capsys, tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    assert said in refused(capsys, *arguments)
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


def test_nothing_half_written_when_the_film_fails(capsys, tmp_path, monkeypatch):
    def fail(*_, **__):
        raise UserError("the film has failed")

    monkeypatch.setattr("softcradle.sandbox.studies.compare.comparison_files.render_scene", fail)
    (tmp_path / "old.html").write_text("old")
    outputs = ["-o", str(tmp_path / "old.html"), "-o", str(tmp_path / "new.json")]
    assert "the film has failed" in refused(capsys, *PAIR, *outputs)
    assert [path.name for path in tmp_path.iterdir()] == ["old.html"]
    assert (tmp_path / "old.html").read_text() == "old"


def test_film_report_and_numbers_at_once(capsys, tmp_path):
    names = ("film.mp4", "report.html", "numbers.json")
    outputs = [word for name in names for word in ("-o", str(tmp_path / name))]
    assert main(["compare", *PAIR, *outputs, "--size", "480x270", "--slow", "0.5"]) == 0
    out = capsys.readouterr().out
    assert all(f"written: {tmp_path / name}" in out for name in names)
    assert "rigidity at detachment" in out
    told = json.loads((tmp_path / "numbers.json").read_text())
    assert told["sides"][0]["measures"]["final_velocity"][0] == pytest.approx(-0.56758562, abs=1e-7)
    with av.open(str(tmp_path / "film.mp4")) as film:
        assert film.streams.video[0].frames > 30
    assert (tmp_path / "report.html").read_text().count("<video") == 1


def test_the_film_goes_by_the_method_that_is_wished(tmp_path, monkeypatch):
    asked = {}

    def kept(scene, path, size, **wishes):
        asked.update(wishes)
        raise UserError("enough")

    monkeypatch.setattr("softcradle.sandbox.studies.compare.comparison_files.render_scene", kept)
    assert main(["compare", *PAIR, "-o", str(tmp_path / "x.mp4"), "--method", "verlet", "--step", "0.002"]) == 2
    assert (asked["method"], asked["step"]) == ("verlet", 0.002)


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A report as a file, its text, and its results."""
    comparison = chosen(["draft-gear-one-on-three"], ["power_law(16, 1/10)", "hertz(1e6)"])
    results = solved(comparison)
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(Report(comparison, results, Wishes((640, 420), 20.0)).page(), encoding="utf-8")
    return path, path.read_text(encoding="utf-8"), results


class Checker(HTMLParser):
    """Whether tags are closed as they were opened, and what the page would load."""

    VOID = frozenset({"meta", "link", "img", "br", "path", "rect"})

    def __init__(self) -> None:
        super().__init__()
        self.stack: list[str] = []
        self.links: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.links += [value for name, value in attrs if name in ("src", "href", "poster")]
        if tag not in self.VOID:
            self.stack.append(tag)

    def handle_endtag(self, tag):
        if tag not in self.VOID:
            assert self.stack.pop() == tag


def test_page_is_whole_and_holds_everything(page):
    _, text, results = page
    checker = Checker()
    checker.feed(text)
    assert checker.stack == []
    assert checker.links
    assert all(link.startswith("data:") for link in checker.links)
    for result in results:
        for value in result.measures.final_velocity:
            assert number(value) in text
        assert number(result.measures.restitution) in text


def test_labels_of_users_are_text_not_markup(tmp_path):
    (tmp_path / "x.toml").write_text(
        'title = "<b>&x"\n[[lanes]]\nlabel="<script>alert(1)</script>"\nbeads=[1,1]\nvelocity=1.0\n'
        'contact={law="hertz",stiffness=1.0}\n'
        * 1
        + '[[lanes]]\nlabel="b"\nbeads=[1,1]\nvelocity=1.0\ncontact={law="hertz",stiffness=2.0}\n'
    )
    comparison = chosen([str(tmp_path / "x.toml")], [])
    text = Report(comparison, solved(comparison), QUICK).page()
    assert "<script>alert" not in text
    assert "<b>" not in text


@pytest.mark.skipif(found() is None, reason="there is no browser")
def test_page_in_a_browser(page, tmp_path):
    path, _, results = page
    with Browser(tmp_path / "profile") as browser:
        browser.open(path)
        film = browser.run(
            "new Promise((done) => { const film = document.querySelector('video');"
            "const told = () => done([film.videoWidth, film.videoHeight, film.duration]);"
            "film.readyState >= 1 ? told() : film.onloadedmetadata = told;"
            "film.onerror = () => done(film.error.message); })"
        )
        assert film[:2] == [640, 420]
        assert film[2] > 2.0
        places = browser.run(
            "new Promise((done) => { const film = document.querySelector('video'); film.onseeked = () =>"
            "done([...document.querySelectorAll('.cursor')].map((line) => [line.getAttribute('visibility'),"
            "Number(line.getAttribute('transform').match(/[\\d.]+/)[0]), line.dataset.low, line.dataset.high,"
            "line.dataset.left, line.dataset.right].map(String))); film.currentTime = 1.0; })"
        )
        clock, slow, unit = (
            float(browser.run(f"document.querySelector('video').dataset.{k}")) for k in ("clock", "slow", "unit")
        )
        assert slow == 20.0
        assert len(places) == 3 * len(results) + 2
        for visible, *numbers in places:  # a line in every chart at the moment that the film shows
            place, low, high, left, right = map(float, numbers)
            assert visible == "visible"
            assert place == pytest.approx(
                left + (right - left) * ((clock + 1.0 / slow) / unit - low) / (high - low), abs=0.1
            )
        tables = browser.run("[...document.querySelectorAll('table')].map((t) => t.rows.length)")
        assert tables == [1 + 10 + 4, 4, 4, 4]
        wide = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
        assert browser.run(wide)
        grounds = []
        for scheme in ("light", "dark"):
            browser.media("screen", scheme)
            browser.picture(tmp_path / f"{scheme}.png", whole=True)
            with Image.open(tmp_path / f"{scheme}.png") as opened:
                picture = np.asarray(opened.convert("L"), dtype=float)
            grounds.append(float(np.median(picture)))
            assert picture.std() > 5.0  # not an empty sheet
        assert grounds[0] > 200.0
        assert grounds[1] < 60.0
        browser.media("print")
        assert browser.run("getComputedStyle(document.querySelector('video')).display") == "none"
        assert browser.run("document.querySelector('img.still').naturalWidth") == 640
        browser.call("Emulation.setDeviceMetricsOverride", width=390, height=800, deviceScaleFactor=1, mobile=True)
        browser.media("screen")
        assert browser.run(wide)  # a telephone
        assert browser.complaints == []


def test_the_browser_would_complain(tmp_path):
    """The test above can fail: a page with a mistake, and one that loads something, are found out."""
    if found() is None:
        pytest.skip("there is no browser")
    (tmp_path / "bad.html").write_text("<!doctype html><link rel=icon href='data:,'><script>nothing.there()</script>")
    with Browser(tmp_path / "profile") as browser:
        browser.open(tmp_path / "bad.html")
        assert any("nothing is not defined" in complaint for complaint in browser.complaints)


def test_thinned_curves_keep_their_leaps():
    x = np.linspace(0.0, 1.0, 20_001)
    y = np.where(x < 0.50003, 0.0, 1.0)
    axes = Axes((0.0, 1.0), span([y]), "x", "y")
    drawn = re.search(r'd="M([^"]+)"><title>one', chart("t", [Curve("one", x, y, "c0")], axes))[1]
    points = np.array([[float(v) for v in pair.split(",")] for pair in drawn.split("L")])
    assert len(points) < 600
    leap = np.flatnonzero(np.abs(np.diff(points[:, 1])) > 50.0)
    assert len(leap) == 1
    assert points[leap[0] + 1, 0] - points[leap[0], 0] < 0.2


def test_numbers_as_people_read_them():
    assert [number(v) for v in (None, 0.0, 1e-15, 0.5, -0.25, 2e-5, 123456.0)] == [
        "-", "0", "0", "0.5000", f"{MINUS}0.2500", "2.00·10⁻⁵", "1.23·10⁵",
    ]  # fmt: skip
