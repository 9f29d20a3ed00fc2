"""`softcradle scenes`: the catalogue, or the file of one scene."""

from __future__ import annotations

import argparse

from softcradle.sandbox.cli.arguments import load_scene
from softcradle.sandbox.console import console, table


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("scene", metavar="SCENE", nargs="?", help="print the file of this scene instead of the list")


def main(args: argparse.Namespace) -> int:
    """Print the list, or the file."""
    if args.scene is not None:
        from softcradle.scenes import text_of

        load_scene(args.scene)  # refuses what is no scene, in a sentence
        print(text_of(args.scene), end="")
        return 0
    from softcradle.scenes import load, names

    listed = table("name", "title", "source")
    for name in names():
        scene = load(name)
        listed.add_row(name, scene.title, scene.source)
    console().print(listed)
    return 0
