"""Tests of films: the frames in the file, the encoding by several threads, and error messages.

Also check that a film file is either complete or absent.
"""

import math
import threading
from unittest.mock import Mock

import av
import numpy as np
import pygame
import pytest
from PIL import Image, ImageSequence
from softcradle.physics.simulation import solve
from softcradle.sandbox.draw.scene_picture import Picture
from softcradle.sandbox.draw.shared_scales import longest_lead
from softcradle.sandbox.film import encoder, formats, scene_film, scene_motion
from softcradle.sandbox.film.encoder import open_film, segment_lengths
from softcradle.sandbox.film.formats import pixels_of
from softcradle.sandbox.film.kymograph import render_kymograph
from softcradle.sandbox.film.scene_film import MOST_BEFORE_HIT, film_shots, render_scene, shot_list
from softcradle.sandbox.film.scene_motion import motion_end, scene_motions, scene_motions_quietly, strongest_row
from softcradle.sandbox.page.shared_page import recorded
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Lane, Scene
from softcradle.scenes.catalogue import parse

from softcradle import scenes, simulate
from tests.helpers.drawn_text import colliding, film_texts

SIZE = (480, 270)
FPS = 12.0
ROWS = math.ceil(scene_film.LEAST_ROWS / FPS)  # Number of samples of the motion per frame of the film.
LANES = """
lanes = [{label = "soft", beads = [1, 3], velocity = 1.0, contact = {law = "power_law", f0 = 1.0, alpha = 0.25}},
         {label = "hard", beads = [1, 3], velocity = 1.0, contact = {law = "hertz", stiffness = 30.0}}]
"""
SCENE = parse(f'title = "Two rows"\ntext = "Three words here."\n{LANES}')


@pytest.fixture(scope="module")
def frames():
    motions = scene_motions(SCENE, FPS * ROWS)
    picture, surface = Picture(SCENE, motions, SIZE), pygame.Surface(SIZE, 0, 32)
    drawn = []
    for shot in film_shots(SCENE, motions, FPS, ROWS):
        picture.paint(surface, shot.row, text_opacity=shot.text_opacity)
        drawn.append(pixels_of(surface)[..., 2::-1].copy())
    return np.array(drawn)


def rendered(path, **options):
    return render_scene(SCENE, path, progress=False, **{"size": SIZE, "fps": FPS, **options})


def difference(found, expected):
    """Return the mean colour difference of the frame with the largest difference."""
    return np.abs(found.astype(int) - expected).mean(axis=(1, 2, 3)).max()


@pytest.mark.parametrize(("pixel_format", "tolerance"), [("yuv420p", 2.5), ("yuv444p", 1.5)])
def test_mp4_frame_by_frame(tmp_path, frames, pixel_format, tolerance):
    report = rendered(tmp_path / "film.mp4", pixel_format=pixel_format)
    with av.open(str(tmp_path / "film.mp4")) as container:
        stream = container.streams.video[0]
        found = [frame.to_ndarray(format="rgb24", src_colorspace="ITU709") for frame in container.decode(stream)]
    found, context = np.array(found), stream.codec_context
    assert found.shape == frames.shape
    assert stream.average_rate == FPS
    assert (context.pix_fmt, context.colorspace, context.color_range) == (pixel_format, 1, 1)
    assert (context.color_primaries, context.color_trc) == (1, 1)
    assert difference(found, frames) < tolerance
    assert (report.frames, report.duration) == (len(frames), pytest.approx(len(frames) / FPS))
    assert 0.0 < report.simulated < report.first_frame < report.seconds
    assert [path.name for path in tmp_path.iterdir()] == ["film.mp4"]


