"""The window as a state machine. Hypothesis draws user actions in any order and shortens a sequence of actions that
fails.

python -m tests.helpers.window_machine [--seed 0] [--minutes 60]

The command prints a failure as the shortest list of steps that it found. With `--minutes`, it tries one seed after
another for the given time.
"""

import argparse
import itertools
import os
import tempfile
from contextlib import ExitStack
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import pygame
import pytest
from hypothesis import HealthCheck, seed, settings, stateful
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule
from softcradle.sandbox.session.inputs import Input
from softcradle.sandbox.session.snapshots import NOTHING_HELD
from softcradle.sandbox.window import app
from softcradle.sandbox.window.dialog import EntryDialog
from softcradle.sandbox.window.keys import CTRL, SHIFT, Key, bindings
from softcradle.sandbox.window.scene.page import ScenePage
from softcradle.sandbox.window.theme import collect_garbage

from softcradle import scenes
from tests.helpers import sessions
from tests.helpers.windows import FRAME, Driver, faults, pressed, rarely, widgets

KINDS = ("bead", "contact", "widget", "plot", "bar", "window")


class Place(NamedTuple):
    """A place in the window, or on an item in the window."""

    kind: str  # Kind of the item, one of KINDS. If the page does not contain such an item, the whole window is used.
    number: int  # Number of the bead, contact, widget or plot. The number is taken modulo the number of existing items.
    across: float  # Position inside the rectangle of the plot, bar or window, as fractions of its width and height.
    down: float


_SHARES = st.sampled_from((0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0))
PLACES = st.builds(Place, st.sampled_from(KINDS), st.integers(0, 60), _SHARES, _SHARES)


def point_of(place: Place, driver: Driver) -> tuple[int, int]:
    """Return the pixel of `place`. The pixel is always inside the present window, because a pointer cannot leave the
    window.
    """
    page, (width, height) = driver.app.page, driver.app.size
    rects = {"widget": [(*one.rect.center, 1, 1) for one in widgets(driver)]}
    if isinstance(page, ScenePage):
        lanes = page.view.lanes
        rects["bead"] = [(*lane.centre(k), 1, 1) for lane in lanes for k in range(len(lane.edges))]
        rects["contact"] = [(x, lane.centre(0)[1], 1, 1) for lane in lanes for x in lane.contacts]
        rects |= {"plot": [plot.area for plot in page.board.plots], "bar": [page.timeline.rect]}
    found = rects.get(place.kind) or [(0, 0, width, height)]
    left, top, wide, high = found[place.number % len(found)]
    x, y = left + place.across * (wide - 1), top + place.down * (high - 1)
    return min(max(round(x), 0), width - 1), min(max(round(y), 0), height - 1)


# Actions that are left out. These actions would close the window, or they need a real screen or loudspeaker.
LEFT_OUT = {"quit", "fullscreen", "sound"}
KEYS = tuple(key for binding in bindings() if binding.action not in LEFT_OUT for key in binding.keys)
UNDO_KEYS = (Key(pygame.K_z, CTRL), Key(pygame.K_z, CTRL | SHIFT))
STARTS = ("one-on-four", "beads-against-gear", "driven-cluster", "", *scenes.names())
SIZES = ((1280, 720), (800, 600), (1000, 600), (1600, 900))
TEXTS = ("1", "0.1", "1e-3", "250", "-2", "0", "nan", "1e99", "x", "")
LEAVING = (pygame.WINDOWFOCUSLOST, pygame.WINDOWMINIMIZED, pygame.WINDOWRESTORED, pygame.WINDOWFOCUSGAINED)


ON_A_SCENE = precondition(lambda self: isinstance(self.driver.app.page, ScenePage))


