"""A fuzz of the window by seeded random input: python -m tests.helpers.window_fuzz [--minutes 60] [--seed 0]

Every frame stands for a 60th of a second. The exit code is 1 after an exception, a number that is not finite, or more than
50 MB of growth after the first tenth.
"""

from __future__ import annotations

import argparse
import os
import random
import sys
import tempfile
from pathlib import Path

import numpy as np
import pygame
from softcradle.physics import warm
from softcradle.sandbox.window.keys import CTRL, SHIFT, Key, bindings
from softcradle.sandbox.window.scene.scene_page import ScenePage

from softcradle import scenes
from tests.helpers.windows import FRAME, Driver

GROWTH = 50.0  # MB
LEFT_OUT = {"quit", "film", "save_scene", "save_session", "export", "screenshot", "fullscreen", "open", "sound"}
NUMBERS = ("1", "0.1", "1e-3", "250", "-2", "nan", "1e99", "x")  # that are typed
SIZES = ((1280, 720), (1000, 600), (1600, 900))


def fuzz_keys() -> list[Key]:
    """The first key of every action but those that write files, end the window or change the screen."""
    return [binding.keys[0] for binding in bindings() if binding.action not in LEFT_OUT]


def memory() -> float:
    """Resident memory of this process [MB]; 0 where the system does not tell."""
    status = Path("/proc/self/statm")
    return int(status.read_text().split()[1]) * os.sysconf("SC_PAGESIZE") / 2**20 if status.exists() else 0.0


