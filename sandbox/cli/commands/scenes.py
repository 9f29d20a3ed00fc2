"""`softcradle scenes`: print the list of scenes, or the file of one scene."""

import argparse
import sys

from softcradle.sandbox.cli.arguments import completed, scene_words
from softcradle.sandbox.console import print_json, print_rows
from softcradle.sandbox.scene_runs import load_scene


def add_arguments(parser: argparse.ArgumentParser) -> None:
    scene = parser.add_argument(
        "scene", metavar="SCENE", nargs="?", help="print the file of this scene instead of the list"
    )
    completed(scene, scene_words)
    parser.add_argument(
        "--json", action="store_true", help="print JSON: the list, or all of the scene (mass null: a wall)"
    )


def main(args: argparse.Namespace) -> int:
    """Print the list of scenes, or the file of one scene."""
    if args.scene is not None:
        from softcradle.scenes import text_of

        scene = load_scene(args.scene)  # `load_scene` raises UserError if the scene does not exist.
        _print_file(scene.model_dump_json(indent=2) + "\n" if args.json else text_of(args.scene))
        return 0
    from softcradle.scenes import load, names

    scenes = {name: load(name) for name in names()}
    if args.json:
        print_json(
            [{"name": name, **scene.model_dump(include={"title", "source", "text"})} for name, scene in scenes.items()]
        )
    else:
        print_rows(("name", "title", "source"), [(name, scene.title, scene.source) for name, scene in scenes.items()])
    return 0


def _print_file(text: str) -> None:
    """Print the text of a scene file. The output is encoded as UTF-8 like the file. Output to a terminal has the
    encoding of the terminal.
    """
    if sys.stdout.isatty() or not hasattr(sys.stdout, "buffer"):
        print(text, end="")
        return
    sys.stdout.flush()
    sys.stdout.buffer.write(text.encode())
