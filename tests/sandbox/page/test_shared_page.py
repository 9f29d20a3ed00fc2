"""Tests of the web page as a file. The page plays a recorded motion and loads no other files.

A failed attempt to write the page must leave no file.
"""

import base64
import gzip
import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from softcradle.physics.state import from_anchor
from softcradle.sandbox.draw.shared_scales import axis_range
from softcradle.sandbox.files import resource
from softcradle.sandbox.page import document, render_page, scene_text, write_page
from softcradle.sandbox.page.data import LINE_ERROR, SAME_DEPTH, USUAL_BYTES, needed_rows, packed_lanes
from softcradle.sandbox.page.played_motion import played_motion, recorded_sentence
from softcradle.sandbox.page.shared_page import recorded
from softcradle.sandbox.page.svg_charts import ChartAxes, Curve, line_chart
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.session import inputs
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Lane, Scene
from softcradle.scenes.catalogue import parse

from softcradle import one_on, power_law, simulate
from tests.helpers.sessions import opened
from tests.sandbox.page.conftest import SOFT, TagChecker, page_data

SCENES = ("one-on-four", "galilean", "draft-gear-two-on-two", "hertz-cradle", "mixed", "stiff-springs", "weak-contact")


@pytest.mark.parametrize("name", ["one-on-four", "two-on-two", "hertz-cradle", "draft-gear-one-on-three"])
def test_a_live_page_is_small_and_loads_nothing(pages, name):
    report = pages(name)
    assert report.computed
    assert report.size == report.output.stat().st_size < 150_000  # The limit of the file size is 150 000 bytes.
    assert len(gzip.compress(report.output.read_bytes())) < 65_000
    text = report.output.read_text(encoding="utf-8")
    checker = TagChecker(text)
    assert [link.partition(",")[0] for link in checker.links] == ["data:image/svg+xml"]
    assert len(set(checker.ids)) == len(checker.ids)
    assert "default-src 'none'" in text


def test_the_minified_script_is_up_to_date_and_small():
    sources, minified = document.page_sources(), resource(document.MINIFIED).read_text(encoding="utf-8")
    assert minified.startswith(document.digest_line(sources)), "run: make page-script"
    assert document.page_script() in minified
    assert len(minified) < 0.6 * len(sources)
    shared = re.findall(r"^(?:async )?(?:class|function|const|let) (\w+)", sources, re.MULTILINE)
    assert [name for name in shared if not re.search(rf"\b{name}\b", minified)] == []


def test_edited_scripts_are_used_until_they_are_minified(monkeypatch):
    monkeypatch.setattr(document, "page_sources", lambda: "edited")
    assert document.page_script() == "edited"


@pytest.mark.parametrize(("losses", "uniform"), [((0.5, 0.5, 0.5), True), ((0.0, 0.0, 0.5), False)])
def test_a_row_can_be_longer_if_its_contacts_are_alike(losses, uniform):
    contacts = [SOFT | {"loss": loss} for loss in losses]
    scene = Scene(title="a row", lanes=(Lane(contact=contacts, velocity=[1, 0, 0, 0]),))
    assert (page_data(scene_text(scene)[0])["uniform"] is not None) is uniform


@pytest.mark.parametrize("speeds", [(0.01, 0.0), (0.0, 0.01)])
def test_a_lane_at_rest_has_no_part_in_the_speed_of_a_page(speeds):
    scene = Scene(title="rows", lanes=tuple(Lane(contact=SOFT, velocity=[speed, 0, 0]) for speed in speeds))
    data = page_data(scene_text(scene)[0])
    assert [data["speed"], data["own"]["speed"]] == [0.01, 0.01]


def test_a_page_with_a_method_is_a_recording_with_its_warnings(tmp_path):
    scene = load_scene("one-on-four")
    chain, velocity = scene.lanes[0].chain(), scene.lanes[0].velocity
    report = render_page(scene, tmp_path / "page.html", method="radau")
    text = report.output.read_text(encoding="utf-8")
    assert not report.computed
    assert all(f"{value:.8f}" in text for value in simulate(chain, velocity, method="radau").final_velocity)
    assert "Recorded motion, computed by radau, tolerance 1e-08; " in text
    with pytest.warns(RuntimeWarning) as warned:
        found = simulate(chain, velocity, method="verlet", step=0.05)
    text = write_page(found, scene, tmp_path / "page.html").output.read_text(encoding="utf-8")
    assert str(warned[0].message).replace("'", "&#x27;") in text
    assert "computed by verlet, step 0.050 s" in text


