"""`softcradle page`: write a web page that simulates a scene live in any browser. The page is a single file."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from softcradle.sandbox.cli.arguments import WrittenFiles, add_open, add_scene, positive_number
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.user_error import UserError

if TYPE_CHECKING:
    from softcradle.scenes import Scene

PREVIEW = (1200, 630)  # Size of the picture in the preview of a link [pixels].


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_scene(parser)
    parser.add_argument("-o", "--output", required=True, metavar="OUT.html", help="the page")
    parser.add_argument(
        "--slow", type=positive_number, help="seconds of the page for a second of motion (default: the scene's)"
    )
    parser.add_argument(
        "--address",
        metavar="URL",
        help="where the page will be published; also writes the picture OUT.png for previews of links",
    )
    add_open(parser)


def main(args: argparse.Namespace) -> int:
    """Write the page of the scene."""
    if not args.output.lower().endswith((".html", ".htm")):
        raise UserError(f"a page's name must end in .html, not {args.output!r}")
    output = Path(args.output)
    picture = [output.with_suffix(".png")] if args.address else []
    if args.address and not re.fullmatch(r"https?://\S+\.html?", args.address):
        raise UserError(f"--address {args.address!r} must begin with https:// or http:// and end in .html")
    scene, written = load_scene(args.scene), WrittenFiles([output, *picture])
    write_scene_page(scene, args.output, written, args.open, slow=args.slow, address=args.address or "")
    if picture:
        from softcradle.sandbox.film.scene_film import render_scene

        render_scene(scene, picture[0], PREVIEW, progress=False)
        written.report(picture)
    return 0


def write_scene_page(scene: Scene, output: str, written: WrittenFiles, show: bool, **settings: Any) -> None:
    """Write the page of `scene`. Print its size and whether it simulates or plays a recording."""
    from softcradle.sandbox.page import render_page

    report = render_page(scene, output, **settings)
    what = "in which the beads live" if report.computed else "that plays what was recorded"
    written.report([report.output], f", a page of {report.size / 1000:.0f} kB {what}", show)