class Fuzz:
    """Random input to a driver."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.random, self.driver, self.folder = random.Random(seed), Driver("one-on-four"), folder
        (self.folder / "bad.toml").write_text("title = 3")
        (self.folder / "track.csv").write_text("t,v0,v1\n0,1,0\n1,0.5,\n2,0,0.25\n")
        pygame.image.save(pygame.Surface((8, 5)), str(self.folder / "camera.png"))

    def act(self) -> None:
        """One random thing, and a few frames."""
        rng, driver = self.random, self.driver
        if driver.app.dialog is not None and driver.app.dialog.open:
            driver.key(rng.choice((pygame.K_ESCAPE, pygame.K_RIGHT, pygame.K_RETURN)))
        if not isinstance(driver.app.page, ScenePage):
            driver.app.open(rng.choice((*scenes.names(), "hanging-cradle")))
        kind = rng.choices(
            ("key", "click", "drag", "wheel", "play", "type", "cell", "undo", "batch", "resize", "drop"),
            (4, 4, 4, 1, 3, 1, 0.5, 1, 0.5, 0.05, 0.2),
        )[0]
        getattr(self, f"_{kind}")()
        driver.frames(rng.randint(1, 12))
        self.check()

    def check(self) -> None:
        """Every number that is shown is finite."""
        page = self.driver.app.page
        if isinstance(page, ScenePage):
            for lane in page.session.lanes:
                assert np.isfinite(lane.position).all()
                assert np.isfinite(lane.velocity).all()
                assert np.isfinite(lane.state.force).all()

    def _point(self) -> tuple[int, int]:
        width, height = self.driver.app.size
        page = self.driver.app.page
        if isinstance(page, ScenePage) and self.random.random() < 0.4:
            view = self.random.choice(page.view.lanes)
            return tuple(map(round, view.centre(self.random.randrange(len(view.edges)))))
        return self.random.randrange(width), self.random.randrange(60, height)

    def _key(self) -> None:
        key = self.random.choice(fuzz_keys())
        self.driver.key(key.code, key.modifiers)

    def _undo(self) -> None:
        """Some steps back, and some of them forward again."""
        for _ in range(self.random.randint(1, 5)):
            self.driver.key(pygame.K_z, self.random.choice((CTRL, CTRL, CTRL | SHIFT)))

    def _batch(self) -> None:
        """Several keys and presses that arrive in one frame."""
        for _ in range(self.random.randint(2, 6)):
            key, place = self.random.choice(fuzz_keys()), self._point()
            pygame.event.post(pygame.Event(pygame.KEYDOWN, key=key.code, mod=key.modifiers, unicode="", scancode=0))
            kind = self.random.choice((pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP))
            pygame.event.post(pygame.Event(kind, pos=place, button=1))

    def _play(self) -> None:
        self.driver.key(pygame.K_SPACE)

    def _click(self) -> None:
        self.driver.click(self._point())

    def _drag(self) -> None:
        """Drag, with keys pressed and now and then the window left while the button is down."""
        rng, driver = self.random, self.driver
        end = self._point()
        driver.drag(self._point(), end, steps=rng.randint(2, 6))
        for _ in range(rng.choice((0, 1, 1, 3))):
            self._key()
            driver.move(self._point(), (1, 0, 0))
        if rng.random() < 0.1:
            pygame.event.post(pygame.Event(rng.choice((pygame.WINDOWFOCUSLOST, pygame.WINDOWMINIMIZED))))
            pygame.event.post(pygame.Event(pygame.WINDOWRESTORED))
        if rng.random() < 0.9:  # a release that no event tells of
            driver.release(end)

    def _wheel(self) -> None:
        turn = self.random.choice((-1, 1))
        pygame.event.post(
            pygame.Event(pygame.MOUSEWHEEL, x=0, y=turn, precise_x=0.0, precise_y=float(turn), flipped=False)
        )

    def _cell(self) -> None:
        """Type into a cell of the tables of values, and on into others."""
        rng, driver = self.random, self.driver
        page = driver.app.page
        if not isinstance(page, ScenePage):
            return
        if not page.tools.covers_plots:
            driver.key(pygame.K_t)
        cells = page.tools.values.shown()
        if cells:
            driver.click(rng.choice(cells)[1].center)
        for _ in range(rng.randint(1, 4)):
            driver.type(rng.choice(("", *NUMBERS)))
            driver.key(rng.choice((pygame.K_RETURN, pygame.K_TAB, pygame.K_UP, pygame.K_DOWN, pygame.K_ESCAPE)))

    def _type(self) -> None:
        page = self.driver.app.page
        if isinstance(page, ScenePage) and page.inspector.controls:
            control = self.random.choice(list(page.inspector.controls.values()))
            self.driver.click(control.entry.rect.center)
            control.entry.set_text("")
            self.driver.type(self.random.choice(NUMBERS))
            self.driver.key(pygame.K_RETURN)

    def _resize(self) -> None:
        size = self.random.choice(SIZES)
        pygame.display.set_mode(size, pygame.RESIZABLE)
        pygame.event.post(pygame.Event(pygame.VIDEORESIZE, size=size, w=size[0], h=size[1]))

    def _drop(self) -> None:
        self.driver.drop_file(self.folder / self.random.choice(("bad.toml", "track.csv", "camera.png")))


def main() -> int:
    """Fuzz for the minutes of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=60.0, help="of simulated input")
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)  # random clicks also press the buttons that write files
        os.environ["SOFTCRADLE_CONFIG"] = folder  # keys change settings
        warm()  # kernels that are loaded later would count as growth
        growth = run(Fuzz(args.seed, Path(folder)), round(args.minutes * 60.0 / FRAME))
        os.chdir("/")
    print(f"growth after warm-up {growth:.1f} MB")
    return 1 if growth > GROWTH else 0


def run(fuzz: Fuzz, total: int) -> float:
    """`total` frames; returns the growth of memory after the first tenth [MB]."""
    warm, printed = 0.0, 0
    while fuzz.driver.app.frames < total:
        fuzz.act()
        share = fuzz.driver.app.frames / total
        warm = warm or (memory() if share > 0.1 else 0.0)
        if int(share * 10) > printed:
            printed = int(share * 10)
            print(f"{10 * printed} %: {memory():.0f} MB", flush=True)
    fuzz.driver.close()
    return memory() - warm


if __name__ == "__main__":
    sys.exit(main())