@pytest.mark.parametrize("name", ["one-on-four", "train-starting"])
def test_a_played_page_shows_only_known_errors(name):
    session = opened(name, frames=20)
    session.apply(inputs.SetVelocity(0, 0, 6.0))
    session.step_frames(20)
    found = session.trajectory(0)
    assert "; energy error " in recorded_sentence(found)
    unknown = replace(found, given=np.full_like(found.given, np.nan))
    assert recorded_sentence(unknown).endswith(" s")


def test_labels_of_users_are_text_not_markup():
    evil = "</script><script>alert(1)</script>"
    lane = f'label = "{evil}"\nbeads = [1, 1]\nvelocity = 1.0\ncontact = {{law = "hertz", stiffness = 1.0}}\n'
    scene = parse(f'title = "<b>&x"\ntext = "{evil}"\nsource = "{evil}"\n[[lanes]]\n{lane}[[lanes]]\n{lane}')
    text, _ = scene_text(scene)
    TagChecker(text)
    assert "<script>alert" not in text
    assert "<b>" not in text
    assert page_data(text)["texts"]["en"] == {
        "title": "<b>&x",
        "source": evil,
        "text": evil,
        "question": "",
        "labels": [evil, evil],
    }


@pytest.mark.parametrize("command", ["render", "page"])
def test_the_command_reports_the_page(softcradle, tmp_path, command):
    printed = softcradle(command, "two-on-two", "-o", str(tmp_path / "two.html")).out
    assert printed.startswith(f"written: {tmp_path / 'two.html'}, a page of ")
    assert [path.name for path in tmp_path.iterdir()] == ["two.html"]


def test_a_page_with_an_address_has_a_picture_for_previews_of_links(softcradle, tmp_path):
    address = "https://example.org/a/two.html"
    softcradle("page", "two-on-two", "-o", str(tmp_path / "two.html"), "--address", address)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["two.html", "two.png"]
    with Image.open(tmp_path / "two.png") as picture:
        assert picture.size == (1200, 630)
    text = (tmp_path / "two.html").read_text(encoding="utf-8")
    tags = dict(re.findall(r'<meta property="og:(\w+)" content="([^"]*)">', text))
    assert tags["url"] == address
    assert tags["image"] == "https://example.org/a/two.png"
    assert tags["title"] == "Two beads on two"
    assert len(tags["description"]) > 50
    wrong = softcradle("page", "two-on-two", "-o", str(tmp_path / "two.html"), "--address", "example.org", code=2)
    assert "must begin with https://" in wrong.err


def played(name):
    scene = load_scene(name)
    return played_motion(scene, recorded(scene))


def unpacked(packed, scales, beads):
    """Return the decoded samples of one row of beads: time, anchor position, energies, overlaps, velocities and forces.

    The samples are decoded in the same way as in the script of the page.
    """
    data, rows = base64.b64decode(packed["data"]), packed["rows"]
    split = 4 * rows * (beads + 3)
    floats = np.frombuffer(data[:split], "<f4").astype(float).reshape(-1, rows)
    codes = np.frombuffer(data[split:], "<i2").astype(float).reshape(-1, rows) / 32767
    velocity, force = codes[:beads].T * max(map(abs, scales.velocity)), codes[beads:].T * scales.force
    return floats[0], floats[1], floats[2:4].T, floats[4:].T * packed["depth"], velocity, force


@pytest.mark.parametrize(
    "name", [*SCENES[:6], pytest.param(SCENES[6], marks=pytest.mark.slow), "experiment-two-on-two"]
)
def test_packed_samples_follow_the_recorded_motion(name):
    motion = played(name)
    scales = motion.scales
    # Absolute tolerance of overlaps: a tenth of the lower end of their axis.
    smallest = 10.0 ** (scales.decades[0] - 1)
    for found, packed in zip(motion.motions, packed_lanes(motion.motions, scales, USUAL_BYTES), strict=True):
        time, anchor, energies, overlap, velocity, force = unpacked(packed, scales, found.chain.contacts + 1)
        absorbed = found.absorbed if found.absorbed.size else np.zeros(found.time.size)
        position = from_anchor(overlap, anchor, found.chain.anchor)
        for read, true, error in (
            (position, found.position, LINE_ERROR * np.ptp(scales.window)),
            (velocity, found.velocity, (LINE_ERROR + 2e-5) * np.ptp(scales.velocity)),
            (force, found.force, (LINE_ERROR + 2e-5) * scales.force),
            (energies, np.column_stack([found.stored, absorbed]), LINE_ERROR * scales.energy),
        ):
            for column, curve in zip(read.T, true.T, strict=True):
                apart = np.abs(np.interp(found.time, time, column) - curve)
                jumps = np.flatnonzero(np.abs(np.diff(curve)) > 5 * error)
                # Samples near a step are left out. The two samples of a step can have the same time after rounding to
                # 32-bit floats.
                near_jump = np.abs(found.time[:, None] - found.time[jumps]).min(axis=1, initial=1e9)
                assert apart[near_jump > 1e-6 * found.time[-1]].max() < 1.2 * error
        for read, true in zip(overlap.T, found.overlap.T, strict=True):
            deep = true > 1e-3 * true.max()
            lines = np.interp(found.time[deep], time, read)
            np.testing.assert_allclose(lines, true[deep], rtol=2 * SAME_DEPTH, atol=smallest)
        # A bead at rest must not creep because of rounded velocities.
        assert (velocity[0, found.velocity[0] == 0.0] == 0.0).all()
        assert (force[0, found.force[0] == 0.0] == 0.0).all()
        assert len(time) < len(found.time) / 2


