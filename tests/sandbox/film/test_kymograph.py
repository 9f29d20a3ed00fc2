"""Kymographs from camera frames agree with the motion to a pixel; scale bars; what is refused."""

import numpy as np
import pytest
from PIL import Image
from softcradle.sandbox.draw import scales_of
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.film import kymograph
from softcradle.sandbox.film.kymograph import CAMERA_RATE, SlitCamera, filmed_scene, instants, render_kymograph
from softcradle.sandbox.film.scene_motion import motion_end, scene_motions
from softcradle.scenes import load, names
from softcradle.scenes.catalogue import parse

WIDTH = 420
BALL = '{law = "hertz", stiffness = 5.0}'
DARK = 60  # sum of red, green and blue below which a pixel is a marker's


def filmed(name, rate, number=0, width=WIDTH):
    scene = load(name)
    scene = filmed_scene(scene, motion_end(scene))
    motions = scene_motions(scene, rate)
    camera = SlitCamera(scene, number, scales_of(scene, motions), width)
    motion = motions[number]
    return camera, motion, kymograph.stacked(camera, motion), traced(camera, motion)


def traced(camera, motion):
    """(T, WIDTH, 3) the kymograph from the motion alone: black where a marker covers a pixel, white elsewhere."""
    edges = np.arange(camera.frame.get_width())
    covered = np.zeros((len(motion.time), len(edges)))
    for place in camera.markers(motion).T:
        left, right = place[:, None] - camera.marker / 2, place[:, None] + camera.marker / 2
        covered += np.clip(np.minimum(right, edges + 1.0) - np.maximum(left, edges), 0.0, 1.0)
    shade = np.round(255.0 * (1.0 - np.minimum(covered, 1.0))).astype(np.uint8)
    return np.repeat(shade[..., None], 3, axis=2)


def middles(line):
    """Middles of the black stretches in a line (WIDTH, 3) [pixels]."""
    darkness = np.clip(255.0 - line.astype(float).max(axis=1), 0.0, 255.0) / 255.0
    black = line.astype(int).sum(axis=1) < DARK
    edges = np.flatnonzero(np.diff(np.concatenate(([0], black.astype(int), [0]))))
    assert darkness[black].min() > 0.7
    return np.array([0.5 * (a + b) for a, b in zip(edges[::2], edges[1::2], strict=True)])


@pytest.mark.parametrize(
    ("name", "rate", "number"),
    [
        ("draft-gear-one-on-three", CAMERA_RATE, 0),
        ("draft-gear-two-on-two", CAMERA_RATE, 0),
        ("one-on-four", 60.0, 0),
        ("galilean", 60.0, 0),
        ("hertz-cradle", 40.0, 0),
        ("beads-against-gear", CAMERA_RATE, 1),
    ],
)
def test_frames_and_trajectory_agree_to_a_pixel(name, rate, number):
    camera, motion, frames, direct = filmed(name, rate, number)
    assert frames.shape == direct.shape == (len(motion.time), WIDTH, 3)
    places = camera.markers(motion)
    moved = np.ptp(places, axis=0).max()
    assert moved > 20.0  # a camera that shows no motion would fail here
    for seen, drawn, where in zip(frames, direct, places, strict=True):
        from_frames, from_trajectory = middles(seen), middles(drawn)
        assert len(from_frames) == len(from_trajectory) == len(where)  # a marker on every bead, none hidden
        assert np.abs(from_frames - from_trajectory).max() <= 1.0
        assert np.abs(from_frames - where).max() <= 1.0


def test_a_wall_has_no_marker():
    lane = f"mass = [1.0, inf]\nvelocity = [1.0, 0.0]\ncontact = {BALL}\ngap = 1.0\n"
    scene = parse(f'title = "Wall"\nduration = 4.0\n[[lanes]]\n{lane}')
    motions = scene_motions(scene, 20.0)
    camera = SlitCamera(scene, 0, scales_of(scene, motions), WIDTH)
    assert camera.markers(motions[0]).shape == (len(motions[0].time), 1)
    assert len(middles(camera.line(motions[0], 0))) == 1


