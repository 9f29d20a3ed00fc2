"""`softcradle scenes`: the list of scenes, or the file of one of them."""

from __future__ import annotations

import argparse

from softcradle.sandbox.console import console, table
from softcradle.sandbox.scene_runs import load_scene


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("scene", metavar="SCENE", nargs="?", help="print the file of this scene instead of the list")


def main(args: argparse.Namespace) -> int:
    """Print the list of scenes, or the file of one."""
    if args.scene is not None:
        from softcradle.scenes import text_of

        load_scene(args.scene)  # raises UserError where there is no such scene
        print(text_of(args.scene), end="")
        return 0
    from softcradle.scenes import load, names

    listed = table("name", "title", "source")
    for name in names():
        scene = load(name)
        listed.add_row(name, scene.title, scene.source)
    console().print(listed)
    return 0
