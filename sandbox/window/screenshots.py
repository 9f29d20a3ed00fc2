"""Screenshots for the README, from the real application: python -m softcradle.sandbox.window.screenshots FOLDER."""

from __future__ import annotations

import os
import sys
from pathlib import Path

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

import pygame
from softcradle.sandbox.window.app import App
from softcradle.sandbox.window.gallery.gallery_page import Gallery
from softcradle.sandbox.window.scene.lane_view import Pick
from softcradle.sandbox.window.scene.scene_page import Play

FRAME = 1.0 / 60.0
PATIENCE = 120.0  # seconds for kernels and thumbnails


def frames(app: App, count: int) -> None:
    """Let `count` frames pass."""
    for _ in range(count):
        app.frame(FRAME)


def keep(app: App, folder: Path, name: str) -> None:
    """Write the window as it is."""
    path = folder / f"{name}.png"
    pygame.image.save(app.surface, str(path))
    print(f"written: {path}")


def shoot(folder: Path) -> None:
    """Take all of them."""
    app = App()
    app.warmer.complete.wait(PATIENCE)
    page = app.page
    assert isinstance(page, Gallery)
    while len(page.pictures) < len(page.names):
        app.frame(FRAME)
        pygame.time.wait(5)
    frames(app, 2)
    keep(app, folder, "gallery")
    _scene(app, "one-on-four", 260, Pick(0, "contact", 1))
    keep(app, folder, "scene")
    _scene(app, "beads-against-gear", 205, None)
    keep(app, folder, "two-lanes")
    app.toggle_help()
    frames(app, 1)
    keep(app, folder, "help")
    app.toggle_help()
    app.open("hanging-cradle")
    app.act("play_pause")
    frames(app, 72)
    keep(app, folder, "hanging-cradle")
    app.close()


def _scene(app: App, name: str, count: int, pick: Pick | None) -> None:
    app.open(name)
    page = app.page
    assert isinstance(page, Play)
    app.act("play_pause")
    frames(app, count)
    page.select(pick)
    app.act("play_pause")
    frames(app, 30)


def main() -> None:
    """Take them into the folder that the command line names."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/window")
    folder.mkdir(parents=True, exist_ok=True)
    shoot(folder)


if __name__ == "__main__":
    os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    main()
