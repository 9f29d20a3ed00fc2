"""Films: a thread encodes frames into a file while the next ones are drawn; pictures are written at once."""

from __future__ import annotations

import os
import queue
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any, Protocol

import av
import pygame
from softcradle.sandbox.draw.png_file import write_png
from softcradle.sandbox.film.film_kinds import Codec, FrameMaker, Palette, check
from softcradle.sandbox.film.segments import Paint, encoded_segments, segment_lengths
from softcradle.sandbox.output_files import output_file, output_folder

BUFFERS = 3  # frames that are drawn but not yet encoded; more would hide no further delay


class Film(Protocol):
    """A film being written: a frame is drawn on a :meth:`free_surface`, which is then added."""

    def take_colours(self, sample: pygame.Surface) -> None:
        """Take the colours of a GIF from `sample`; without it they are those of the first frame."""

    def free_surface(self) -> pygame.Surface:
        """A surface for the next frame, with any content; it is waited for until one is free."""

    def add(self, surface: pygame.Surface) -> None:
        """Add a finished frame. Its surface must not be drawn on any more."""

    def paint_frames(self, pictures: Sequence[Any], paint: Paint) -> None:
        """Add a frame for each of `pictures`, drawn by `paint`, in the order in which they are written soonest.

        A picture that equals the one before it need not be drawn.
        """


@contextmanager
def open_film(
    output: Path | str,
    size: tuple[int, int],
    frame_rate: float,
    pixel_format: str | None = None,
) -> Iterator[Film]:
    """A film to add frames of `size` to; it is at `output` when the block ends without error, or not at all.

    Arguments:
        output: .mp4, .gif, .webp or .avif, .png for one picture, or a folder (ends in /) for numbered pictures.
        frame_rate: frames a second; without meaning for pictures.
        pixel_format: yuv420p (default) or yuv444p, for mp4: the latter keeps thin coloured lines; not every player shows it.

    Raises:
        UserError: a size, rate or kind of file that cannot be written; at once.
    """
    codec = check(output, size, frame_rate, pixel_format)
    if codec is None:
        folder = str(output).endswith(("/", "\\")) or os.path.isdir(output)
        with output_folder(output) if folder else output_file(output) as path:
            yield _Pictures(path, size)
        return
    with output_file(output) as path, _Encoder(path, codec, size, frame_rate) as film:
        yield film


class _InOrder:
    """A film whose frames are drawn one after the other."""

    def free_surface(self) -> pygame.Surface:
        raise NotImplementedError

    def add(self, surface: pygame.Surface) -> None:
        raise NotImplementedError

    def paint_frames(self, pictures: Sequence[Any], paint: Paint) -> None:
        for picture in pictures:
            surface = self.free_surface()
            paint(surface, picture)
            self.add(surface)


class _Pictures(_InOrder):
    """One PNG file, or a folder of numbered ones."""

    def __init__(self, path: Path, size: tuple[int, int]) -> None:
        self._path, self._surface, self._count = path, pygame.Surface(size, 0, 32), 0

    def take_colours(self, sample: pygame.Surface) -> None:
        """Do nothing: a PNG has all colours."""

    def free_surface(self) -> pygame.Surface:
        return self._surface

    def add(self, surface: pygame.Surface) -> None:
        path = self._path / f"{self._count:05d}.png" if self._path.is_dir() else self._path
        write_png(surface, path)
        self._count += 1


class _Encoder(_InOrder):
    """A film by PyAV. Its thread owns the container; surfaces circulate between this thread and the drawing one."""

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

    def paint_frames(self, pictures: Sequence[Any], paint: Paint) -> None:
        if not self._codec.segmented or len(segment_lengths(len(pictures))) == 1:
            super().paint_frames(pictures, paint)
            return
        for packet in encoded_segments(self._codec, self._size, self._rate, pictures, paint):
            packet.stream = self._stream
            self._container.mux(packet)

    def _run(self) -> None:
        """Encode until None comes. After an error, the drawing thread gets surfaces, so as not to block, and then the error."""
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