def test_the_paper_s_camera_where_units_are_the_paper_s():
    si = {name for name in names() if kymograph.in_si(load(name))}
    assert {"draft-gear-one-on-three", "draft-gear-two-on-two"} <= si
    assert not {"one-on-four", "hooke-interface", "mixed"} & si
    scene = load("draft-gear-one-on-three")
    assert kymograph.camera_rate(filmed_scene(scene, 0.06), 0.06, 1137) == CAMERA_RATE
    every = CAMERA_RATE / kymograph.camera_rate(filmed_scene(scene, 6.0), 6.0, 1137)  # of so many frames one
    assert every == pytest.approx(round(every), rel=1e-12)
    assert kymograph.camera_rate(load("one-on-four"), 3.0, 1000) == pytest.approx(1000 / (3.0 * 1.6))


def bar_lengths(picture):
    """Longest horizontal and vertical bars outside the kymograph: (pixels below, pixels on the right)."""
    black = (picture == np.array(tones.foreground)).all(axis=2)
    below = max(int(row.sum()) for row in black[-60:-40])
    right = max(int(column.sum()) for column in black[100:-62, -118:-90].T)
    return below, right


def test_scale_bars_are_100_ms_and_12_cm(tmp_path):
    path = tmp_path / "x.kymograph.png"
    scene = load("draft-gear-one-on-three")
    report = render_kymograph(scene, str(path))
    with Image.open(path) as opened:
        picture = np.asarray(opened.convert("RGB"))
    assert picture.shape == (720, 1280, 3)
    below, right = bar_lengths(picture)
    width = 1280 - 2 * 28 - 92
    assert below == pytest.approx(0.1 * CAMERA_RATE * width / report.frames, abs=2)
    seen = filmed_scene(scene, motion_end(scene))
    low, high = scales_of(seen, scene_motions(seen, CAMERA_RATE)).window
    tall = 720 - 80 - 58 - 24 - 14
    assert right == pytest.approx(0.12 / (high - low) * tall, abs=2)


def test_release_and_first_touch_are_marked(tmp_path):
    """Dotted lines of the foreground across the lane: at t = 0, and where 20 mm at 0.5 m/s are flown."""
    path, scene = tmp_path / "x.kymograph.png", load("draft-gear-two-on-two")
    motions = scene_motions(filmed_scene(scene, motion_end(scene)), CAMERA_RATE)
    in_touch = parse(f'title = "x"\n[[lanes]]\nbeads = 2\nvelocity = [1.0, 0.0]\ncontact = {BALL}')
    (touching,) = scene_motions(filmed_scene(in_touch, motion_end(in_touch)), 30.0)
    assert touching.time[0] < 0.0
    assert [name for name, _ in instants(touching)] == ["first touch"]  # it is not released
    (first, release), (second, touch) = instants(motions[0])
    assert (first, second) == ("release", "first touch")
    assert release == 0
    assert motions[0].time[touch] == pytest.approx(0.04, abs=1.0 / CAMERA_RATE)
    report = render_kymograph(scene, str(path))
    with Image.open(path) as opened:
        picture = np.asarray(opened.convert("RGB"))
    dotted = (picture[110:640] == np.array(tones.foreground)).all(axis=2).sum(axis=0) > 0.4 * 530
    width = 1280 - 2 * 28 - 92
    assert [28, 28 + round(width * touch / report.frames)] == np.flatnonzero(dotted[: 28 + width]).tolist()


def test_command(tmp_path, softcradle):
    path = tmp_path / "x.kymograph.png"
    assert "camera frames" in softcradle("render", "galilean", "-o", str(path), "--size", "640x360", "--fps", "30").out
    with Image.open(path) as picture:
        assert picture.size == (640, 360)
    assert [file.name for file in tmp_path.iterdir()] == ["x.kymograph.png"]
