"""`softcradle play`, or `softcradle` alone: open the window."""

from __future__ import annotations

import argparse

from softcradle.sandbox.cli.arguments import picture_size
from softcradle.sandbox.user_error import UserError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "scene", metavar="SCENE", nargs="?", help="name of a scene, scene file, or session to replay (.npz)"
    )
    parser.add_argument(
        "--size", type=picture_size, default=(1280, 720), metavar="WxH", help="pixels (default: 1280x720)"
    )
    parser.add_argument("--fullscreen", action="store_true", help="fill the screen (F11 changes it)")


def main(args: argparse.Namespace) -> int:
    """Open the window and run it until it is closed."""
    import pygame
    from softcradle.sandbox.window.app import App

    try:
        app = App(args.size, args.scene)
    except pygame.error as error:
        raise UserError(f"cannot open a window: {error}") from None
    if args.fullscreen:
        app.toggle_fullscreen()
    app.run()
    return 0