def test_a_page_adds_free_flight_before_and_after_the_samples():
    scene = Scene(title="in touch", lanes=(Lane(contact=SOFT, velocity=[1, 0, 0]),))
    (end,) = recorded(scene)
    (motion,) = played_motion(scene, [end]).motions
    assert motion.time[0] < 0.0
    assert (motion.velocity[0] == [1.0, 0.0, 0.0]).all()
    assert motion.time[-1] > end.time[-1]
    np.testing.assert_allclose(motion.velocity[-1], end.final_velocity, atol=1e-12)
    drift = motion.position[-1] - motion.position[-2] - motion.velocity[-1] * (motion.time[-1] - motion.time[-2])
    assert np.abs(drift).max() < 1e-12
    few = simulate(one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0], duration=1.0, samples=3)
    (motion,) = played_motion(load_scene("one-on-four"), [few]).motions
    assert motion.time[-3:].tolist() == [0.0, 0.5, 1.0]


def test_lanes_begin_at_the_last_edit_of_all():
    session = opened("steel-and-soft", frames=30)
    session.apply(inputs.SetFriction(1, 0.01))
    session.step_frames(30)
    found = [session.trajectory(lane) for lane in (0, 1)]
    assert found[0].time[0] < found[1].time[0]
    first, second = played_motion(session.shown_scene(), found).motions
    np.testing.assert_array_equal(first.time, second.time)
    np.testing.assert_array_equal(first.position, found[0].position[-first.time.size :])


@pytest.mark.parametrize("edits", [(), (inputs.SetVelocity(0, 4, 1.5),), (inputs.Drag(0, 4, 6.0), inputs.Drop())])
def test_the_page_of_a_row_that_a_hand_has_moved_says_so(tmp_path, edits):
    """Check that a chain is marked as driven if a bead was moved by hand.

    The comparison with the collision of two rigid bodies does not apply to such a chain.
    """
    session = opened(frames=20)
    for edit in edits:
        session.apply(edit)
        session.step_frames(2)
    written = write_page(session.trajectory(0), session.shown_scene(), tmp_path / "page.html").output
    (lane,) = page_data(written.read_text(encoding="utf-8"))["lanes"]
    assert lane["driven"] is bool(edits)


def test_a_long_motion_gets_coarser_samples_or_is_rejected(monkeypatch):
    motion = played("one-on-four")
    (fine,) = packed_lanes(motion.motions, motion.scales, USUAL_BYTES)
    (coarse,) = packed_lanes(motion.motions, motion.scales, 8000)
    assert coarse["rows"] < fine["rows"]
    assert len(coarse["data"]) <= 8000 * 4 / 3 + 4
    monkeypatch.setattr("softcradle.sandbox.page.data.MOST_BYTES", 500)
    with pytest.raises(UserError, match="5 beads is too much for one page"):
        packed_lanes(motion.motions, motion.scales, 400)


def test_thinned_curves_keep_their_jumps():
    x = np.linspace(0.0, 1.0, 20_001)
    y = np.where(x < 0.50003, 0.0, 1.0)
    axes = ChartAxes((0.0, 1.0), axis_range([y]), "x", "y")
    drawn = re.search(r'd="M([^"]+)"><title>one', line_chart("t", [Curve("one", x, y, "c0")], axes))[1]
    points = np.array([[float(v) for v in pair.split(",")] for pair in drawn.split("L")])
    assert len(points) < 600
    (jump,) = np.flatnonzero(np.abs(np.diff(points[:, 1])) > 50.0)
    assert points[jump + 1, 0] - points[jump, 0] < 0.2


def test_rows_at_one_time_are_kept():
    """Check that two samples at the same time are kept.

    A force with a step has one sample before the step and one after it. Both samples can have the same time.
    """
    time = np.array([0.0, 0.5, 0.5, 0.5, 1.0])
    values = np.array([[0.0], [0.0], [1.0], [3.0], [3.0]])
    assert needed_rows(time, values, np.full((5, 1), 1e-6)).tolist() == [0, 1, 2, 3, 4]
