"""Film: frames into files, compressed by a thread of its own while the next frames are drawn."""

from __future__ import annotations

import queue
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any, Protocol

import av
import pygame
from softcradle.sandbox.film.codecs import Codec, Palette, check, frame_of
from softcradle.sandbox.output_files import output_file, output_folder

BUFFERS = 3  # frames on their way between drawing and compressing


class Film(Protocol):
    """Where frames go: draw on what `blank` gives, then `add` it."""

    def learn(self, sample: pygame.Surface) -> None:
        """Take the colours of a GIF from `sample`, which should have all of them; else they are the first frame's."""

    def blank(self) -> pygame.Surface:
        """A surface for the next frame, with any content; waits until one is free."""

    def add(self, surface: pygame.Surface) -> None:
        """Take the finished frame; it must not be drawn on any more."""


@contextmanager
def open_film(
    output: Path | str,
    size: tuple[int, int],
    frame_rate: float,
    pixels: str | None = None,
) -> Iterator[Film]:
    """A film to add frames of `size` to; it stands at `output` when the block ends without error, or not at all.

    Arguments:
        output: .mp4, .gif, .webp or .avif, .png for one picture, or a folder (ends in /) for numbered pictures.
        frame_rate: frames a second; pictures have none.
        pixels: yuv420p (default) or yuv444p, for mp4: the latter keeps thin coloured lines; not every player shows it.

    Raises:
        UserError: a size, rate or kind of file that cannot be written; at once.
    """
    codec = check(output, size, frame_rate, pixels)
    if codec is None:
        folder = str(output).endswith(("/", "\\")) or Path(output).is_dir()
        with output_folder(output) if folder else output_file(output) as path:
            yield _Pictures(path, size)
        return
    with output_file(output) as path, _Encoder(path, codec, size, frame_rate) as film:
        yield film


class _Pictures:
    """One PNG file, or a folder of numbered ones."""

    def __init__(self, path: Path, size: tuple[int, int]) -> None:
        self._path, self._surface, self._count = path, pygame.Surface(size, 0, 32), 0

    def learn(self, sample: pygame.Surface) -> None:
        """Nothing to learn: a PNG has all colours."""

    def blank(self) -> pygame.Surface:
        return self._surface

    def add(self, surface: pygame.Surface) -> None:
        path = self._path / f"{self._count:05d}.png" if self._path.is_dir() else self._path
        pygame.image.save(surface, str(path))
        self._count += 1


class _Encoder:
    """A film by PyAV. Its thread owns the container; surfaces go round between it and the one who draws."""

    def __init__(self, path: Path, codec: Codec, size: tuple[int, int], frame_rate: float) -> None:
        self._codec = codec
        self._error: BaseException | None = None
        self._palette: Palette | None = None
        self._container = av.open(str(path), "w", format=codec.container, options=dict(codec.container_options))
        stream: Any = self._container.add_stream(codec.name, rate=Fraction(frame_rate).limit_denominator(1001))
        stream.width, stream.height, stream.pix_fmt = *size, codec.pixels
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

    def learn(self, sample: pygame.Surface) -> None:
        if self._codec.indexed:
            self._palette = Palette(sample)

    def blank(self) -> pygame.Surface:
        surface = self._free.get()
        if self._error is not None:
            raise self._error
        return surface

    def add(self, surface: pygame.Surface) -> None:
        self._full.put(surface)

    def _run(self) -> None:
        """Compress until None comes. An error waits for the one who draws, who is given surfaces so as not to hang."""
        try:
            with self._container:
                while (surface := self._full.get()) is not None:
                    self._compress(surface)
                    self._free.put(surface)
                self._mux(None)
        except BaseException as error:
            self._error = error
            for _ in range(BUFFERS):
                self._free.put(pygame.Surface((1, 1)))

    def _compress(self, surface: pygame.Surface) -> None:
        if self._codec.indexed and self._palette is None:
            self._palette = Palette(surface)
        self._mux(frame_of(surface, self._codec, self._palette))

    def _mux(self, frame: av.VideoFrame | None) -> None:
        self._container.mux(self._stream.encode(frame))
