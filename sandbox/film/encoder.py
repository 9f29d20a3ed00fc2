"""Encoder of films. Frames are encoded while the next ones are drawn; long films are encoded in parallel segments.

One thread with its own encoder encodes each segment, and the segments are joined without re-encoding. (An encoder with
several threads waits for the slowest of them at every frame.) The number of frames decides where a film is cut,
so the result does not depend on the machine.
"""

from __future__ import annotations

import os
import queue
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import pygame
from softcradle.physics.ensemble_runs import cores
from softcradle.sandbox.draw.surfaces import write_png
from softcradle.sandbox.files import output_file, output_folder
from softcradle.sandbox.film.formats import Codec, FrameMaker, Palette, check

Packet = Any  # a packet of PyAV; versions differ in the arguments of this type
Paint = Callable[[pygame.Surface, Any], None]  # draws one picture on a surface
Tell = Callable[[int], None]  # called with the number of new frames

# Approximate number of frames in a segment. A segment starts with a key frame, which is 30 times as long as the others:
# a tenth of a film in such segments. The number of segments is even, because two is the smallest number of cores that
# matters.
SEGMENT_FRAMES = 180
SHORTEST_SEGMENT = 30  # Fewest frames of a segment. A film without two such segments is one segment.
MOST_WORKERS = 8  # Most encoding threads. One drawing thread cannot feed more.
BUFFERS = 3  # Frames that are drawn but not yet encoded. More would not reduce the waiting time.


@dataclass
class _Segment:
    """Segment of `count` frames from frame `first` on: `drawn` frames so far, and the packets after encoding."""

    first: int
    count: int
    drawn: int = 0
    packets: list[Packet] = field(default_factory=list)
    done: threading.Event = field(default_factory=threading.Event)


