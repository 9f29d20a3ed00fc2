"""`softcradle play`, or `softcradle` without a command: open the window."""

import argparse
import os

from softcradle.sandbox.cli.arguments import completed, picture_size, scene_words
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.user_error import UserError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    scene = parser.add_argument(
        "scene",
        metavar="SCENE",
        nargs="?",
        help="name of a scene, scene file, session to replay (.npz), scene as text, or - for standard input",
    )
    completed(scene, scene_words)
    parser.add_argument(
        "--size", type=picture_size, default=(1280, 720), metavar="WxH", help="pixels (default: 1280x720)"
    )
    parser.add_argument("--lab", action="store_true", help="with all controls (F3 changes it; the window remembers it)")
    parser.add_argument("--fullscreen", action="store_true", help="fill the screen (F11 changes it)")


def main(args: argparse.Namespace) -> int:
    """Open the window and wait until the user closes it."""
    import pygame
    from softcradle.sandbox.window.display import require_display

    if args.scene is not None:
        _require_scene(args.scene)
    require_display()
    from softcradle.sandbox.window.app import App

    try:
        app = App(args.size, args.scene, lab=args.lab)
    except pygame.error as error:
        raise UserError(f"cannot open a window: {error}") from None
    if args.fullscreen:
        app.toggle_fullscreen()
    app.run()
    return 0


def _require_scene(wanted: str) -> None:
    """Raise UserError if a scene or file with the name `wanted` does not exist. Problems inside a file are reported by
    the window.
    """
    from softcradle.sandbox.session.export import is_shared_text
    from softcradle.sandbox.window.app import STANDARD_INPUT

    if wanted == STANDARD_INPUT or is_shared_text(wanted) or os.path.exists(wanted):
        return
    if wanted.lower().endswith(".npz"):
        raise UserError(f"cannot find the file {wanted}")
    load_scene(wanted)
