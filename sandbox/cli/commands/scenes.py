"""`softcradle scenes`: the list of scenes, or the file of one of them."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from softcradle.sandbox.cli.arguments import completed, scene_words
from softcradle.sandbox.console import console, print_table, table
from softcradle.sandbox.scene_runs import load_scene

if TYPE_CHECKING:
    from softcradle.scenes import Scene


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    scene = parser.add_argument(
        "scene", metavar="SCENE", nargs="?", help="print the file of this scene instead of the list"
    )
    completed(scene, scene_words)
    parser.add_argument("--json", action="store_true", help="print JSON: the list, or all of the scene")


def main(args: argparse.Namespace) -> int:
    """Print the list of scenes, or one of them."""
    if args.scene is not None:
        from softcradle.scenes import text_of

        scene = load_scene(args.scene)  # raises UserError where there is no such scene
        print(scene.model_dump_json(indent=2) + "\n" if args.json else text_of(args.scene), end="")
        return 0
    from softcradle.scenes import load, names

    scenes = {name: load(name) for name in names()}
    if args.json:
        _print_json(scenes)
        return 0
    listed = table("name", "title", "source")
    for name, scene in scenes.items():
        listed.add_row(name, scene.title, scene.source)
    print_table(console(), listed)
    return 0


def _print_json(scenes: dict[str, Scene]) -> None:
    import json

    listed = [
        {"name": name, "title": scene.title, "source": scene.source, "text": scene.text}
        for name, scene in scenes.items()
    ]
    print(json.dumps(listed, indent=2))
