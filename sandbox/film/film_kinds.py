"""The kinds of film: which file is encoded how and what its codec cannot do, and how a surface becomes a frame."""

from __future__ import annotations

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
from softcradle.sandbox.user_error import UserError

PIXEL_FORMATS = ("yuv420p", "yuv444p")
SMALLEST = (160, 90)  # pixels
LARGEST = (7680, 4320)  # pixels
LOWEST_RATE = 1.0  # frames a second
HIGHEST_RATE = 240.0  # frames a second
COMMON_COLOURS = 96  # of a GIF's 256: the colours that fill most of the picture are exact

# FFmpeg's numbers of colour spaces and of the range of values.
BT709 = 1
BT601 = 6
LIMITED = 1
GLOBAL_HEADER = 1 << 22  # FFmpeg's flag: what all frames need stands once in the file

os.environ.setdefault("SVT_LOG", "1")  # errors only: the AVIF encoder would write its settings to standard error
Pixels = NDArray[np.uint8]


@dataclass(frozen=True)
class Codec:
    """How a kind of film is written.

    Attributes:
        suffix: of the file.
        name, container: FFmpeg's names of the encoder and of the file format.
        pixel_format: FFmpeg's name of the pixel format.
        frame_rate: frames a second where none are given.
        highest_rate: most frames a second that the kind can show.
        even: whether width and height must be even.
        matrix: ITU709, or ITU601 where the kind supports no other.
        options, container_options: settings of the encoder and of the file format.
        segmented: whether segments of a film can be encoded side by side and joined.
    """

    suffix: str
    name: str
    container: str
    pixel_format: str
    frame_rate: float = 30.0
    highest_rate: float = HIGHEST_RATE
    even: bool = False
    matrix: str = "ITU709"
    options: tuple[tuple[str, str], ...] = ()
    container_options: tuple[tuple[str, str], ...] = ()
    segmented: bool = False

    @property
    def indexed(self) -> bool:
        """Whether a frame has numbers of 256 colours in place of colours."""
        return self.pixel_format == "pal8"

    def tag(self, context: Any) -> None:
        """Write into the file what its colours mean; players would otherwise guess, and shift them."""
        if not self.indexed:
            number = BT709 if self.matrix == "ITU709" else BT601
            context.color_range, context.colorspace = LIMITED, number
            context.color_primaries, context.color_trc = BT709, BT709

    def context(self, size: tuple[int, int], rate: Fraction) -> Any:
        """An encoder of one thread; what it writes can be joined with what another such encoder does."""
        context: Any = av.CodecContext.create(self.name, "w")
        context.width, context.height, context.pix_fmt = *size, self.pixel_format
        context.framerate, context.time_base, context.options = rate, 1 / rate, dict(self.options)
        context.thread_count = 1
        context.flags |= GLOBAL_HEADER
        self.tag(context)
        return context


REPEAT = (("loop", "0"),)  # of the file format: the film repeats without end
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
    # A GIF counts in hundredths of a second, and viewers slow frames down that last less than two of them.
    Codec(".gif", "gif", "gif", "pal8", frame_rate=25.0, highest_rate=50.0, container_options=REPEAT),
    Codec(
        ".webp",
        "libwebp_anim",
        "webp",
        "yuv420p",
        matrix="ITU601",
        options=(("quality", "85"), ("compression_level", "2")),
        container_options=REPEAT,
    ),
    Codec(
        ".avif",
        "libsvtav1",
        "avif",
        "yuv420p",
        options=(("preset", "9"), ("crf", "22")),
        container_options=REPEAT,
    ),
)


def check(
    output: Path | str, size: tuple[int, int], frame_rate: float | None, pixel_format: str | None = None
) -> Codec | None:
    """The codec for `output`, None for pictures. Raises UserError where `output` could not be written so."""
    if not all(least <= side <= most for side, least, most in zip(size, SMALLEST, LARGEST, strict=True)):
        limits = f"{SMALLEST[0]}x{SMALLEST[1]} to {LARGEST[0]}x{LARGEST[1]}"
        raise UserError(f"size {size[0]}x{size[1]} is out of range: allowed are {limits}")
    codec = _by_name(str(output))
    highest = HIGHEST_RATE if codec is None else codec.highest_rate
    if frame_rate is not None and not LOWEST_RATE <= frame_rate <= highest:
        kind = "pictures have" if codec is None else f"{codec.suffix} has"
        raise UserError(f"{kind} {LOWEST_RATE:g} to {highest:g} frames a second, not {frame_rate:g}")
    if pixel_format is not None:
        codec = _with_pixel_format(codec, pixel_format)
    if codec is None:
        return None
    if codec.even and (size[0] % 2 or size[1] % 2):
        raise UserError(f"{codec.suffix} needs an even width and height, not {size[0]}x{size[1]}")
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
            f"cannot write {output}: the name must end in {known}, .png or .html, or in / for a folder of pictures"
        )
    return None