class WindowMachine(RuleBasedStateMachine):
    """A window and its user. The clock advances by 1/60 s per frame, and background threads are not used."""

    def __init__(self) -> None:
        super().__init__()
        self.ending = ExitStack()
        self.folder = Path(self.ending.enter_context(tempfile.TemporaryDirectory()))
        patch = self.ending.enter_context(pytest.MonkeyPatch.context())
        # Some key presses change settings. A temporary folder therefore stores the settings.
        patch.setenv("SOFTCRADLE_CONFIG", str(self.folder))
        patch.chdir(self.folder)  # Some buttons write files. The files are written to this folder.
        self.driver: Driver | None = None
        self.down = False  # True while the left button is down.

    @initialize(start=st.sampled_from(STARTS), lab=st.booleans())
    def begin(self, start: str, lab: bool) -> None:
        """Open the window with a scene or with the gallery. The window shows a few controls or all controls."""
        self.driver = Driver(start or None, lab=lab)
        self.ending.callback(self.driver.close)
        self.driver.app.warmup.submit = self._do_at_once
        pygame.scrap.put_text("")
        self.driver.frames(2)

    def _do_at_once(self, take: Any, job: Any) -> None:
        """Run a background job immediately. If the job ran in a thread, the frame that receives its result would depend
        on the speed of the machine.
        """
        try:
            result = job()
        except Exception as error:
            result = error
        self.driver.app.warmup._results.put((take, result))

    # ---- Actions of the user

    @rule(key=st.sampled_from(KEYS), times=st.sampled_from((1, 1, 1, 2, 4)))
    def press_key(self, key: Key, times: int) -> None:
        """Press a key once, or hold it down until the system has repeated it `times` times."""
        for event in pressed(key.code, key.modifiers, times=times):
            self.driver.post(event.type, **event.dict)

    @rule(keys=st.lists(st.sampled_from(KEYS), min_size=2, max_size=4), place=PLACES)
    def press_at_once(self, keys: list[Key], place: Place) -> None:
        """Press several keys and click, all between two frames."""
        turns, point = (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP), point_of(place, self.driver)
        first, *others = [pressed(key.code, key.modifiers) for key in keys]
        clicked = [pygame.Event(kind, pos=point, button=1) for kind in turns]
        self.driver.app.frame(FRAME, [*first, *clicked, *itertools.chain(*others)])
        self.down = False
        self.driver.frames()

    @precondition(lambda self: not self.down)
    @rule(place=PLACES)
    def press(self, place: Place) -> None:
        self.driver.press(point_of(place, self.driver))
        self.down = True

    @rule(place=PLACES)
    def move(self, place: Place) -> None:
        """Move the pointer. If the button is down, this is a drag."""
        self.driver.move(point_of(place, self.driver), (int(self.down), 0, 0))

    @precondition(lambda self: self.down)
    @rule(place=PLACES)
    def release(self, place: Place) -> None:
        self.driver.release(point_of(place, self.driver))
        self.down = False

    @precondition(lambda self: not self.down)
    @rule(place=PLACES)
    def click(self, place: Place) -> None:
        self.driver.click(point_of(place, self.driver))

    @rule(place=PLACES, turn=st.sampled_from((-1, 1)))
    def wheel(self, place: Place, turn: int) -> None:
        self.driver.wheel(point_of(place, self.driver), turn, (int(self.down), 0, 0))

    @rule(count=st.integers(1, 20))
    def wait(self, count: int) -> None:
        self.driver.frames(count)

    @rule()
    def play(self) -> None:
        self.driver.key(pygame.K_SPACE)

    @rule(keys=st.lists(st.sampled_from(UNDO_KEYS), min_size=1, max_size=4))
    def undo(self, keys: list[Key]) -> None:
        for key in keys:
            self.driver.key(key.code, key.modifiers)

    @ON_A_SCENE
    @rule(item=sessions.INPUTS, gesture=st.booleans())
    def change(self, item: Input, gesture: bool) -> None:
        """Apply an input that does not come from a widget."""
        self.driver.page.editor.apply(sessions.fitted(item, self.driver.session), gesture)

    @rule(name=st.sampled_from(STARTS))
    def open_scene(self, name: str) -> None:
        self.driver.app.open(name) if name else self.driver.app.ask_before_loss(self.driver.app.show_gallery)

    @ON_A_SCENE
    @rule(number=st.integers(0, 20), text=st.sampled_from(TEXTS), enter=st.booleans())
    def type_number(self, number: int, text: str, enter: bool) -> None:
        controls = list(self.driver.page.inspector.controls.values())
        if self.down or not controls:
            return
        entry = controls[number % len(controls)].entry
        self.driver.click(entry.rect.center)
        entry.set_text("")
        self.driver.type(text)
        if enter:
            self.driver.key(pygame.K_RETURN)

    @rule(title=st.sampled_from(TEXTS))
    def type_words(self, title: str) -> None:
        self.driver.key(pygame.K_F4)
        if isinstance(self.driver.app.dialog, EntryDialog) and self.driver.app.dialog.open:
            self.driver.app.dialog.entry.set_text(title)
            self.driver.key(pygame.K_RETURN)

    @rule(file=st.sampled_from(("bad.toml", "track.csv", "camera.png")))
    def drop_file(self, file: str) -> None:
        """Drop a file on the window. The file is unreadable, or it contains data to draw in the plots."""
        path = self.folder / file
        if file == "camera.png":
            pygame.image.save(pygame.Surface((8, 5)), str(path))
        else:
            path.write_text("title = 3" if file == "bad.toml" else "t,v0,v1\n0,1,0\n1,0.5,\n2,0,0.25\n")
        self.driver.drop_file(path)

    @rule(size=st.sampled_from(SIZES))
    def resize(self, size: tuple[int, int]) -> None:
        self.driver.resize(size)

    @rule(kinds=st.lists(st.sampled_from(LEAVING), min_size=1, max_size=3))
    def leave(self, kinds: list[int]) -> None:
        """Switch to another window and come back. If the button is released in the meantime, the window does not
        receive the event.
        """
        for kind in kinds:
            self.driver.post(kind)
        self.driver.post(pygame.WINDOWRESTORED)
        self.down = False

    # ---- Properties that must hold after each action

    @invariant()
    def layout_is_whole(self) -> None:
        """Check that every widget lies inside the window and overlaps no other widget."""
        assert self.driver.app.running
        found = faults(self.driver)
        assert not found, found

    @ON_A_SCENE
    @invariant()
    def session_is_consistent(self) -> None:
        """Check that all numbers are finite and all frames are in order. The picture must show the present lanes."""
        page, session = self.driver.page, self.driver.session
        sessions.check_invariants(session)
        sessions.check_order(session)
        sessions.read_all(session)
        self.driver.frames()  # Update the window after a change of the session that did not come from the window.
        assert [len(view.edges) for view in page.view.lanes] == [len(lane.chain.mass) for lane in session.lanes]
        pick = page.editor.selection
        assert pick is None or pick.index <= session.lanes[pick.lane].chain.contacts
        stack = session.undo_stack
        for name, steps in (("undo", stack.done), ("redo", stack.undone)):
            button = page.toolbar.buttons.get(name)  # The view with few controls does not contain a redo button.
            assert button.is_enabled == bool(steps) if button else self.driver.app.explore and name == "redo"
        assert session.held == NOTHING_HELD or self.down or not page.pointer.dragging

    @ON_A_SCENE
    @invariant()
    def edits_go_back_and_forth(self) -> None:
        sessions.check_round_trip(self.driver.session)

    def teardown(self) -> None:
        """Check that the recording replays bitwise, then close the window."""
        with self.ending:
            if self.driver is not None and isinstance(self.driver.app.page, ScenePage):
                sessions.check_replay(self.driver.session, self.folder / "replay.npz")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=0.0, help="least time; 0: one seed")
    args = parser.parse_args()
    app.collect_garbage = rarely(collect_garbage)
    usual = {"deadline": None, "database": None, "print_blob": False, "suppress_health_check": list(HealthCheck)}
    wanted = settings(max_examples=300, stateful_step_count=60, **usual)
    end = perf_counter() + 60.0 * args.minutes
    with tempfile.TemporaryDirectory() as folder:
        os.environ |= {"SOFTCRADLE_CACHE": folder, "SOFTCRADLE_CONFIG": folder, "LANGUAGE": "en"}
        for number in itertools.count(args.seed):
            stateful.run_state_machine_as_test(seed(number)(WindowMachine), settings=wanted)
            print(f"seed {number}: 300 examples of up to 60 steps: nothing found", flush=True)
            if perf_counter() >= end:
                break


if __name__ == "__main__":
    main()
