"""The page as a file: everything is in it, it loads nothing, and what cannot be written leaves nothing behind."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import pytest
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.draw.number_format import number_text
from softcradle.sandbox.page import write_page
from softcradle.sandbox.page.motion_family import render_page
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.session import Session, SetContact
from softcradle.sandbox.user_error import UserError
from softcradle.scenes.catalogue import parse

from softcradle import power_law, scenes, simulate
from tests.helpers.paths import ROOT
from tests.sandbox.page.conftest import page_data

VOID = frozenset({"meta", "link", "img", "br", "path", "rect", "input"})


class TagChecker(HTMLParser):
    """Checks that every tag is closed, and collects what the page would load and the ids that it has."""

    def __init__(self, text):
        super().__init__()
        self.stack, self.links, self.ids = [], [], []
        self.feed(text)
        assert self.stack == []

    def handle_starttag(self, tag, attrs):
        self.links += [value for name, value in attrs if name in ("src", "href", "poster", "srcset")]
        self.ids += [value for name, value in attrs if name == "id"]
        if tag not in VOID:
            self.stack.append(tag)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.stack.pop() == tag


def test_the_page_closes_its_tags_and_loads_nothing(pages):
    text = pages("one-on-four").output.read_text(encoding="utf-8")
    checker = TagChecker(text)
    assert checker.links == ["data:,"]
    assert len(set(checker.ids)) == len(checker.ids)
    assert "default-src 'none'" in text


@pytest.mark.parametrize("name", ["one-on-four", "galilean", "draft-gear-two-on-two", "weak-contact", "one-on-ten"])
def test_a_usual_scene_needs_less_than_a_megabyte(pages, name):
    report = pages(name)
    assert report.size == report.output.stat().st_size < 1_000_000


def test_the_documentation_says_how_large_a_page_is(pages):
    said = (ROOT / "docs" / "sharing.md").read_text(encoding="utf-8")
    assert pages("one-on-four").size < 1000 * int(re.search(r"page\.html +# less than (\d+) kB", said)[1])


@pytest.mark.parametrize("live", ["alpha", "speed"])
def test_a_family_needs_less_than_a_megabyte(pages, live):
    assert pages("one-on-four", live).size < 1_000_000


def test_the_page_says_what_was_recorded_by_which_method_and_error(pages):
    text = pages("one-on-four").output.read_text(encoding="utf-8")
    found = simulate(scenes.load("one-on-four").lanes[0].chain(), [1, 0, 0, 0, 0])
    assert all(number_text(velocity) in text for velocity in found.final_velocity)
    recorded = "Recorded motion, computed by accurate, tolerance 1e-08; velocities at the end to "
    assert re.search(recorded + r"\d\.\d·10⁻⁸ m/s, energy error \d\.\d·10⁻⁹, momentum error", text)


def test_warnings_of_the_run_are_on_the_page(tmp_path):
    scene = load_scene("one-on-four")
    with pytest.warns(RuntimeWarning) as warned:
        found = simulate(scene.lanes[0].chain(), scene.lanes[0].velocity, method="verlet", step=0.05)
    write_page(found, scene, tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert str(warned[0].message).replace("'", "&#x27;") in text
    assert "computed by verlet, step 0.050 s" in text


def test_labels_of_users_are_text_not_markup(tmp_path):
    evil = "</script><script>alert(1)</script>"
    lane = f'label = "{evil}"\nbeads = [1, 1]\nvelocity = 1.0\ncontact = {{law = "hertz", stiffness = 1.0}}\n'
    scene = parse(f'title = "<b>&x"\ntext = "{evil}"\n[[lanes]]\n{lane}[[lanes]]\n{lane}')
    render_page(scene, tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    TagChecker(text)
    assert "<script>alert" not in text
    assert "<b>" not in text
    assert page_data(text)["members"][0]["lanes"][0]["label"] == evil


def test_a_page_needs_a_trajectory_for_each_lane(tmp_path):
    scene = load_scene("galilean")
    found = simulate(scene.lanes[0].chain(), scene.lanes[0].velocity)
    with pytest.raises(UserError, match="a trajectory for each lane: 2, not 1"):
        write_page(found, scene, tmp_path / "page.html")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["-o", "{}/missing/page.html"], "there is no folder"),
        (["-o", "{}/page.html", "--fps", "30"], "a page has no frames: --fps is for films"),
        (["-o", "{}/page.html", "--pixel-format", "yuv444p"], "--pixel-format is for films"),
        (["-o", "{}/page.html", "--live", "mass"], "a slider over alpha or speed, not 'mass'"),
        (["-o", "{}/film.mp4", "--live", "alpha"], "--live is for a page"),
        (["-o", "{}/page.html", "--method", "radau", "--step", "1e-3"], "chooses its own steps"),
    ],
)
def test_refusals_leave_nothing(capsys, tmp_path, arguments, sentence):
    assert main(["render", "one-on-four", *(word.format(tmp_path) for word in arguments)]) == 2
    errors = capsys.readouterr().err
    assert errors.startswith("softcradle: ")
    assert sentence in errors
    assert errors.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_scene_without_an_alpha_has_no_slider_over_it(tmp_path):
    with pytest.raises(UserError, match="take --live speed"):
        render_page(load_scene("hertz-cradle"), tmp_path / "page.html", live="alpha")


def test_the_command_reports_the_page(capsys, tmp_path):
    assert main(["render", "two-on-two", "-o", str(tmp_path / "two.html")]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith(f"written: {tmp_path / 'two.html'}, a page of ")
    assert [path.name for path in tmp_path.iterdir()] == ["two.html"]


def test_a_session_of_the_window_can_be_shared(tmp_path):
    """What was played in the window, with an edit in the middle, is a page of what has been played since."""
    session = Session(load_scene("galilean"))
    session.step_frames(150)
    session.apply(SetContact(0, 1, power_law(1.0, 0.3)))
    session.step_frames(150)
    trajectories = [session.trajectory(lane) for lane in range(2)]
    report = write_page(trajectories, session.to_scene(), tmp_path / "page.html")
    text = report.output.read_text(encoding="utf-8")
    TagChecker(text)
    lanes = page_data(text)["members"][0]["lanes"]
    assert lanes[0]["rows"] <= trajectories[0].time.size
    assert lanes[1]["rows"] <= trajectories[1].time.size + 2  # and free flight before the start
    assert "exported from a session: begins at frame 150" in text
    assert report.size < 1_000_000