def test_gif_frame_by_frame(tmp_path, frames):
    rendered(tmp_path / "film.gif")
    with Image.open(tmp_path / "film.gif") as image:
        assert image.size == SIZE
        shown = [(np.asarray(one.convert("RGB")), one.info["duration"]) for one in ImageSequence.Iterator(image)]
        assert image.info.get("loop", 0) == 0
    assert len(shown) == len(frames)
    ends = np.cumsum([duration for _, duration in shown])
    assert ends[-1] == pytest.approx(1000 * len(frames) / FPS, abs=len(frames))
    places = np.searchsorted(ends, (np.arange(len(frames)) + 0.5) * 1000 / FPS)
    found = np.array([shown[min(k, len(shown) - 1)][0] for k in places])
    assert difference(found, frames) < 0.5
    # A GIF stores the background colour exactly and other colours approximately. The largest measured colour difference
    # is 33.
    background = (frames == np.median(frames[-1], axis=(0, 1))).all(axis=-1)
    assert (found == frames)[background].all()
    assert np.abs(found.astype(int) - frames).max() < 36


def test_single_picture_is_the_moment_of_the_greatest_force(tmp_path):
    assert rendered(tmp_path / "still.png").frames == 1
    assert not pygame.display.get_init(), "no window is needed"
    motions = scene_motions(SCENE, FPS * ROWS)
    surface = pygame.Surface(SIZE, 0, 32)
    Picture(SCENE, motions, SIZE).paint(surface, strongest_row(motions))
    with Image.open(tmp_path / "still.png") as image:
        assert (np.asarray(image.convert("RGB")) == pixels_of(surface)[..., 2::-1]).all()
    # In this scene, the largest forces are pulling forces of couplers.
    starting = scene_motions(scenes.load("train-starting"), 5.0)
    for each in (motions, starting):
        strongest = max(np.abs(motion.force).max() for motion in each)
        assert any(np.abs(motion.force[strongest_row(each)]).max() == strongest for motion in each)
        pulled = [motion.time[np.flatnonzero(motion.force.any(axis=1))[0]] for motion in each if motion.force.any()]
        assert each[0].time[scene_motion.first_force(each)] == min(pulled)


def test_folder_of_pictures(tmp_path, frames):
    rendered(f"{tmp_path}/film/")
    paths = sorted((tmp_path / "film").iterdir())
    assert [path.name for path in paths] == [f"{k:05d}.png" for k in range(len(frames))]
    for path, frame in zip(paths, frames, strict=True):
        with Image.open(path) as image:
            assert (np.asarray(image.convert("RGB")) == frame).all()


def test_the_last_frame_is_shown_long_enough():
    shots = shot_list(SCENE, 20, 10.0)
    opacity = [shot.text_opacity for shot in shots]
    assert opacity == sorted(opacity)
    assert opacity[-1] == 1.0
    assert [shot.row for shot in shots if shot.text_opacity == 0.0] == [*range(20), *[19] * 12]
    assert {shot.row for shot in shots if shot.text_opacity > 0.0} == {19}


@pytest.mark.parametrize("rows_a_frame", [1, 4])
@pytest.mark.parametrize("hit", [0, 1, 7, 60, 99])
def test_a_long_flight_before_the_hit_is_left_out(hit, rows_a_frame):
    shots = shot_list(SCENE.model_copy(update={"text": ""}), 100, 10.0, rows_a_frame, hit)
    before = sum(shot.row < hit for shot in shots)
    assert before <= MOST_BEFORE_HIT * len(shots) + 1
    assert shots[0].row == 0 or before >= MOST_BEFORE_HIT * len(shots) - 2
    assert shots[-1].row == 99


