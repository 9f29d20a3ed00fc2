"""File formats of films. The module contains the codec and the limits of each file suffix. The module also converts
surfaces into frames.
"""

import os
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np
import pygame
from av.video.reformatter import VideoReformatter
from numpy.typing import NDArray
from PIL import Image
from softcradle.sandbox.languages import _
from softcradle.sandbox.user_error import UserError

PIXEL_FORMATS = ("yuv420p", "yuv444p")
SMALLEST = (160, 90)  # smallest width and height of a film [pixels]
LARGEST = (7680, 4320)  # largest width and height of a film [pixels]
LOWEST_RATE = 1.0  # lowest number of frames per second
HIGHEST_RATE = 240.0  # highest number of frames per second

# Numbers by which FFmpeg identifies colour spaces and the range of values.
BT709 = 1
LIMITED = 1
GLOBAL_HEADER = 1 << 22  # FFmpeg's flag for storing the data that all frames need only once in the file

Pixels = NDArray[np.uint8]


@dataclass(frozen=True)
class Codec:
    """Codec of one kind of film.

    Attributes:
        suffix: suffix of the file.
        name, container: FFmpeg's names of the encoder and of the file format.
        pixel_format: FFmpeg's name of the pixel format.
        frame_rate: default frames per second.
        highest_rate: most frames per second that the format can show.
        even: True if width and height must be even.
        options, container_options: settings of the encoder and of the file format.
        segmented: True if segments of a film can be encoded in parallel and joined.
    """

    suffix: str
    name: str
    container: str
    pixel_format: str
    frame_rate: float = 30.0
    highest_rate: float = HIGHEST_RATE
    even: bool = False
    options: tuple[tuple[str, str], ...] = ()
    container_options: tuple[tuple[str, str], ...] = ()
    segmented: bool = False

    @property
    def indexed(self) -> bool:
        """True if a frame contains indices into 256 colours."""
        return self.pixel_format == "pal8"

    def tag(self, context: Any) -> None:
        """Write the colour space into the file. Without it, players guess the colour space and show wrong colours."""
        if not self.indexed:
            context.color_range = LIMITED
            context.colorspace = context.color_primaries = context.color_trc = BT709

    def context(self, size: tuple[int, int], rate: Fraction) -> Any:
        """Return an encoder with one thread. The outputs of several such encoders can be joined."""
        context: Any = av.CodecContext.create(self.name, "w")
        context.width, context.height, context.pix_fmt = *size, self.pixel_format
        context.framerate, context.time_base, context.options = rate, 1 / rate, dict(self.options)
        context.thread_count = 1
        context.flags |= GLOBAL_HEADER
        self.tag(context)
        return context


REPEAT = (("loop", "0"),)  # option of the GIF format that repeats the film endlessly
CODECS: tuple[Codec, ...] = (
    Codec(
        ".mp4",
        "libx264",
        "mp4",
        "yuv420p",
        frame_rate=60.0,
        even=True,
        options=(("preset", "veryfast"), ("crf", "18")),
        container_options=(("movflags", "+faststart"),),
        segmented=True,
    ),
    # A GIF measures the duration of a frame in hundredths of a second. Viewers slow down frames shorter than two
    # hundredths.
    Codec(".gif", "gif", "gif", "pal8", frame_rate=25.0, highest_rate=50.0, container_options=REPEAT),
)


def check(
    output: Path | str, size: tuple[int, int], frame_rate: float | None, pixel_format: str | None = None
) -> Codec | None:
    """Return the codec for `output`. Return None if `output` is a picture or a folder of pictures. Raise UserError if
    `output` cannot be written.
    """
    if not all(least <= side <= most for side, least, most in zip(size, SMALLEST, LARGEST, strict=True)):
        given, least, most = (f"{wide}x{high}" for wide, high in (size, SMALLEST, LARGEST))
        raise UserError(
            _("size {given} is out of range: allowed are {least} to {most}", given=given, least=least, most=most)
        )
    codec = _by_name(str(output))
    highest = HIGHEST_RATE if codec is None else codec.highest_rate
    if frame_rate is not None and not LOWEST_RATE <= frame_rate <= highest:
        raise UserError(
            _(
                "{kind}: {least:g} to {most:g} frames a second are possible, not {given:g}",
                kind=_("pictures") if codec is None else codec.suffix,
                least=LOWEST_RATE,
                most=highest,
                given=frame_rate,
            )
        )
    if pixel_format is not None:
        codec = _with_pixel_format(codec, pixel_format)
    if codec is None:
        return None
    if codec.even and (size[0] % 2 or size[1] % 2):
        given = f"{size[0]}x{size[1]}"
        raise UserError(_("{kind} needs an even width and height, not {given}", kind=codec.suffix, given=given))
    _require(codec)
    return codec


