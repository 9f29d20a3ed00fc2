"""Opening: the page for the name of a scene, the path of a scene or session file, or a scene as text."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

from softcradle.sandbox.languages import _
from softcradle.sandbox.session.shared_text import is_shared_text, scene_from_text
from softcradle.sandbox.window.hanging.hanging_page import HangingPage
from softcradle.sandbox.window.hanging.hanging_text import HANGING_NAME
from softcradle.sandbox.window.window_page import Host, Page
from softcradle.scenes import Scene, load, names, parse

STANDARD_INPUT = "-"


def page_of(host: Host, name_or_path: str, leave: Callable[[], None]) -> Page:
    """The page that shows it. SceneError, UserError, ValueError or OSError with a sentence where there is none."""
    if name_or_path == HANGING_NAME:
        return HangingPage(host, leave)
    if is_shared_text(name_or_path) or name_or_path == STANDARD_INPUT:
        text = sys.stdin.read() if name_or_path == STANDARD_INPUT else name_or_path
        return _scene_page(
            host, scene_from_text(text) if is_shared_text(text) else parse(text, _("standard input")), leave
        )
    wanted = name_or_path if name_or_path in names() else str(Path(os.path.expanduser(name_or_path)))
    if wanted.lower().endswith(".npz"):
        return _replay_page(host, wanted, leave)
    return _scene_page(host, load(wanted), leave)


def _scene_page(host: Host, scene: Scene, leave: Callable[[], None]) -> Page:
    from softcradle.sandbox.session.session import Session
    from softcradle.sandbox.window.scene.scene_page import ScenePage

    return ScenePage(host, Session(scene, clock=host.clock), leave)


def _replay_page(host: Host, path: str, leave: Callable[[], None]) -> Page:
    from softcradle.sandbox.session.replay import Replay
    from softcradle.sandbox.window.scene.scene_page import ScenePage

    replay = Replay.load(path, host.clock)
    return ScenePage(host, replay.session, leave, replay)
