"""`softcradle render`: a film or pictures of a scene."""

from __future__ import annotations

import argparse

from sandbox.options import add_method, add_scene, load_scene, positive, size


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_scene(parser)
    parser.add_argument(
        "-o", "--output", required=True, metavar="OUT",
        help="film .mp4 .gif .webp .avif, one picture .png, or FOLDER/ for one picture a frame",
    )  # fmt: skip
    parser.add_argument("--size", type=size, default=(1280, 720), metavar="WxH", help="pixels (default: 1280x720)")
    parser.add_argument("--fps", type=positive, default=60.0, help="frames a second (default: 60)")
    parser.add_argument("--slow", type=positive, help="seconds of film for a second of motion (default: the scene's)")
    parser.add_argument("--pixel-format", metavar="FORMAT", help="of an .mp4: yuv420p (plays everywhere) or yuv444p")
    add_method(parser)


def main(args: argparse.Namespace) -> int:
    """Render it."""
    scene = load_scene(args.scene)
    from sandbox.render import render_scene

    render_scene(
        scene,
        args.output,
        size=args.size,
        fps=args.fps,
        slow=args.slow,
        method=args.method,
        step=args.step,
        pixel_format=args.pixel_format,
    )
    return 0
