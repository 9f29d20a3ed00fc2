"""The bounds of the story as a script of pages: `make story` writes `assets/page/story.js`.

The words of pages are in `assets/page/words.js`, because they name the bodies of each page (beads, wagons, cylinders).
tests/sandbox/story/test_same_story.py fails if it is out of date.
"""

from __future__ import annotations

import json
from pathlib import Path

from softcradle.sandbox.files import resource
from softcradle.sandbox.story import ending, outcome, sentences

SCRIPT = "page/story.js"
HEAD = "// The bounds of the story of a motion, written by `make story` from sandbox/story/. Do not edit.\n\n"


def page_script() -> str:
    """Return the text of the script."""
    story = {
        "together": outcome.TOGETHER,
        "resolution": outcome.RESOLUTION,
        "slow": outcome.SLOW,
        "momentum": outcome.STILL_MOMENTUM,
        "energy": outcome.STILL_ENERGY,
        "stands": outcome.AT_REST,
        "equal": outcome.EQUAL,
        "atRest": ending.AT_REST,
        "groups": sentences.MOST_GROUPS,
        "digits": sentences.SPEED_DIGITS,
    }
    lines = "".join(f"  {key}: {json.dumps(value)},\n" for key, value in story.items())
    return f"{HEAD}const STORY = {{\n{lines}}};\n"


def main() -> None:
    """Write the script."""
    path = Path(resource("page/page.js")).with_name(Path(SCRIPT).name)
    path.write_text(page_script(), encoding="utf-8")


if __name__ == "__main__":
    main()
