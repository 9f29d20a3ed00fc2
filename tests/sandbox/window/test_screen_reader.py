"""What the window says to a screen reader."""

import sys
from types import SimpleNamespace

import pygame
import pytest
from softcradle.sandbox.session.summary_text import summary_text
from softcradle.sandbox.window import screen_reader
from softcradle.sandbox.window.screen_reader import CONTROL, ROOT, STATUS, ScreenReader, Spoken, tree_of

from tests.helpers.windows import Driver


class Adapter:
    """Keeps what it is told."""

    def __init__(self, activation, action, deactivation) -> None:
        self.trees, self.focused = [activation()], None

    def update_if_active(self, tree) -> None:
        self.trees.append(tree())

    def update_window_focus_state(self, focused: bool) -> None:
        self.focused = focused


@pytest.fixture
def spoken(driver: Driver, monkeypatch: pytest.MonkeyPatch):
    kit = SimpleNamespace(unix=SimpleNamespace(Adapter=Adapter))
    monkeypatch.setitem(sys.modules, "accesskit", kit)
    monkeypatch.setattr(screen_reader.sys, "platform", "linux")
    monkeypatch.setattr(screen_reader, "tree_of", lambda kit, title, said: said)
    driver.app.reader = ScreenReader("softcradle")
    return driver


def test_messages_dialogs_and_controls_are_said_once(spoken):
    adapter = spoken.app.reader._adapter
    spoken.key(pygame.K_z, pygame.KMOD_CTRL)
    assert adapter.trees[-1].status == "nothing to undo"
    count = len(adapter.trees)
    spoken.frames(5)
    assert len(adapter.trees) == count
    spoken.key(pygame.K_w)
    assert adapter.trees[-1].status == f"What happened. {summary_text(spoken.session)}"
    assert adapter.trees[-1].control == "Close"
    spoken.key(pygame.K_ESCAPE)
    spoken.key(pygame.K_TAB)
    assert adapter.trees[-1].control == "← Scenes"


def test_every_control_has_a_name(spoken):
    spoken.key(pygame.K_RIGHT)
    spoken.frames(2)
    for _ in spoken.app.focus.controls():
        spoken.key(pygame.K_TAB)
        assert spoken.app.reader.spoken.control, spoken.app.focus.control


def test_the_system_hears_whether_the_window_has_the_keyboard(spoken):
    pygame.event.post(pygame.Event(pygame.WINDOWFOCUSGAINED))
    spoken.frames()
    assert spoken.app.reader._adapter.focused is True
    pygame.event.post(pygame.Event(pygame.WINDOWFOCUSLOST))
    spoken.frames()
    assert spoken.app.reader._adapter.focused is False


def test_without_accesskit_nothing_is_told(driver, monkeypatch):
    monkeypatch.setitem(sys.modules, "accesskit", None)
    reader = ScreenReader("softcradle")
    assert not reader.active
    reader.tell(Spoken("a", "b"))
    reader.take_focus(True)
    assert reader.spoken == Spoken("a", "b")


def test_the_tree_is_one_that_accesskit_takes():
    kit = pytest.importorskip("accesskit")
    update = tree_of(kit, "softcradle", Spoken("Bead 0 hit bead 1.", "Undo"))
    nodes = dict(update.nodes)
    assert set(nodes) == {ROOT, STATUS, CONTROL}
    assert nodes[STATUS].value == "Bead 0 hit bead 1."
    assert nodes[STATUS].live == kit.Live.POLITE
    assert (nodes[CONTROL].label, update.focus) == ("Undo", CONTROL)
    assert list(nodes[ROOT].children) == [STATUS, CONTROL]
