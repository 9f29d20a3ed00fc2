"""Segments: a film encoded by several threads is the film that one would have encoded, on any machine."""

import threading
from unittest.mock import Mock

import av
import numpy as np
import pygame
import pytest
from softcradle.sandbox.film import encoder as film_encoder
from softcradle.sandbox.film import formats
from softcradle.sandbox.film.encoder import open_film, segment_lengths
from softcradle.sandbox.film.formats import pixels_of
from softcradle.sandbox.user_error import UserError

# x264 with AVX-512 is reproducible only where half the width is a multiple of 64.
SIZE = (640, 360)
FRAMES = 130


@pytest.fixture(autouse=True)
def short_segments(monkeypatch):
    monkeypatch.setattr(film_encoder, "SEGMENT_FRAMES", 22)  # 6 of them
    monkeypatch.setattr(film_encoder, "SHORTEST_SEGMENT", 10)


def paint(surface, number):
    """A frame that no other is like: a bar that moves, and the number in the brightness of the ground."""
    surface.fill((number, 40, 200 - number))
    surface.fill((250, 250, 120), (4 * number, 60, 80, 200))


def written(path, cores, monkeypatch):
    monkeypatch.setattr(film_encoder, "cores", lambda: cores)
    with open_film(path, SIZE, 30.0) as film:
        film.paint_frames(range(FRAMES), paint)
    return path


def test_the_film_is_the_same_on_every_number_of_cores(tmp_path, monkeypatch):
    films = [written(tmp_path / f"{cores}.mp4", cores, monkeypatch).read_bytes() for cores in (1, 2, 3, 8)]
    assert len(set(films)) == 1


def test_every_frame_has_its_time_and_its_picture_and_players_may_begin_at_any_segment(tmp_path, monkeypatch):
    with av.open(str(written(tmp_path / "film.mp4", 3, monkeypatch))) as container:
        stream = container.streams.video[0]
        assert stream.frames == FRAMES
        assert float(stream.duration * stream.time_base) == pytest.approx(FRAMES / 30.0)
        frames = list(container.decode(stream))
        container.seek(int(3.0 / stream.time_base), stream=stream)
        assert 2.0 < next(container.decode(stream)).time <= 3.0
    assert [round(frame.time * 30) for frame in frames] == list(range(FRAMES))
    surface = pygame.Surface(SIZE, 0, 32)
    for number, frame in enumerate(frames):
        paint(surface, number)
        picture = frame.to_ndarray(format="rgb24", src_colorspace="ITU709").astype(int)
        assert np.abs(picture - pixels_of(surface)[..., 2::-1]).mean() < 3.0, number
    keys = [k for k, frame in enumerate(frames) if frame.key_frame]
    assert keys == np.cumsum([0, *segment_lengths(FRAMES)[:-1]]).tolist()


def test_a_picture_that_stays_is_drawn_once_a_segment(tmp_path, monkeypatch):
    """The film is the one in which every frame is drawn; what stays is drawn again only where a segment begins."""
    pictures = [0] * 50 + list(range(1, 31)) + [30] * 49
    monkeypatch.setattr(film_encoder, "cores", lambda: 2)

    def film_of(name):
        told, drawn = [], Mock(wraps=paint)
        with open_film(tmp_path / name, SIZE, 30.0) as film:
            film.paint_frames(pictures, drawn, told.append)
        assert sum(told) == len(pictures), "what is said of the progress ends at all frames"
        return (tmp_path / name).read_bytes(), [call.args[1] for call in drawn.call_args_list]

    quick, drawn = film_of("quick.mp4")
    assert len(drawn) <= 31 + len(segment_lengths(len(pictures)))
    assert set(drawn) == set(pictures)
    monkeypatch.setattr(film_encoder, "_repeats", lambda pictures: 0)
    assert film_of("plain.mp4")[0] == quick


def fail_at(monkeypatch, failing):
    """Let the frame of that number, counted as they come to the encoders, meet a full disk."""
    calls, make = iter(range(1000)), formats.FrameMaker.__call__

    def broken(maker, surface):
        if next(calls) == failing:
            raise OSError("disk full")
        return make(maker, surface)

    monkeypatch.setattr(formats.FrameMaker, "__call__", broken)


def nothing_is_left(folder):
    return not list(folder.iterdir()) and not [one for one in threading.enumerate() if one.name.startswith("film")]


@pytest.mark.parametrize("failing", [0, 25, 60, 129])
@pytest.mark.parametrize("cores", [1, 3])
def test_an_error_of_any_encoder_reaches_the_caller(tmp_path, monkeypatch, failing, cores):
    fail_at(monkeypatch, failing)
    with pytest.raises(UserError, match="disk full"):
        written(tmp_path / "film.mp4", cores, monkeypatch)
    assert nothing_is_left(tmp_path)


def test_an_error_while_drawing_ends_all_threads(tmp_path, monkeypatch):
    def broken(surface, number):
        if number == 70:
            raise ZeroDivisionError

    monkeypatch.setattr(film_encoder, "cores", lambda: 2)
    with pytest.raises(ZeroDivisionError), open_film(tmp_path / "film.mp4", SIZE, 30.0) as film:
        film.paint_frames(range(FRAMES), broken)
    assert nothing_is_left(tmp_path)