def _by_name(output: str) -> Codec | None:
    if output.endswith(("/", "\\")) or os.path.isdir(output):
        return None
    suffix = Path(output).suffix.lower()
    for codec in CODECS:
        if codec.suffix == suffix:
            return codec
    if suffix != ".png":
        known = ", ".join(codec.suffix for codec in CODECS)
        raise UserError(
            _(
                "cannot write {path}: the name must end in {known}, .png or .html, or in / for a folder of pictures",
                path=output,
                known=known,
            )
        )
    return None


def _with_pixel_format(codec: Codec | None, pixel_format: str) -> Codec:
    if codec is None or codec.suffix != ".mp4":
        raise UserError(_("a pixel format can be chosen for .mp4 only"))
    if pixel_format not in PIXEL_FORMATS:
        known = ", ".join(PIXEL_FORMATS)
        raise UserError(_("unknown pixel format {given!r}; allowed: {known}", given=pixel_format, known=known))
    return replace(codec, pixel_format=pixel_format)


def _require(codec: Codec) -> None:
    try:
        av.codec.Codec(codec.name, "w")
        av.format.ContainerFormat(codec.container, "w")
    # FFmpeg's error for an unknown codec and PyAV's error for an unknown format are subclasses of ValueError.
    except ValueError:
        raise UserError(
            _(
                "cannot write {kind}: this PyAV was built without {codec}; choose another kind of film",
                kind=codec.suffix,
                codec=codec.name,
            )
        ) from None


class Palette:
    """Palette of a GIF with 256 colours. Pillow chooses the colours from the picture `sample`. Pillow first covers the
    range of colours and then averages similar colours.
    """

    def __init__(self, sample: pygame.Surface) -> None:
        # The median-cut method would make the background grey and change the colour of every line.
        coverage = Image.Quantize.MAXCOVERAGE
        self._colours = _image_of(sample).quantize(256, coverage, kmeans=1, dither=Image.Dither.NONE)
        table = np.full((256, 4), 255, np.uint8)  # columns: alpha, red, green, blue
        chosen = np.array(self._colours.getpalette("RGB"), np.uint8).reshape(-1, 3)
        table[: len(chosen), 1:] = chosen
        self._table = table

    def frame(self, surface: pygame.Surface) -> av.VideoFrame:
        """Return a frame that shows `surface` in the colours of the palette. Dithering is off, so the parts that
        do not move are equal in all frames.
        """
        numbers = np.array(_image_of(surface).quantize(palette=self._colours, dither=Image.Dither.NONE))
        # PyAV documents this pair of arrays, but its type annotations do not include it.
        picture: Any = (numbers, self._table)
        return av.VideoFrame.from_ndarray(picture, format="pal8")


def _image_of(surface: pygame.Surface) -> Image.Image:
    return Image.frombytes("RGB", surface.get_size(), surface.get_view("0").raw, "raw", "BGRX")


class FrameMaker:
    """Converter of surfaces into frames of a codec.

    The frame is a copy, so the surface can be used again afterwards. Each thread needs its own converter.
    """

    def __init__(self, codec: Codec) -> None:
        self._codec, self._reformatter = codec, VideoReformatter()

    def __call__(self, surface: pygame.Surface) -> av.VideoFrame:
        """Return a frame that shows the surface."""
        frame = av.VideoFrame.from_numpy_buffer(pixels_of(surface), format="bgra")
        settings: Any = {"dst_colorspace": "ITU709", "dst_color_range": "MPEG", "threads": 1}
        return self._reformatter.reformat(frame, format=self._codec.pixel_format, **settings)


def pixels_of(surface: pygame.Surface) -> Pixels:
    """Return the pixels of a 32-bit surface without copying them. The surface is locked as long as the array exists.

    The shape of the array is (height, width, 4). The last axis contains blue, green, red and an unused value.
    """
    width, height = surface.get_size()
    view: Any = surface.get_view("0")  # pygame's type annotations do not show that this object is a buffer.
    return np.frombuffer(view, np.uint8).reshape(height, width, 4)