def _with_pixel_format(codec: Codec | None, pixel_format: str) -> Codec:
    if codec is None or codec.suffix != ".mp4":
        raise UserError("a pixel format can be chosen for .mp4 only")
    if pixel_format not in PIXEL_FORMATS:
        raise UserError(f"unknown pixel format {pixel_format!r}; allowed: {', '.join(PIXEL_FORMATS)}")
    return replace(codec, pixel_format=pixel_format)


def _require(codec: Codec) -> None:
    try:
        av.codec.Codec(codec.name, "w")
        av.format.ContainerFormat(codec.container, "w")
    except ValueError:  # of which FFmpeg's unknown codec and PyAV's unknown format are kinds
        raise UserError(
            f"cannot write {codec.suffix}: this PyAV was built without {codec.name}; choose another kind of film"
        ) from None


class Palette:
    """256 colours for a GIF: the most common ones of `sample` exactly, the others as Pillow's median cut chooses them."""

    def __init__(self, sample: pygame.Surface) -> None:
        picture = Image.frombytes("RGB", sample.get_size(), sample.get_view("0").raw, "raw", "BGRX")
        counted: Any = picture.getcolors(picture.width * picture.height)
        common = np.array([colour for _, colour in sorted(counted, reverse=True)[:COMMON_COLOURS]], np.uint8)
        others = np.array(picture.quantize(256 - len(common)).getpalette("RGB"), np.uint8).reshape(-1, 3)
        self.colours = np.zeros((256, 3), np.uint8)
        self.colours[: len(common)] = common
        self.colours[len(common) : len(common) + len(others)] = others
        self._number = _nearest(self.colours)
        self._number[_cell(common[::-1])] = np.arange(len(common), dtype=np.uint8)[
            ::-1
            # Assigned from the rarest to the most common: the most common colour of a cell wins it.
        ]

    def frame(self, surface: pygame.Surface) -> av.VideoFrame:
        """`surface` in these colours; without dithering, so that still parts are the same in all frames."""
        numbers = self._number[_cell(pixels_of(surface)[..., 2::-1])]
        opaque = np.concatenate((np.full((256, 1), 255, np.uint8), self.colours), axis=1)
        picture: Any = (numbers, opaque)  # PyAV documents this pair; its types do not have it
        return av.VideoFrame.from_ndarray(picture, format="pal8")


def _cell(colours: Pixels) -> NDArray[np.int32]:
    """Number of the cell, 64 along each axis of colour space, that each of `colours` (..., 3) lies in."""
    red, green, blue = (colours[..., k].astype(np.int32) >> 2 for k in range(3))
    return (red << 12) | (green << 6) | blue


def _nearest(colours: Pixels) -> Pixels:
    """(64**3,) the number of the colour of `colours` (256, 3) nearest to the middle of each cell; Pillow finds it fast."""
    palette = Image.new("P", (1, 1))
    palette.putpalette(colours.tobytes())
    middle = (np.arange(64, dtype=np.uint8) << 2) | 2
    cells = np.stack(np.meshgrid(middle, middle, middle, indexing="ij"), axis=-1).reshape(512, 512, 3)
    return np.array(Image.fromarray(cells).quantize(palette=palette, dither=Image.Dither.NONE)).reshape(-1)


class FrameMaker:
    """Turns surfaces into frames for a codec; a copy, so that a surface can be drawn on again. One for each thread."""

    def __init__(self, codec: Codec) -> None:
        self._codec, self._reformatter = codec, VideoReformatter()

    def __call__(self, surface: pygame.Surface) -> av.VideoFrame:
        """The surface as a frame."""
        frame = av.VideoFrame.from_numpy_buffer(pixels_of(surface), format="bgra")
        settings: Any = {"dst_colorspace": self._codec.matrix, "dst_color_range": "MPEG", "threads": 1}
        return self._reformatter.reformat(frame, format=self._codec.pixel_format, **settings)


def pixels_of(surface: pygame.Surface) -> Pixels:
    """The pixels of a 32-bit surface, not copied: (height, width, 4), blue, green, red, unused. They lock the surface."""
    width, height = surface.get_size()
    view: Any = surface.get_view("0")  # a buffer, which pygame's types do not state
    return np.frombuffer(view, np.uint8).reshape(height, width, 4)
