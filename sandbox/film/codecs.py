"""Kinds of film: which codec, with which settings, and what each cannot do; the way from a surface to its frame."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import av
import numpy as np
import pygame
from numpy.typing import NDArray
from PIL import Image
from softcradle.sandbox.user_error import UserError

PIXELS = ("yuv420p", "yuv444p")
SMALLEST, LARGEST = (160, 90), (7680, 4320)
SLOWEST, FASTEST = 1.0, 240.0  # frames a second
COMMON_COLOURS = 96  # of a GIF's 256: those that fill most of the picture are kept exactly
BT709, BT601, LIMITED = 1, 6, 1  # as FFmpeg numbers them

os.environ.setdefault("SVT_LOG", "1")  # errors only: the AVIF encoder would tell its life on standard error
Pixels = NDArray[np.uint8]


@dataclass(frozen=True)
class Codec:
    """How a kind of film is written.

    Attributes:
        suffix, name, container: of the file, of the encoder, of the file format, as FFmpeg calls them.
        pixels: pixel format.
        frame_rate: frames a second where nobody wishes another.
        fastest: frames a second that the kind can show.
        even: only even widths and heights.
        matrix: ITU709, or ITU601 where the kind knows no other.
        options, container_options: settings of the encoder and of the file format.
    """

    suffix: str
    name: str
    container: str
    pixels: str
    frame_rate: float = 30.0
    fastest: float = FASTEST
    even: bool = False
    matrix: str = "ITU709"
    options: tuple[tuple[str, str], ...] = ()
    container_options: tuple[tuple[str, str], ...] = ()

    @property
    def indexed(self) -> bool:
        """Whether frames are numbers of 256 colours."""
        return self.pixels == "pal8"

    def tag(self, context: Any) -> None:
        """Say in the file what the colours mean, or players guess and shift them."""
        if not self.indexed:
            number = BT709 if self.matrix == "ITU709" else BT601
            context.color_range, context.colorspace = LIMITED, number
            context.color_primaries, context.color_trc = BT709, BT709


ENDLESS = (("loop", "0"),)
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
    ),
    # A GIF counts in hundredths of a second, and viewers slow down what lasts less than two of them.
    Codec(".gif", "gif", "gif", "pal8", frame_rate=25.0, fastest=50.0, container_options=ENDLESS),
    Codec(
        ".webp",
        "libwebp_anim",
        "webp",
        "yuv420p",
        matrix="ITU601",
        options=(("quality", "85"), ("compression_level", "2")),
        container_options=ENDLESS,
    ),
    Codec(
        ".avif",
        "libsvtav1",
        "avif",
        "yuv420p",
        options=(("preset", "9"), ("crf", "22")),
        container_options=ENDLESS,
    ),
)


def check(
    output: Path | str, size: tuple[int, int], frame_rate: float | None, pixels: str | None = None
) -> Codec | None:
    """The codec for `output`, None for pictures; UserError, before any work, where it cannot be written."""
    if not all(least <= side <= most for side, least, most in zip(size, SMALLEST, LARGEST, strict=True)):
        limits = f"{SMALLEST[0]}x{SMALLEST[1]} to {LARGEST[0]}x{LARGEST[1]}"
        raise UserError(f"size {size[0]}x{size[1]} is out of range: allowed are {limits}")
    codec = _by_name(str(output))
    fastest = FASTEST if codec is None else codec.fastest
    if frame_rate is not None and not SLOWEST <= frame_rate <= fastest:
        kind = "pictures have" if codec is None else f"{codec.suffix} has"
        raise UserError(f"{kind} {SLOWEST:g} to {fastest:g} frames a second, not {frame_rate:g}")
    if pixels is not None:
        codec = _with_pixels(codec, pixels)
    if codec is None:
        return None
    if codec.even and (size[0] % 2 or size[1] % 2):
        raise UserError(f"{codec.suffix} needs an even width and height, not {size[0]}x{size[1]}")
    _require(codec)
    return codec


def _by_name(output: str) -> Codec | None:
    if output.endswith(("/", "\\")) or Path(output).is_dir():
        return None
    suffix = Path(output).suffix.lower()
    for codec in CODECS:
        if codec.suffix == suffix:
            return codec
    if suffix != ".png":
        known = ", ".join(codec.suffix for codec in CODECS)
        raise UserError(
            f"cannot write {output}: the name must end in {known} or .png, or in / for a folder of pictures"
        )
    return None


def _with_pixels(codec: Codec | None, pixels: str) -> Codec:
    if codec is None or codec.suffix != ".mp4":
        raise UserError("a pixel format can be chosen for .mp4 only")
    if pixels not in PIXELS:
        raise UserError(f"unknown pixel format {pixels!r}; allowed: {', '.join(PIXELS)}")
    return replace(codec, pixels=pixels)


def _require(codec: Codec) -> None:
    try:
        av.codec.Codec(codec.name, "w")
        av.format.ContainerFormat(codec.container, "w")
    except ValueError:  # FFmpeg's "unknown codec" and PyAV's unknown format are both
        raise UserError(
            f"cannot write {codec.suffix}: this PyAV was built without {codec.name}; choose another kind of film"
        ) from None


class Palette:
    """256 colours for a GIF: the commonest of `sample` as they are, the others where they do best."""

    def __init__(self, sample: pygame.Surface) -> None:
        picture = Image.frombytes("RGB", sample.get_size(), sample.get_view("0").raw, "raw", "BGRX")
        counted: Any = picture.getcolors(picture.width * picture.height)
        common = np.array([colour for _, colour in sorted(counted, reverse=True)[:COMMON_COLOURS]], np.uint8)
        others = np.array(picture.quantize(256 - len(common)).getpalette("RGB"), np.uint8).reshape(-1, 3)
        self.colours = np.zeros((256, 3), np.uint8)
        self.colours[: len(common)] = common
        self.colours[len(common) : len(common) + len(others)] = others
        self._number = _nearest(self.colours)
        self._number[_cell(common[::-1])] = np.arange(len(common), dtype=np.uint8)[::-1]  # the commonest comes last

    def frame(self, surface: pygame.Surface) -> av.VideoFrame:
        """`surface` in these colours; without dither, so that what stands still stays the same from frame to frame."""
        numbers = self._number[_cell(pixels_of(surface)[..., 2::-1])]
        opaque = np.concatenate((np.full((256, 1), 255, np.uint8), self.colours), axis=1)
        picture: Any = (numbers, opaque)  # PyAV documents the pair; its types do not
        return av.VideoFrame.from_ndarray(picture, format="pal8")


def _cell(colours: Pixels) -> NDArray[np.int32]:
    """Number of the cell, 64 along each axis of colour space, that each of `colours` (..., 3) lies in."""
    red, green, blue = (colours[..., k].astype(np.int32) >> 2 for k in range(3))
    return (red << 12) | (green << 6) | blue


def _nearest(colours: Pixels) -> Pixels:
    """(64**3,) the nearest of `colours` (256, 3) to the middle of each cell; Pillow knows how to do it fast."""
    palette = Image.new("P", (1, 1))
    palette.putpalette(colours.tobytes())
    middle = (np.arange(64, dtype=np.uint8) << 2) | 2
    cells = np.stack(np.meshgrid(middle, middle, middle, indexing="ij"), axis=-1).reshape(512, 512, 3)
    return np.array(Image.fromarray(cells).quantize(palette=palette, dither=Image.Dither.NONE)).reshape(-1)


def frame_of(surface: pygame.Surface, codec: Codec, palette: Palette | None) -> av.VideoFrame:
    """The surface as a frame for `codec`; a copy, so that the surface is free again."""
    if palette is not None:
        return palette.frame(surface)
    frame = av.VideoFrame.from_numpy_buffer(pixels_of(surface), format="bgra")
    return frame.reformat(format=codec.pixels, dst_colorspace=codec.matrix, dst_color_range="MPEG")


def pixels_of(surface: pygame.Surface) -> Pixels:
    """The pixels of a 32-bit surface itself: (height, width, 4), blue, green, red, unused. They lock the surface."""
    width, height = surface.get_size()
    view: Any = surface.get_view("0")  # a buffer, which its types do not say
    return np.frombuffer(view, np.uint8).reshape(height, width, 4)
