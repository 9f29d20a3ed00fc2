"""Tests of kymographs, which are pictures of positions over time.

The tests check that the camera frames agree with the motion to one pixel. The tests also check scale bars, marks and
the command.
"""

import numpy as np
import pytest
from PIL import Image
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.shared_scales import scales_of
from softcradle.sandbox.film import kymograph
from softcradle.sandbox.film.kymograph import CAMERA_RATE, SlitCamera, filmed_scene, instants, render_kymograph
from softcradle.sandbox.film.scene_motion import motion_end, scene_motions
from softcradle.scenes import load, names
from softcradle.scenes.catalogue import parse

WIDTH = 420
BALL = '{law = "hertz", stiffness = 5.0}'
IN_TOUCH = f'title = "x"\n[[lanes]]\nbeads = 2\nvelocity = [1.0, 0.0]\ncontact = {BALL}'


def filmed(scene, rate=CAMERA_RATE):
    """Return the scene of a kymograph and its motions, sampled with the frame rate `rate`."""
    scene = filmed_scene(scene, motion_end(scene))
    return scene, scene_motions(scene, rate)


WALL = f"duration = 4.0\n[[lanes]]\nmass = [1.0, inf]\nvelocity = [1.0, 0.0]\ncontact = {BALL}\ngap = 1.0\n"
FILMED = [
    (load("draft-gear-one-on-three"), CAMERA_RATE, 0),
    (load("galilean"), 60.0, 0),
    (load("beads-against-gear"), CAMERA_RATE, 1),
    (parse(f'title = "Wall"\n{WALL}'), 20.0, 0),
]


@pytest.mark.parametrize(("scene", "rate", "number"), FILMED)
def test_frames_and_trajectory_agree_to_a_pixel(scene, rate, number):
    scene, motions = filmed(scene, rate)
    motion, camera = motions[number], SlitCamera(scene, number, scales_of(scene, motions), WIDTH)
    frames = kymograph.stacked(camera, motion)
    assert frames.shape == (len(motion.time), WIDTH, 3)
    places, marked = camera.markers(motion), np.isfinite(motion.chain.mass).sum()
    # The beads must move more than 20 pixels. Otherwise a camera that ignores the motion would pass the test.
    assert np.ptp(places, axis=0).max() > 20.0
    # Only in the markers on the beads is the sum of red, green and blue below 60.
    for black, where in zip(frames.sum(axis=2, dtype=int) < 60, places, strict=True):
        found = np.flatnonzero(np.diff(black, prepend=False, append=False)).reshape(-1, 2).mean(axis=1)
        assert len(found) == len(where) == marked  # Every bead has one marker, and walls are not marked.
        assert np.abs(found - where).max() <= 1.0


def test_the_paper_s_camera_where_units_are_the_paper_s():
    si = {name for name in names() if kymograph.in_si(load(name))}
    assert {"draft-gear-one-on-three", "draft-gear-two-on-two"} <= si
    assert not {"one-on-four", "hooke-interface", "mixed"} & si
    scene = load("draft-gear-one-on-three")
    assert kymograph.camera_rate(filmed_scene(scene, 0.06), 0.06, 1137) == CAMERA_RATE
    # Factor by which the frame rate of the camera is reduced for a long motion.
    every = CAMERA_RATE / kymograph.camera_rate(filmed_scene(scene, 6.0), 6.0, 1137)
    assert every == pytest.approx(round(every), rel=1e-12)
    # The first scene starts with free flight before the collision, and the second one does not.
    for scene in load("one-on-four"), parse(IN_TOUCH):
        end = motion_end(scene)
        rows = scene_motions(scene, kymograph.camera_rate(scene, end, 1000), end=end)[0].time
        # The motion has one sample for each of the 1000 columns of the kymograph.
        assert len(rows) == pytest.approx(1000, abs=2)


def test_a_kymograph_has_scale_bars_and_marks(tmp_path, softcradle):
    """Check the scale bars, and the two dotted lines across the kymograph.

    The first line is at t = 0. The second line is at the time at which a bead has moved 20 mm with 0.5 m/s.
    """
    # Frame rate [frames/s], half of the frame rate of the camera in the paper.
    path, rate = tmp_path / "x.kymograph.png", 1026.0
    scene, (motion,) = filmed(load("draft-gear-two-on-two"), rate)
    words = "--size", "1440x720", "--fps", str(rate)
    assert "camera frames" in softcradle("render", "draft-gear-two-on-two", "-o", str(path), *words).out
    assert [file.name for file in tmp_path.iterdir()] == [path.name]
    frames = len(motion.time)
    with Image.open(path) as opened:
        picture = np.asarray(opened.convert("RGB"))
    assert picture.shape == (720, 1440, 3)
    black = (picture == np.array(tones.foreground)).all(axis=2)
    # Width and height of the kymograph without its margins [pixels].
    across, tall = 1440 - 2 * 28 - 92, 720 - 80 - 58 - 24 - 14
    below, right = black[-60:-40].sum(axis=1).max(), black[100:-62, -118:-90].sum(axis=0).max()
    assert below == pytest.approx(0.1 * rate * across / frames, abs=2)
    assert right == pytest.approx(0.12 / np.ptp(scales_of(scene, [motion]).window) * tall, abs=2)
    (first, release), (second, touch) = instants(motion)
    assert (first, second, release) == ("release", "first touch", 0)
    assert motion.time[touch] == pytest.approx(0.04, abs=1.0 / rate)
    dotted = black[110:640].sum(axis=0) > 0.4 * 530
    assert [28, 28 + round(across * touch / frames)] == np.flatnonzero(dotted[: 28 + across]).tolist()


def test_beads_in_touch_at_the_start_have_no_release():
    _, (touching,) = filmed(parse(IN_TOUCH), 30.0)
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
