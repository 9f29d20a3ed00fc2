"""Pictures of a page on a desktop and on a telephone, for the documentation: python -m tools.page_pictures FOLDER."""

import os
import sys
import tempfile
from pathlib import Path

from PIL import Image
from softcradle.sandbox.page import render_page
from softcradle.sandbox.scene_runs import load_scene

from tools.browser import Browser

# Each entry contains a name, a width, a height, a colour scheme, and a script. The script brings the page into the
# state that the picture shows.
PICTURES = (
    ("desk", 1280, 800, "light", "page.go(1.9)"),  # Time [s] of the largest force in the scene one-on-four.
    ("telephone", 390, 844, "dark", "page.go(page.source.last), page.reveal()"),
)


def main(folder: Path) -> None:
    """Write the pictures into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as made:
        page = Path(made) / "page.html"
        render_page(load_scene("one-on-four"), page)
        for name, width, height, scheme, script in PICTURES:
            with Browser(Path(made) / name) as browser:
                browser.device(width, height)
                browser.media("screen", scheme)
                browser.visit(page, "#t=0")
                browser.run(script)
                browser.picture(folder / f"{name}.png")
            with Image.open(folder / f"{name}.png") as picture:
                picture.convert("RGB").save(folder / f"{name}.png", optimize=True)


if __name__ == "__main__":
    os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    main(Path(sys.argv[1]))
