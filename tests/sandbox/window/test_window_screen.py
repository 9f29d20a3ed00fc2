"""Tests of the window on a virtual screen. The programs Xvfb and xdotool create the screen and its pointer and keyboard
events.
"""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from softcradle.physics import Trajectory

from softcradle import scenes

HERE = shutil.which("Xvfb") and shutil.which("xdotool")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.own_process,  # The test kills the window if it does not respond.
    pytest.mark.skipif(not HERE, reason="needs Xvfb and xdotool, which CI installs"),
]


class Screen:
    def __init__(self, display: str, folder: Path) -> None:
        self.folder = folder
        self.environment = {**os.environ, "DISPLAY": display, "SDL_VIDEODRIVER": "x11", "SDL_AUDIODRIVER": "dummy"}
        self.log, command = folder / "stderr.txt", [sys.executable, "-m", "softcradle"]
        with self.log.open("wb") as log:
            self.process = subprocess.Popen(command, cwd=folder, env=self.environment, stderr=log)
        self.window = self.until(lambda: self.tool("search", "--onlyvisible", "--class", ".").split())[0]
        self.tool("windowfocus", "--sync", self.window)

    def tool(self, *words: str) -> str:
        done = subprocess.run(["xdotool", *words], env=self.environment, capture_output=True, text=True, check=False)
        return done.stdout

    def until(self, found: Callable[[], object]) -> list[str]:
        while not (result := found()):
            assert self.process.poll() is None, self.log.read_text()
            time.sleep(0.1)
        return result if isinstance(result, list) else []

    def key(self, *names: str) -> None:
        self.tool("key", "--window", self.window, "--delay", "150", *names)

    def drag(self, start: tuple[int, int], end: tuple[int, int]) -> None:
        points = np.linspace(start, end, 9, dtype=int).astype(str)
        first, *moves = [["mousemove", "--window", self.window, *point, "sleep", "0.05"] for point in points]
        self.tool(*first, "mousedown", "1", *(word for move in moves for word in move), "mouseup", "1", "sleep", "0.1")

    def type_path(self, text: str) -> Path:
        self.key("ctrl+a")
        self.tool("type", "--window", self.window, "--delay", "30", text)
        self.key("Return")
        return self.folder / text


@pytest.fixture
def screen(tmp_path: Path) -> Iterator[Screen]:
    # Without the option -noreset, Xvfb restarts when its last client disconnects. During the restart, Xvfb rejects new
    # clients.
    command = ["Xvfb", "-displayfd", "1", "-screen", "0", "1400x900x24", "-nolisten", "tcp", "-noreset"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as server:
        try:
            yield Screen(f":{server.stdout.readline().strip()}", tmp_path)
        finally:
            server.kill()


def test_a_scene_is_played_on_a_screen(screen: Screen, tmp_path: Path) -> None:
    screen.key("ctrl+o")
    screen.type_path("one-on-four")
    screen.until(lambda: screen.tool("getwindowname", screen.window).startswith("One bead on four"))
    exported = tmp_path / "motion.npz"

    def collided() -> bool:
        exported.unlink(missing_ok=True)
        screen.key("ctrl+e")
        screen.type_path(exported.name)
        screen.until(exported.exists)
        return Trajectory.load(str(exported)).time[-1] > 1.5

    screen.key("space")
    screen.until(collided)
    screen.drag((600, 180), (760, 180))
    assert Trajectory.load(str(exported)).velocity[0, 0] == 1.0
    # Go back to the beginning, change the method, add a bead and save the scene.
    screen.key("space")
    screen.drag((900, 652), (28, 652))
    screen.key("shift+m", "Right", "a", "ctrl+s")
    saved = screen.type_path("mine.toml")
    screen.until(saved.exists)
    scene = scenes.load(saved)
    assert len(scene.lanes[0].chain().mass) == 6
    assert scene.method == "euler"
    screen.key("ctrl+shift+s")
    screen.until(screen.type_path("played.npz").exists)
    screen.key("ctrl+q")
    assert screen.process.wait() == 0
    assert "Traceback" not in screen.log.read_text()
