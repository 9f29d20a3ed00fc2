"""Kymographs from camera frames agree with the motion to a pixel; scale bars, marks, and the command."""

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


def filmed(scene, rate=CAMERA_RATE):
    """The scene as a kymograph has it, and its motions by a camera of that rate."""
    scene = filmed_scene(scene, motion_end(scene))
    return scene, scene_motions(scene, rate)


def middles(line):
    """Middles of the black stretches in a line (WIDTH, 3) [pixels]."""
    black = line.astype(int).sum(axis=1) < 60  # such a sum of red, green and blue is a marker's
    return np.flatnonzero(np.diff(black, prepend=False, append=False)).reshape(-1, 2).mean(axis=1)


@pytest.mark.parametrize(
    ("name", "rate", "number"),
    [("draft-gear-one-on-three", CAMERA_RATE, 0), ("galilean", 60.0, 0), ("beads-against-gear", CAMERA_RATE, 1)],
)
def test_frames_and_trajectory_agree_to_a_pixel(name, rate, number):
    scene, motions = filmed(load(name), rate)
    motion, camera = motions[number], SlitCamera(scene, number, scales_of(scene, motions), WIDTH)
    frames = kymograph.stacked(camera, motion)
    assert frames.shape == (len(motion.time), WIDTH, 3)
    places = camera.markers(motion)
    assert np.ptp(places, axis=0).max() > 20.0  # a camera that shows no motion would fail here
    for seen, where in zip(frames, places, strict=True):
        found = middles(seen)
        assert len(found) == len(where)  # a marker on every bead, none hidden
        assert np.abs(found - where).max() <= 1.0


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


def test_the_picture_has_scale_bars_of_100_ms_and_12_cm_and_marks_release_and_first_touch(tmp_path):
    """Dotted lines of the foreground across the lane: at t = 0, and where 20 mm at 0.5 m/s are flown."""
    path, (scene, (motion,)) = tmp_path / "x.kymograph.png", filmed(load("draft-gear-two-on-two"))
    frames = render_kymograph(load("draft-gear-two-on-two"), str(path)).frames
    with Image.open(path) as opened:
        picture = np.asarray(opened.convert("RGB"))
    assert picture.shape == (720, 1280, 3)
    black = (picture == np.array(tones.foreground)).all(axis=2)
    across, tall = 1280 - 2 * 28 - 92, 720 - 80 - 58 - 24 - 14  # pixels of the kymograph
    below, right = black[-60:-40].sum(axis=1).max(), black[100:-62, -118:-90].sum(axis=0).max()
    assert below == pytest.approx(0.1 * CAMERA_RATE * across / frames, abs=2)
    assert right == pytest.approx(0.12 / np.ptp(scales_of(scene, [motion]).window) * tall, abs=2)
    (first, release), (second, touch) = instants(motion)
    assert (first, second, release) == ("release", "first touch", 0)
    assert motion.time[touch] == pytest.approx(0.04, abs=1.0 / CAMERA_RATE)
    dotted = black[110:640].sum(axis=0) > 0.4 * 530
    assert [28, 28 + round(across * touch / frames)] == np.flatnonzero(dotted[: 28 + across]).tolist()


def test_what_is_in_touch_at_the_start_is_not_released_nor_is_a_train_that_begins_to_pull():
    in_touch = parse(f'title = "x"\n[[lanes]]\nbeads = 2\nvelocity = [1.0, 0.0]\ncontact = {BALL}')
    _, (touching,) = filmed(in_touch, 30.0)
    assert touching.time[0] < 0.0
    assert [name for name, _ in instants(touching)] == ["first touch"]
    assert not instants(scene_motions(load("train-starting"), 5.0)[0])


@pytest.mark.parametrize("velocity", ["[0.0, 1.0, 2.0]", "[0.0, 0.0, 0.0]"])
def test_beads_that_never_touch_are_shown_for_a_bead_s_length(velocity, tmp_path):
    scene = parse(f'title = "x"\n[[lanes]]\nvelocity = {velocity}\ngap = 1.0\ncontact = {BALL}')
    render_kymograph(scene, str(tmp_path / "x.kymograph.png"))
    (motion,) = scene_motions(filmed_scene(scene, 0.0), CAMERA_RATE)
    assert motion.time[-1] == pytest.approx(0.5 if "2.0" in velocity else 1.0, abs=1e-3)
    assert instants(motion) == [("release", 0)]


def test_command(tmp_path, softcradle):
    path = tmp_path / "x.kymograph.png"
    assert "camera frames" in softcradle("render", "galilean", "-o", str(path), "--size", "640x360", "--fps", "30").out
    with Image.open(path) as picture:
        assert picture.size == (640, 360)
    assert [file.name for file in tmp_path.iterdir()] == ["x.kymograph.png"]
