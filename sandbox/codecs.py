"""Kinds of film: which codec, with which settings, and what each cannot do; the way from a surface to its frame."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import av
import numpy as np
import pygame
from numpy.typing import NDArray
from PIL import Image

from sandbox.errors import UserError

PIXELS = ("yuv420p", "yuv444p")
SMALLEST, LARGEST = (160, 90), (7680, 4320)
SLOWEST, FASTEST = 1.0, 240.0  # frames a second
COMMON_COLOURS = 96  # of a GIF's 256: those that fill most of the picture are kept exactly
BT709, BT601, LIMITED = 1, 6, 1  # as FFmpeg numbers them

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
    def palette(self) -> bool:
        """Whether frames are numbers of 256 colours."""
        return self.pixels == "pal8"

    def tag(self, context: Any) -> None:
        """Say in the file what the colours mean, or players guess and shift them."""
        if not self.palette:
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
        options=(("preset", "10"), ("crf", "22"), ("svtav1-params", "")),
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


def frame_of(surface: pygame.Surface, codec: Codec, palette: Image.Image | None) -> av.VideoFrame:
    """The surface as a frame for `codec`; a copy, so that the surface is free again."""
    if palette is None:
        frame = av.VideoFrame.from_numpy_buffer(pixels_of(surface), format="bgra")
        return frame.reformat(format=codec.pixels, dst_colorspace=codec.matrix, dst_color_range="MPEG")
    # Without dither flat areas stay flat, and what stands still stays the same from frame to frame.
    numbers = image_of(surface).quantize(palette=palette, dither=Image.Dither.NONE)
    colours = np.full((256, 4), 255, np.uint8)
    colours[:, 1:] = np.array(palette.getpalette("RGB"), np.uint8).reshape(256, 3)
    picture: Any = (np.asarray(numbers), colours)  # PyAV documents the pair; its types do not
    return av.VideoFrame.from_ndarray(picture, format="pal8")


def pixels_of(surface: pygame.Surface) -> Pixels:
    """The pixels of a 32-bit surface itself: (height, width, 4), blue, green, red, unused. They lock the surface."""
    width, height = surface.get_size()
    view: Any = surface.get_view("0")  # a buffer, which its types do not say
    return np.frombuffer(view, np.uint8).reshape(height, width, 4)


def image_of(surface: pygame.Surface) -> Image.Image:
    """A copy of the surface as a picture."""
    return Image.frombytes("RGB", surface.get_size(), surface.get_view("0").raw, "raw", "BGRX")


def gif_palette(sample: pygame.Surface) -> Image.Image:
    """Picture that carries 256 colours: the commonest of `sample` as they are, the others where they do best."""
    picture = image_of(sample)
    counted: Any = picture.getcolors(picture.width * picture.height)
    common = [colour for _, colour in sorted(counted, reverse=True)[:COMMON_COLOURS]]
    others = picture.quantize(256 - len(common), dither=Image.Dither.NONE).getpalette("RGB") or []
    flat = [part for colour in common for part in colour] + others
    palette = Image.new("P", (1, 1))
    palette.putpalette((flat + [0] * 768)[:768])
    return palette
