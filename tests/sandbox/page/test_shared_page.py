"""The page as a file: everything is in it, it loads nothing, and what cannot be written leaves nothing behind."""

import gzip

import pytest
from softcradle.sandbox.page import render_page, write_page
from softcradle.sandbox.page.data import can_be_computed
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Lane, Scene
from softcradle.scenes.catalogue import parse

from softcradle import scenes, simulate
from tests.sandbox.page.conftest import TagChecker, page_data

MOST, MOST_COMPRESSED = 150_000, 60_000  # bytes of a page in which five beads live


@pytest.mark.parametrize("name", ["one-on-four", "two-on-two", "hertz-cradle", "draft-gear-one-on-three"])
def test_a_page_in_which_beads_live_is_small_closes_its_tags_and_loads_nothing(pages, name):
    report = pages(name)
    assert report.computed
    assert report.size == report.output.stat().st_size < MOST
    assert len(gzip.compress(report.output.read_bytes())) < MOST_COMPRESSED
    text = report.output.read_text(encoding="utf-8")
    checker = TagChecker(text)
    assert checker.links == ["data:,"]
    assert len(set(checker.ids)) == len(checker.ids)
    assert "default-src 'none'" in text


@pytest.mark.parametrize("name", scenes.names())
def test_a_scene_with_forces_over_time_or_couplers_is_recorded_and_all_others_live(name):
    chains = [lane.chain() for lane in load_scene(name).lanes]
    special = any(chain.couplers or chain.timed or chain.brakes for chain in chains) or len(chains) > 2
    assert can_be_computed(load_scene(name)) is not special


@pytest.mark.parametrize(("losses", "uniform"), [((0.5, 0.5, 0.5), True), ((0.0, 0.0, 0.5), False)])
def test_a_row_can_be_longer_if_its_contacts_are_alike(tmp_path, losses, uniform):
    contacts = [{"law": "power_law", "f0": 1.0, "alpha": 0.1, "loss": loss} for loss in losses]
    scene = Scene(title="a row", lanes=(Lane(contact=contacts, velocity=[1, 0, 0, 0]),))
    report = render_page(scene, tmp_path / "page.html")
    assert (page_data(report.output.read_text(encoding="utf-8"))["uniform"] is not None) is uniform


def test_what_is_asked_of_a_method_is_recorded_and_the_page_says_how(pages):
    report = pages("one-on-four", method="radau")
    text = report.output.read_text(encoding="utf-8")
    assert not report.computed
    found = simulate(scenes.load("one-on-four").lanes[0].chain(), [1, 0, 0, 0, 0], method="radau")
    assert all(f"{velocity:.8f}" in text for velocity in found.final_velocity)
    assert "Recorded motion, computed by radau, tolerance 1e-08; " in text


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
    assert page_data(text)["texts"]["en"] == {"title": "<b>&x", "text": evil, "labels": [evil, evil]}


def test_a_trajectory_is_missing_for_a_lane(tmp_path):
    scene = load_scene("galilean")
    with pytest.raises(UserError, match="a trajectory for each lane: 2, not 1"):
        write_page(simulate(scene.lanes[0].chain(), scene.lanes[0].velocity), scene, tmp_path / "page.html")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["render", "page"])
def test_the_command_reports_the_page(softcradle, tmp_path, command):
    printed = softcradle(command, "two-on-two", "-o", str(tmp_path / "two.html")).out
    assert printed.startswith(f"written: {tmp_path / 'two.html'}, a page of ")
    assert [path.name for path in tmp_path.iterdir()] == ["two.html"]