@pytest.mark.slow
@pytest.mark.parametrize("size", [(1280, 720), (854, 480)], ids=str)
@pytest.mark.parametrize("name", scenes.names())
def test_no_text_of_a_film_lies_on_another(name, size):
    scene = scenes.load(name)
    motions, _ = scene_motions_quietly(scene, 30.0 * scene.view.slow)
    last, whole = len(motions[0].time) - 1, pygame.Rect(0, 0, *size)
    for texts in film_texts(scene, motions, size, (0, last // 4, strongest_row(motions), last // 2, last)):
        assert len(texts) > 30
        assert colliding(texts) == []
        assert [text.text for text in texts if not whole.contains(text.rect)] == []


@pytest.mark.parametrize(
    ("name", "options", "sentence"),
    [
        ("film.mp4", {"size": (481, 270)}, "even width and height"), ("film.mp4", {"size": (80, 60)}, "out of range"),
        ("film.mp4", {"size": (20000, 1080)}, "out of range"), ("film.mp4", {"fps": 0.5}, "frames a second"),
        ("film.mp4", {"fps": 1000.0}, "frames a second"), ("film.gif", {"fps": 60.0}, ".gif: 1 to 50 frames a second"),
        ("film.mp4", {"pixel_format": "rgb"}, "unknown pixel format 'rgb'; allowed: yuv420p, yuv444p"),
        ("film.gif", {"pixel_format": "yuv444p"}, ".mp4 only"),
        ("film.mov", {}, "must end in .mp4, .gif, .png or .html"), ("missing/film.mp4", {}, "does not exist"),
        ("missing/film/", {}, "does not exist"), ("film.mp4", {"slow": float("nan")}, "slow motion"),
        ("film.mp4", {"slow": 1e9}, "frames, more than"),
    ],
)  # fmt: skip
def test_errors_come_early_and_leave_no_file(tmp_path, monkeypatch, name, options, sentence):
    if "slow" not in options:
        monkeypatch.setattr(scene_film, "scene_motions", lambda *_, **__: pytest.fail("worked"))
    with pytest.raises(UserError, match=sentence.replace(".", r"\.")) as refused:
        rendered(f"{tmp_path}/{name}", **options)
    assert "\n" not in str(refused.value)
    assert list(tmp_path.iterdir()) == []


def test_a_motion_that_is_not_finite_is_refused():
    lane = Lane(mass=[math.inf, 1, math.inf], velocity=[0, 1, 0], contact={"law": "hertz", "stiffness": 1e6}, gap=1.0)
    with pytest.raises(UserError, match="did not stay finite"):
        scene_motions(Scene(title="Between walls", lanes=(lane,), duration=100.0), FPS, "euler", 0.5)
    blown_up = simulate(lane.chain(), lane.velocity, 100.0, method="euler", step=0.5)
    with pytest.raises(UserError, match="did not stay finite"):
        blown_up.film()


def test_a_full_folder_or_a_missing_codec_is_an_error(tmp_path, monkeypatch):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(UserError, match="not an empty folder"):
        rendered(f"{tmp_path}/")
    absent = tuple(formats.replace(codec, name="no-such-codec") for codec in formats.CODECS)
    monkeypatch.setattr(formats, "CODECS", absent)
    with pytest.raises(UserError, match="built without no-such-codec"):
        rendered(tmp_path / "film.mp4")
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_few_frames_show_the_same_curves(tmp_path, monkeypatch):
    """Check that a film with 5 frames per second shows smooth force curves.

    In an earlier version, the curves of such a film were ramps. The motion now has as many samples as in a film with
    the usual frame rate.
    """
    drawn = Mock(wraps=Picture)
    monkeypatch.setattr(scene_film, "Picture", drawn)
    report = rendered(tmp_path / "few.gif", fps=5, slow=1.0)
    motions = drawn.call_args.args[1]
    assert np.diff(motions[0].time).max() <= 1 / 50 + 1e-12
    assert report.frames < len(motions[0].time) / 5


TIMED = parse(f'title = "Two lanes"\nduration = 2.0\n{LANES}')


def test_the_end_of_a_motion_is_computed_once(monkeypatch, tmp_path):
    runs = Mock(wraps=solve)
    monkeypatch.setattr("softcradle.physics.simulation.solve", runs)
    scene_motions(TIMED, 20.0)
    render_kymograph(SCENE, str(tmp_path / "x.kymograph.png"), (320, 180))
    endless = [run.kwargs.get("duration") is None for run in runs.call_args_list]
    assert endless == [False, False, True, True, False, False]


@pytest.mark.parametrize("scene", [SCENE, TIMED], ids=["endless", "timed"])
def test_rows_cover_the_motion_and_free_flight(scene: Scene):
    end = motion_end(scene)
    first, second = scene_motions(scene, 20.0)
    assert (first.overlap == scene_motions(scene, 20.0, end=end)[0].overlap).all()
    assert (first.time == second.time).all()
    assert np.diff(first.time) == pytest.approx(0.05)
    assert 0.0 in first.time
    after = scene_motion.AFTER * end if scene.duration is None else 0.0
    assert first.time[0] == pytest.approx(-scene_motion.LEAD * end, abs=0.05)
    assert first.time[-1] == pytest.approx(end + after, abs=0.05)
    early = first.time < 0.0
    assert first.position[early, 0] == pytest.approx(first.time[early])
    assert (first.position[early, 1:] == 0.0).all()
    assert (first.force[early] == 0.0).all()
    assert first.energy_error[early].max() == 0.0
    assert longest_lead(first.chain, np.array([1.0, 0.0, 0.0, 0.0])) == math.inf
    assert longest_lead(first.chain, np.array([0.0, 0.0, 0.0, 1.0])) == 0.0


def three(law, stiffness, gap):
    contact = {"law": law, "stiffness": stiffness}
    return Scene(title="Three", lanes=[Lane(velocity=[1, 0, 0], gap=gap, contact=contact)])


def test_a_film_ends_before_a_pause_that_no_one_waits_for():
    """Check that a film does not wait for a collision of very slow beads.

    Explicit integrators leave relative velocities that are a million times smaller than the speed of the collision.
    """
    scene = three("hooke", 1e3, [0.7, 0.3])
    with pytest.warns(RuntimeWarning, match=r"shown up to t = .* slow beads would meet again at t = .*e\+0"):
        end = motion_end(scene, "verlet", 1 / 500)
    usual = motion_end(scene)
    assert 0.5 * usual < end < 2.0 * usual
    with pytest.warns(RuntimeWarning, match="slow beads would meet again"):
        (page,) = recorded(scene, method="verlet", step=1 / 500)
    assert page.time[-1] == end


def test_the_number_of_frames_is_limited(tmp_path, monkeypatch):
    monkeypatch.setattr(scene_motion, "MOST_FRAMES", 60)
    monkeypatch.setattr(scene_motion, "MOST_ROWS", 60)
    long = {"slow": 5.0, "size": (320, 180)}
    with pytest.raises(UserError, match=r"the film would have \d+ frames, more than 60: choose less slow motion"):
        rendered(tmp_path / "film.gif", **long)
    assert rendered(tmp_path / "still.png", **long).frames == 1
    (motion, _) = scene_motions(SCENE, 60.0)
    assert len(motion.time) == pytest.approx(60, abs=2)
    assert 0.0 in motion.time
    few = rendered(
        tmp_path / "few.gif", fps=1, **long
    )  # The motion has more samples than this film has frames, because the force curves need them.
    assert few.frames < 60
    with pytest.raises(
        UserError, match=r"the kymograph would have \d+ frames, .*: choose fewer frames a second \(--fps\)"
    ):
        render_kymograph(SCENE, str(tmp_path / "x.kymograph.png"), (320, 180), fps=1e3)


def test_beads_that_are_far_apart_have_all_the_time_that_they_need():
    far = three("hertz", 1e6, [0, 50])
    assert motion_end(far) > 50.0
    assert scene_motions(far, 1.0)[0].time[-1] > 50.0


# The output of x264 with AVX-512 is bitwise reproducible only if half the picture width is a multiple of 64.
WIDE = (640, 360)
FRAMES = 130


def six_segments(monkeypatch, cores):
    """Divide a film of FRAMES frames into six segments, and encode it with `cores` threads."""
    monkeypatch.setattr(encoder, "SEGMENT_FRAMES", 22)
    monkeypatch.setattr(encoder, "SHORTEST_SEGMENT", 10)
    monkeypatch.setattr(encoder, "cores", lambda: cores)


def paint(surface, number):
    """Draw a frame that is different for each `number`. The position of a bar and the background colour depend on
    `number`.
    """
    surface.fill((number, 40, 200 - number))
    surface.fill((250, 250, 120), (4 * number, 60, 80, 200))


def written(path, cores, monkeypatch):
    six_segments(monkeypatch, cores)
    with open_film(path, WIDE, 30.0) as film:
        film.paint_frames(range(FRAMES), paint)
    return path


def test_segments_of_a_film_are_equal_on_any_number_of_cores(tmp_path, monkeypatch):
    films = [written(tmp_path / f"{cores}.mp4", cores, monkeypatch) for cores in (1, 2, 3, 8)]
    assert len({film.read_bytes() for film in films}) == 1
    with av.open(str(films[0])) as container:
        stream = container.streams.video[0]
        assert stream.frames == FRAMES
        assert float(stream.duration * stream.time_base) == pytest.approx(FRAMES / 30.0)
        found = list(container.decode(stream))
        container.seek(int(3.0 / stream.time_base), stream=stream)
        assert 2.0 < next(container.decode(stream)).time <= 3.0
    assert [round(frame.time * 30) for frame in found] == list(range(FRAMES))
    surface = pygame.Surface(WIDE, 0, 32)
    for number, frame in enumerate(found):
        paint(surface, number)
        picture = frame.to_ndarray(format="rgb24", src_colorspace="ITU709").astype(int)
        assert np.abs(picture - pixels_of(surface)[..., 2::-1]).mean() < 3.0, number
    keys = [k for k, frame in enumerate(found) if frame.key_frame]
    assert keys == np.cumsum([0, *segment_lengths(FRAMES)[:-1]]).tolist()


def test_a_picture_that_stays_is_drawn_once_a_segment(tmp_path, monkeypatch):
    """Check that a repeated picture is drawn only once in each segment of the film.

    The file must be equal to the file of a film in which every frame is drawn.
    """
    pictures = [0] * 50 + list(range(1, 31)) + [30] * 49
    six_segments(monkeypatch, 2)

    def film_of(name):
        told, drawn = [], Mock(wraps=paint)
        with open_film(tmp_path / name, WIDE, 30.0) as film:
            film.paint_frames(pictures, drawn, told.append)
        assert sum(told) == len(pictures), "what is said of the progress ends at all frames"
        return (tmp_path / name).read_bytes(), [call.args[1] for call in drawn.call_args_list]

    quick, drawn = film_of("quick.mp4")
    assert len(drawn) <= 31 + len(segment_lengths(len(pictures)))
    assert set(drawn) == set(pictures)
    monkeypatch.setattr(encoder, "_repeats", lambda pictures: 0)
    assert film_of("plain.mp4")[0] == quick


def left(folder):
    threads = [one.name for one in threading.enumerate() if one.name.startswith("film")]
    return {path.name: path.read_text() for path in folder.iterdir()} | dict.fromkeys(threads)


@pytest.mark.parametrize("failing", [0, 25, 60, 129])
@pytest.mark.parametrize("cores", [1, 3])
def test_an_error_of_any_encoder_reaches_the_caller(tmp_path, monkeypatch, failing, cores):
    """Check that an error while writing frame number `failing` is reported to the caller.

    The frames are counted in the order in which the encoders write them. The error imitates a full disk.
    """
    calls, make = iter(range(1000)), formats.FrameMaker.__call__

    def broken(maker, surface):
        if next(calls) == failing:
            raise OSError("disk full")
        return make(maker, surface)

    monkeypatch.setattr(formats.FrameMaker, "__call__", broken)
    with pytest.raises(UserError, match="disk full"):
        written(tmp_path / "film.mp4", cores, monkeypatch)
    assert left(tmp_path) == {}


@pytest.mark.parametrize("name", ["film.mp4", "film/"])
def test_an_error_while_drawing_ends_all_threads(tmp_path, monkeypatch, name):
    def broken(surface, number):
        if number == 70:
            raise ZeroDivisionError

    (tmp_path / "film.mp4").write_text("old")
    six_segments(monkeypatch, 2)
    with pytest.raises(ZeroDivisionError), open_film(f"{tmp_path}/{name}", WIDE, 30.0) as film:
        film.paint_frames(range(FRAMES), broken)
    assert left(tmp_path) == {"film.mp4": "old"}
