"""Encoder of films. The encoder encodes frames while the next frames are drawn. A long film is divided into segments
that are encoded in parallel.

Each segment is encoded by one thread with its own encoder. Afterwards the segments are joined without re-encoding. (An
encoder with several threads would wait for the slowest thread at every frame.) The boundaries between segments depend
only on the number of frames. The resulting file is therefore the same on every machine.
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

# Packet of PyAV. The type is Any because the arguments of the packet type differ between versions of PyAV.
Packet = Any
Paint = Callable[[pygame.Surface, Any], None]  # function that draws one picture on a surface
Tell = Callable[[int], None]  # function that is called with the number of new frames

# Approximate number of frames in a segment. Each segment starts with a key frame, which takes 30 times as much space as
# another frame. With segments of this length, key frames take a tenth of the film. The number of segments is even, so
# that two cores have equal work.
SEGMENT_FRAMES = 180
# Smallest number of frames in a segment. A film that is too short for two such segments has one segment.
SHORTEST_SEGMENT = 30
MOST_WORKERS = 8  # Largest number of encoding threads. One drawing thread cannot supply frames for more.
# Number of frames that can be drawn but not yet encoded. A larger number would not reduce the waiting time.
BUFFERS = 3


@dataclass
class _Segment:
    """Segment of a film. The segment begins with the frame number `first` and has `count` frames.

    `drawn` is the number of frames drawn so far. `packets` contains the encoded frames.
    """

    first: int
    count: int
    drawn: int = 0
    packets: list[Packet] = field(default_factory=list)
    done: threading.Event = field(default_factory=threading.Event)


def segment_lengths(frames: int) -> list[int]:
    """Return the number of frames of each segment of a film. The numbers of frames differ by at most 1."""
    count = 2 * max(1, round(frames / (2 * SEGMENT_FRAMES))) if frames >= 2 * SHORTEST_SEGMENT else 1
    return [frames // count + (k < frames % count) for k in range(count)]


def encoded_segments(
    codec: Codec, size: tuple[int, int], rate: Fraction, pictures: Sequence[Any], paint: Paint, tell: Tell
) -> Iterator[Packet]:
    """Draw `pictures` with `paint` and encode them. Yield the packets of the film in order.

    The pictures are drawn in the calling thread and encoded in other threads. If a picture equals the previous picture,
    it is neither drawn nor converted again. `tell` is called with the number of new frames.
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
    """Threads that encode frames. Each surface moves from the drawing thread to one of these threads and back."""

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
        """Give each worker one segment after another. A worker gets its next frame as soon as it has a free surface."""
        waiting, held = list(segments), dict[int, _Segment]()
        unwritten, left = list(segments), sum(segment.count for segment in segments)
        while left:
            worker, surface = self._free.get()
            self._check()
            if worker not in held or held[worker].drawn == held[worker].count:
                if not waiting:
                    continue  # All segments are assigned, so this surface is not used again.
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
        # If a worker fails, it marks its segment as done. The segment may have been written before this check.
        self._check()

    def stop(self) -> None:
        """Stop the encoding threads and wait until they have ended."""
        for full in self._full:
            full.put(None)
        for thread in self._threads:
            thread.join()

    def _check(self) -> None:
        if self._error is not None:
            raise self._error

    def _run(self, worker: int) -> None:
        """Encode frames until the queue contains None.

        After an error, return the surfaces to the drawing thread. If a surface were missing, the drawing thread would
        wait forever and not see the error.
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
    """Return how many of the following `pictures` equal the first picture before a different one follows."""
    return next((k for k, picture in enumerate(pictures[1:]) if picture != pictures[0]), len(pictures) - 1)


class _SegmentEncoder:
    """Encoder of one segment of a film."""

    def __init__(self, codec: Codec, size: tuple[int, int], rate: Fraction, segment: _Segment) -> None:
        self.segment, self._codec, self._added = segment, codec, 0
        self._frame_of = FrameMaker(codec)
        self._context = codec.context(size, rate)
        self._frame: av.VideoFrame | None = None

    def add(self, surface: pygame.Surface | None) -> None:
        """Encode one more frame. If `surface` is None, repeat the last frame. After the last frame of the segment,
        flush the encoder.
        """
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
    """Film that is being written. For each frame, draw on a surface from :meth:`free_surface` and pass it to
    :meth:`add`.
    """

    def take_colours(self, sample: pygame.Surface) -> None:
        """Choose the colours of a GIF from the picture `sample`. Without this call, they are chosen from the first
        frame.
        """

    def free_surface(self) -> pygame.Surface:
        """Return a surface for the next frame. Its content is arbitrary. Wait if no surface is free."""
        raise NotImplementedError

    def add(self, surface: pygame.Surface) -> None:
        """Add a finished frame to the film. Do not draw on the surface afterwards."""
        raise NotImplementedError

    def paint_frames(self, pictures: Sequence[Any], paint: Paint, tell: Tell = lambda _: None) -> None:
        """Draw each of the `pictures` with `paint` and add it to the film. The order of drawing is chosen for speed.

        If a picture equals the previous picture, it is not necessarily drawn again. `tell` is called with the number of
        new frames.
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
    """Open a film for writing. The frames of the film can show anything, such as a pymunk Space.

    The file `output` appears when the block ends without an error. After an error, it is not written. Films have
    neither sound nor a transparent background.

    Parameters
    ----------
    output : path
        Name of a file or folder. A name that ends in .mp4 or .gif is a film. A name that ends in .png is one picture. A
            name
        with a final ``/`` is a folder of numbered pictures.
    size : (int, int)
        Width and height of a frame [pixels]. Width and height must be even numbers for an mp4.
    frame_rate : float
        Frames per second. Pictures ignore it.
    pixel_format : str, optional
        "yuv420p" (default) or "yuv444p", for mp4. The latter keeps thin coloured lines, but some players do not show
            it.

    Yields
    ------
    Film
        Draw on the pygame surface that ``film.free_surface()`` returns, then pass it to ``film.add(surface)``.

    Raises
    ------
    UserError
        The size, the rate or the kind of file is not supported.

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
    """Film written by PyAV. The encoding thread owns the container. Surfaces circulate between the encoding thread and
    the drawing thread.
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
        """Encode frames until the queue contains None.

        After an error, return the surfaces and then the error to the drawing thread. If a surface were missing, the
        drawing thread would wait forever.
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
