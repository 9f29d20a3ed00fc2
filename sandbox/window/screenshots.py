"""Screenshots for the README, from the real application: python -m softcradle.sandbox.window.screenshots FOLDER."""

from __future__ import annotations

import os
import sys
from pathlib import Path

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

import pygame
from softcradle.sandbox.window.app import App
from softcradle.sandbox.window.gallery.gallery_page import GalleryPage
from softcradle.sandbox.window.scene.pick import Pick
from softcradle.sandbox.window.scene.scene_page import ScenePage

FRAME = 1.0 / 60.0  # seconds
LONGEST_WAIT = 120.0  # seconds for kernels


def run_frames(app: App, count: int) -> None:
    """Let `count` frames pass."""
    for _ in range(count):
        app.frame(FRAME)


def save(app: App, folder: Path, name: str) -> None:
    """Write the window as it is."""
    path = folder / f"{name}.png"
    pygame.image.save(app.surface, str(path))
    print(f"written: {path}")


def save_all(folder: Path) -> None:
    """Write a picture of each page."""
    app = App()
    app.warmup.complete.wait(LONGEST_WAIT)
    page = app.page
    assert isinstance(page, GalleryPage)
    while len(page.pictures) < len(page.names):
        app.frame(FRAME)
        pygame.time.wait(5)
    run_frames(app, 2)
    save(app, folder, "gallery")
    _play(app, "one-on-four", 260, Pick(0, "contact", 1))
    save(app, folder, "scene")
    _play(app, "beads-against-gear", 205, None)
    save(app, folder, "two-lanes")
    app.toggle_help()
    run_frames(app, 1)
    save(app, folder, "help")
    app.toggle_help()
    app.open("hanging-cradle")
    app.act("play_pause")
    run_frames(app, 72)
    save(app, folder, "hanging-cradle")
    app.close()


def _play(app: App, name: str, frames: int, selection: Pick | None) -> None:
    """Play a scene for some frames, then select and pause."""
    app.open(name)
    page = app.page
    assert isinstance(page, ScenePage)
    app.act("play_pause")
    run_frames(app, frames)
    page.editor.selection = selection
    app.act("play_pause")
    run_frames(app, 30)


def main() -> None:
    """Write them into the folder of the command line."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/window")
    folder.mkdir(parents=True, exist_ok=True)
    save_all(folder)


if __name__ == "__main__":
    os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    main()
