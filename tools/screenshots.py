"""Screenshots of the real application for the documentation: python -m tools.screenshots FOLDER."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from time import perf_counter

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

import pygame
from softcradle.sandbox.draw.palette import THEMES, use_theme
from softcradle.sandbox.languages import ENGLISH, LANGUAGES, language
from softcradle.sandbox.window.app import App
from softcradle.sandbox.window.gallery import thumbnails
from softcradle.sandbox.window.gallery.page import GalleryPage
from softcradle.sandbox.window.plots.scales import motions_ahead
from softcradle.sandbox.window.scene.editor import Pick
from softcradle.sandbox.window.scene.inspector import COUNT, SweepBoard
from softcradle.sandbox.window.scene.page import ScenePage

from softcradle import scenes

FRAME = 1.0 / 60.0  # Duration of a frame [s].
LONGEST_WAIT = 120.0  # Longest time to wait for kernels [s].
STRONGEST = 1.883  # Time of the largest force in the scene one-on-four [s].
PRESSED = 0.055  # Time at which all contacts of the scene beads-against-gear are closed [s].


@contextmanager
def usual_settings() -> Iterator[None]:
    """Use English, and the settings of the first start. The user's own settings stay unchanged.

    The settings are theme, recent files and cache.
    """
    names = "SOFTCRADLE_CONFIG", "SOFTCRADLE_CACHE"
    before = {name: os.environ.get(name) for name in (*names, "LANGUAGE")}
    with tempfile.TemporaryDirectory(prefix="softcradle-") as folder:
        os.environ |= {name: str(Path(folder) / name) for name in names} | {"LANGUAGE": ENGLISH}
        try:
            yield
        finally:
            for name, value in before.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value


def run_frames(app: App, count: int) -> None:
    """Run the application for `count` frames."""
    for _ in range(count):
        app.frame(FRAME)


def save(app: App, folder: Path, name: str) -> None:
    """Write a picture of the window to `folder`."""
    path = folder / f"{name}.png"
    pygame.image.save(app.surface, str(path))
    print(f"written: {path}")


def save_all(folder: Path) -> None:
    """Write a picture of each screen of the application to `folder`."""
    # With a constant clock, no frame runs out of time. The pictures are therefore the same on every machine.
    app = App(clock=lambda: 0.0, lab=True)
    app.warmup.complete.wait(LONGEST_WAIT)
    page = app.page
    assert isinstance(page, GalleryPage)
    while page.moving:
        run_frames(app, 1)
        pygame.time.wait(5)
    run_frames(app, 2)
    save(app, folder, "gallery")
    _save_explore(app, folder)
    _play(app, "one-on-four", STRONGEST, Pick(0, "contact", 1))
    save(app, folder, "scene")
    for action, name in (("values", "values"), ("plots_menu", "tools")):
        app.act(action)
        run_frames(app, 2)
        save(app, folder, name)
        if app.dialog is not None and app.dialog.open:
            app.dialog.close()
        if action == "values":
            app.act(action)
    app.scale = 1.5
    app.rebuild()
    run_frames(app, 30)
    save(app, folder, "scale-150")
    app.scale = 1.0
    app.open("one-on-four")
    run_frames(app, 30)
    app.act("lesson")
    run_frames(app, 2)
    save(app, folder, "lesson")
    if app.dialog is not None:
        app.dialog.close()
    _play(app, "beads-against-gear", PRESSED, None)
    save(app, folder, "two-lanes")
    _save_sweep(app, folder)
    app.toggle_theme()
    run_frames(app, 30)
    save(app, folder, "dark")
    app.toggle_theme()
    _save_help(app, folder)
    _save_languages(app, folder)
    app.open("cradle")
    app.act("play_pause")
    run_frames(app, 72)
    save(app, folder, "cradle")
    app.close()


def _save_help(app: App, folder: Path) -> None:
    """Write a picture of the list of keys."""
    app.toggle_help()
    run_frames(app, 1)
    save(app, folder, "help")
    app.toggle_help()


def _save_explore(app: App, folder: Path) -> None:
    """Write a picture of a scene in Explore."""
    app.toggle_level()
    _play(app, "one-on-four", STRONGEST, None)
    save(app, folder, "explore")
    app.toggle_level()


def _save_languages(app: App, folder: Path) -> None:
    """Write pictures of a contact in the other languages, and return to English."""
    for _ in LANGUAGES:
        app.next_language()
        if language() != ENGLISH:
            _play(app, "one-on-four", STRONGEST, Pick(0, "contact", 1))
            save(app, folder, f"scene-{language()}")
    app.messages.visible.clear()  # This line removes the name of the language, which would cover the next picture.


def _save_sweep(app: App, folder: Path) -> None:
    """Write a picture of a scene with nine values of the exponent of a contact."""
    _play(app, "one-on-four", STRONGEST, Pick(0, "contact", 0))
    page = app.page
    assert isinstance(page, ScenePage)
    page.inspector.sweep("exponent")
    board = app.dialog
    while isinstance(board, SweepBoard) and len(board.found) < COUNT:
        run_frames(app, 1)
    run_frames(app, 2)
    save(app, folder, "sweep")
    if board is not None:
        board.close()


def _play(app: App, name: str, end: float, selection: Pick | None) -> None:
    """Play a scene until the time `end` [s]. Then select an object and pause."""
    app.open(name)
    page = app.page
    assert isinstance(page, ScenePage)
    app.act("play_pause")
    while page.session.time < end:  # A loop is needed because late frames advance the time by less.
        run_frames(app, 1)
    page.editor.selection = selection
    app.act("play_pause")
    run_frames(app, 30)
    end = perf_counter() + LONGEST_WAIT
    while any(state.velocity_error is None for state in page.cards.health) and perf_counter() < end:
        run_frames(app, 1)  # Run frames until the accurate simulation in the background thread has reached this time.
        pygame.time.wait(5)


def save_thumbnails() -> None:
    """Draw the thumbnails of the catalogue of scenes that softcradle contains."""
    for theme, name in product(THEMES, scenes.names()):
        use_theme(theme)
        (thumbnails.PICTURES / theme).mkdir(parents=True, exist_ok=True)
        scene = scenes.load(name)
        picture = thumbnails.paint(scene, motions_ahead(scene))
        pygame.image.save(picture, str(thumbnails.PICTURES / theme / f"{name}.png"))


def main() -> None:
    """Write the pictures into the folder given on the command line."""
    pygame.font.init()
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/window")
    folder.mkdir(parents=True, exist_ok=True)
    with usual_settings():
        save_thumbnails()
        save_all(folder)


if __name__ == "__main__":
    os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    main()
