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
    parser.add_argument("--fps", type=positive, help="frames a second (default: 60, less for moving pictures)")
    parser.add_argument("--slow", type=positive, help="seconds of film for a second of motion (default: the scene's)")
    parser.add_argument("--pixel-format", metavar="FORMAT", help="of an .mp4: yuv420p (plays everywhere) or yuv444p")
    add_method(parser)


def main(args: argparse.Namespace) -> int:
    """Render it."""
    scene = load_scene(args.scene)
    from sandbox.render import render_scene

    report = render_scene(
        scene,
        args.output,
        size=args.size,
        fps=args.fps,
        slow=args.slow,
        method=args.method,
        step=args.step,
        pixels=args.pixel_format,
    )
    frames = f"{report.frames} frames, {report.duration:.1f} s of film" if report.frames > 1 else "one picture"
    print(f"written: {report.output}, {frames}, in {report.seconds:.1f} s")
    return 0