def segment_lengths(frames: int) -> list[int]:
    """Return the lengths of the segments of a film, which differ by at most one frame."""
    count = 2 * max(1, round(frames / (2 * SEGMENT_FRAMES))) if frames >= 2 * SHORTEST_SEGMENT else 1
    return [frames // count + (k < frames % count) for k in range(count)]


def encoded_segments(
    codec: Codec, size: tuple[int, int], rate: Fraction, pictures: Sequence[Any], paint: Paint, tell: Tell
) -> Iterator[Packet]:
    """Draw `pictures` with `paint` in this thread, encode them in others, and yield the packets of the film in order.

    A picture that equals its predecessor is neither drawn nor converted again. `tell` is called with the number of
    newly drawn frames.
    """
    segments, first = [], 0
    for count in segment_lengths(len(pictures)):
        segments.append(_Segment(first, count))
        first += count
    workers = _Workers(codec, size, rate, min(cores(), len(segments), MOST_WORKERS))
    try:
        yield from workers.run(segments, pictures, paint, tell)
    finally:
        workers.stop()


class _Workers:
    """Threads that encode. A surface goes from the drawing thread to one of them and back."""

    def __init__(self, codec: Codec, size: tuple[int, int], rate: Fraction, count: int) -> None:
        self._codec, self._size, self._rate = codec, size, rate
        self._error: BaseException | None = None
        self._free: queue.SimpleQueue[tuple[int, pygame.Surface]] = queue.SimpleQueue()
        self._full: list[queue.SimpleQueue[tuple[_Segment, pygame.Surface | None] | None]] = []
        self._threads = []
        for worker in range(count):
            self._full.append(queue.SimpleQueue())
            self._threads.append(threading.Thread(target=self._run, args=(worker,), name=f"film {worker}", daemon=True))
        for _ in range(BUFFERS):
            for worker in range(count):
                self._free.put((worker, pygame.Surface(size, 0, 32)))
        for thread in self._threads:
            thread.start()

    def run(self, segments: Sequence[_Segment], pictures: Sequence[Any], paint: Paint, tell: Tell) -> Iterator[Packet]:
        """Give each worker one segment after another, and its next frame as soon as it has a free surface."""
        waiting, held = list(segments), dict[int, _Segment]()
        unwritten, left = list(segments), sum(segment.count for segment in segments)
        while left:
            worker, surface = self._free.get()
            self._check()
            if worker not in held or held[worker].drawn == held[worker].count:
                if not waiting:
                    continue  # this surface is not needed any more
                held[worker] = waiting.pop(0)
            segment = held[worker]
            paint(surface, pictures[segment.first + segment.drawn])
            self._full[worker].put((segment, surface))
            drawn = 1 + _repeats(pictures[segment.first + segment.drawn : segment.first + segment.count])
            for _ in range(1, drawn):
                self._full[worker].put((segment, None))
            segment.drawn += drawn
            left -= drawn
            tell(drawn)
            while unwritten and unwritten[0].done.is_set():
                yield from unwritten.pop(0).packets
        for segment in unwritten:
            segment.done.wait()
            self._check()
            yield from segment.packets
        self._check()  # a worker that failed ended its segment, which may have been written before this check

    def stop(self) -> None:
        """End the threads."""
        for full in self._full:
            full.put(None)
        for thread in self._threads:
            thread.join()

    def _check(self) -> None:
        if self._error is not None:
            raise self._error

    def _run(self, worker: int) -> None:
        """Encode until None arrives. After an error, release the drawing thread so that it does not block and meets the
        error.
        """
        encoder: _SegmentEncoder | None = None
        while (item := self._full[worker].get()) is not None:
            segment, surface = item
            try:
                if encoder is None or encoder.segment is not segment:
                    encoder = _SegmentEncoder(self._codec, self._size, self._rate, segment)
                encoder.add(surface)
            except BaseException as error:
                self._error = error
                segment.done.set()
            if surface is not None:
                self._free.put((worker, surface))


def _repeats(pictures: Sequence[Any]) -> int:
    """Return the number of `pictures` that equal the first one without interruption."""
    return next((k for k, picture in enumerate(pictures[1:]) if picture != pictures[0]), len(pictures) - 1)


class _SegmentEncoder:
    """Encoder of one segment."""

    def __init__(self, codec: Codec, size: tuple[int, int], rate: Fraction, segment: _Segment) -> None:
        self.segment, self._codec, self._added = segment, codec, 0
        self._frame_of = FrameMaker(codec)
        self._context = codec.context(size, rate)
        self._frame: av.VideoFrame | None = None

    def add(self, surface: pygame.Surface | None) -> None:
        """Encode one more frame (None repeats the last one); after the last frame, flush the encoder."""
        frame = self._frame if surface is None else self._frame_of(surface)
        assert frame is not None
        self._frame = frame
        frame.pts, frame.time_base = self._added, self._context.time_base
        self._added += 1
        self._keep(self._context.encode(frame))
        if self._added == self.segment.count:
            self._keep(self._context.encode(None))
            self.segment.done.set()

    def _keep(self, packets: Sequence[Packet]) -> None:
        for packet in packets:
            packet.pts += self.segment.first
            packet.dts += self.segment.first
            self.segment.packets.append(packet)


class Film:
    """Film that is being written. Draw each frame on a :meth:`free_surface` and add it."""

    def take_colours(self, sample: pygame.Surface) -> None:
        """Choose the colours of a GIF from `sample`; by default they come from the first frame."""

    def free_surface(self) -> pygame.Surface:
        """Return a surface with arbitrary content for the next frame; wait until one is free."""
        raise NotImplementedError

    def add(self, surface: pygame.Surface) -> None:
        """Add a finished frame. Do not draw on its surface afterwards."""
        raise NotImplementedError

    def paint_frames(self, pictures: Sequence[Any], paint: Paint, tell: Tell = lambda _: None) -> None:
        """Draw a frame for each of `pictures` with `paint`, in the order in which they are written soonest, and add it.

        A picture that equals its predecessor need not be drawn. `tell` is called with the number of new frames.
        """
        for picture in pictures:
            surface = self.free_surface()
            paint(surface, picture)
            self.add(surface)
            tell(1)


@contextmanager
def open_film(
    output: Path | str, size: tuple[int, int], frame_rate: float, pixel_format: str | None = None
) -> Iterator[Film]:
    """Open a film for writing; its frames may show anything, such as a pymunk Space.

    The file is at `output` when the block ends without an error, and is not written otherwise. Films have no sound and no
    transparent background.

    Parameters
    ----------
    output : path
        Name that ends in .mp4 or .gif; in .png for one picture; or a folder, with a final ``/``, for numbered
        pictures.
    size : (int, int)
        Width and height of a frame [pixels]. They must be even numbers for an mp4.
    frame_rate : float
        Frames per second. Pictures ignore it.
    pixel_format : str, optional
        "yuv420p" (default) or "yuv444p", for mp4. The latter keeps thin coloured lines, but some players do not show it.

    Yields
    ------
    Film
        Draw on the pygame surface that ``film.free_surface()`` returns, then pass it to ``film.add(surface)``.

    Raises
    ------
    UserError
        The size, the rate or the kind of file cannot be written.

    Examples
    --------
    >>> from softcradle import open_film
    >>> with open_film("film.gif", (320, 180), 30) as film:  # doctest: +SKIP
    ...     for frame in range(60):
    ...         surface = film.free_surface()
    ...         surface.fill("white")
    ...         film.add(surface)
    """
    codec = check(output, size, frame_rate, pixel_format)
    if codec is None:
        folder = str(output).endswith(("/", "\\")) or os.path.isdir(output)
        with output_folder(output) if folder else output_file(output) as path:
            yield _Pictures(path, size)
        return
    with output_file(output) as path, _Encoder(path, codec, size, frame_rate) as film:
        yield film


class _Pictures(Film):
    """One PNG file, or a folder of numbered PNG files."""

    def __init__(self, path: Path, size: tuple[int, int]) -> None:
        self._path, self._surface, self._count = path, pygame.Surface(size, 0, 32), 0

    def free_surface(self) -> pygame.Surface:
        return self._surface

    def add(self, surface: pygame.Surface) -> None:
        path = self._path / f"{self._count:05d}.png" if self._path.is_dir() else self._path
        write_png(surface, path)
        self._count += 1


class _Encoder(Film):
    """Film written by PyAV. Its thread owns the container; surfaces circulate between this thread and the drawing
    thread.
    """

    def __init__(self, path: Path, codec: Codec, size: tuple[int, int], frame_rate: float) -> None:
        self._codec = codec
        self._error: BaseException | None = None
        self._palette: Palette | None = None
        self._container = av.open(str(path), "w", format=codec.container, options=dict(codec.container_options))
        self._rate = Fraction(frame_rate).limit_denominator(1001)
        self._size, self._frame_of = size, FrameMaker(codec)
        stream: Any = self._container.add_stream(codec.name, rate=self._rate)
        stream.width, stream.height, stream.pix_fmt = *size, codec.pixel_format
        stream.options = dict(codec.options)
        codec.tag(stream.codec_context)
        self._stream = stream
        self._free: queue.SimpleQueue[pygame.Surface] = queue.SimpleQueue()
        self._full: queue.SimpleQueue[pygame.Surface | None] = queue.SimpleQueue()
        for _ in range(BUFFERS):
            self._free.put(pygame.Surface(size, 0, 32))
        self._thread = threading.Thread(target=self._run, name="film", daemon=True)

    def __enter__(self) -> _Encoder:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        self._full.put(None)
        self._thread.join()
        if error is None and self._error is not None:
            raise self._error

    def take_colours(self, sample: pygame.Surface) -> None:
        if self._codec.indexed:
            self._palette = Palette(sample)

    def free_surface(self) -> pygame.Surface:
        surface = self._free.get()
        if self._error is not None:
            raise self._error
        return surface

    def add(self, surface: pygame.Surface) -> None:
        self._full.put(surface)

    def paint_frames(self, pictures: Sequence[Any], paint: Paint, tell: Tell = lambda _: None) -> None:
        if not self._codec.segmented or len(segment_lengths(len(pictures))) == 1:
            super().paint_frames(pictures, paint, tell)
            return
        for packet in encoded_segments(self._codec, self._size, self._rate, pictures, paint, tell):
            packet.stream = self._stream
            self._container.mux(packet)

    def _run(self) -> None:
        """Encode until None arrives. After an error, return surfaces so that the drawing thread does not block, then
        the error.
        """
        try:
            with self._container:
                while (surface := self._full.get()) is not None:
                    self._encode(surface)
                    self._free.put(surface)
                self._mux(None)
        except BaseException as error:
            self._error = error
            for _ in range(BUFFERS):
                self._free.put(pygame.Surface((1, 1)))

    def _encode(self, surface: pygame.Surface) -> None:
        if self._codec.indexed and self._palette is None:
            self._palette = Palette(surface)
        self._mux(self._palette.frame(surface) if self._palette else self._frame_of(surface))

    def _mux(self, frame: av.VideoFrame | None) -> None:
        self._container.mux(self._stream.encode(frame))
