"""`softcradle page`: write a web page in one file that simulates a scene live, in any browser."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from softcradle.sandbox.cli.arguments import WrittenFiles, add_open, add_scene, positive_number
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.user_error import UserError

if TYPE_CHECKING:
    from softcradle.scenes import Scene


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_scene(parser)
    parser.add_argument("-o", "--output", required=True, metavar="OUT.html", help="the page")
    parser.add_argument(
        "--slow", type=positive_number, help="seconds of the page for a second of motion (default: the scene's)"
    )
    add_open(parser)


def main(args: argparse.Namespace) -> int:
    """Write the page."""
    if not args.output.lower().endswith((".html", ".htm")):
        raise UserError(f"a page's name must end in .html, not {args.output!r}")
    scene, written = load_scene(args.scene), WrittenFiles([Path(args.output)])
    write_scene_page(scene, args.output, written, args.open, slow=args.slow)
    return 0


def write_scene_page(scene: Scene, output: str, written: WrittenFiles, show: bool, **settings: Any) -> None:
    """Write the page of `scene`, and report its size and content."""
    from softcradle.sandbox.page import render_page

    report = render_page(scene, output, **settings)
    what = "in which the beads live" if report.computed else "that plays what was recorded"
    written.report([report.output], f", a page of {report.size / 1000:.0f} kB {what}", show)
