"""`softcradle render`: write a film, pictures, a kymograph (space-time diagram) or a web page of a scene."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from softcradle.sandbox.cli.arguments import (
    WrittenFiles,
    add_method,
    add_open,
    add_scene,
    picture_size,
    positive_number,
    refuse_options,
)
from softcradle.sandbox.scene_runs import load_scene

if TYPE_CHECKING:
    from softcradle.scenes import Scene

SIZE = (1280, 720)  # Default size of films and pictures [pixels].


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_scene(parser)
    parser.add_argument(
        "-o", "--output", required=True, metavar="OUT",
        help="film .mp4 .gif, one picture .png, FOLDER/ for one picture a frame, .kymograph.png for "
        "the beads over time: a line of pixels of each frame of a camera, or .html for a page in which the beads live",
    )  # fmt: skip
    parser.add_argument("--size", type=picture_size, metavar="WxH", help="pixels (default: {}x{})".format(*SIZE))
    parser.add_argument(
        "--fps",
        type=positive_number,
        help="frames a second (default: 60 for .mp4, 25 for .gif); of a kymograph: camera frames "
        "for a second of motion (default: the paper's 2052 in SI units)",
    )
    parser.add_argument(
        "--slow", type=positive_number, help="seconds of film for a second of motion (default: the scene's)"
    )
    parser.add_argument("--pixel-format", metavar="FORMAT", help="of an .mp4: yuv420p (plays everywhere) or yuv444p")
    add_method(parser)
    add_open(parser)


def main(args: argparse.Namespace) -> int:
    """Write the film, the pictures, the kymograph or the page of a scene."""
    scene, written = load_scene(args.scene), WrittenFiles([Path(args.output)])
    if args.output.lower().endswith(".kymograph.png"):
        return _kymograph(scene, args, written)
    if args.output.lower().endswith((".html", ".htm")):
        return _page(scene, args, written)
    from softcradle.sandbox.film.scene_film import render_scene

    report = render_scene(
        scene,
        args.output,
        size=args.size or SIZE,
        fps=args.fps,
        slow=args.slow,
        method=args.method,
        step=args.step,
        pixel_format=args.pixel_format,
    )
    frames = f"{report.frames} frames, {report.duration:.1f} s of film" if report.frames > 1 else "one picture"
    written.report([report.output], f", {frames}, in {report.seconds:.1f} s", args.open)
    return 0


def _kymograph(scene: Scene, args: argparse.Namespace, written: WrittenFiles) -> int:
    refuse_options(args, "a kymograph is one picture: {option} is for films", "slow", "pixel_format")
    from softcradle.sandbox.film.kymograph import render_kymograph

    report = render_kymograph(scene, args.output, args.size or SIZE, fps=args.fps, method=args.method, step=args.step)
    written.report([report.output], f", {report.frames} camera frames, in {report.seconds:.1f} s", args.open)
    return 0


def _page(scene: Scene, args: argparse.Namespace, written: WrittenFiles) -> int:
    refuse_options(args, "a page has no frames: {option} is for films and pictures", "size", "fps", "pixel_format")
    from softcradle.sandbox.cli.commands.page import write_scene_page

    write_scene_page(scene, args.output, written, args.open, slow=args.slow, method=args.method, step=args.step)
    return 0
