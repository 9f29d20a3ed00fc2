"""What the window says to a screen reader."""

import sys
from types import SimpleNamespace
from unittest.mock import Mock

import pygame
import pytest
from softcradle.sandbox.session.summary_text import summary_text
from softcradle.sandbox.window import screen_reader
from softcradle.sandbox.window.screen_reader import CONTROL, ROOT, STATUS, ScreenReader, Spoken, tree_of

from tests.helpers.windows import Driver


@pytest.fixture
def adapter(driver: Driver, monkeypatch: pytest.MonkeyPatch) -> Mock:
    """That of a system, to which the window of `driver` speaks."""
    made = Mock(update_if_active=Mock(return_value=None))
    kit = SimpleNamespace(unix=SimpleNamespace(Adapter=lambda tree, action, deactivation: made))
    monkeypatch.setitem(sys.modules, "accesskit", kit)
    monkeypatch.setattr(screen_reader.sys, "platform", "linux")
    monkeypatch.setattr(screen_reader, "tree_of", lambda kit, title, said: said)
    driver.app.reader = ScreenReader("softcradle")
    return made


def test_messages_dialogs_and_controls_are_said_once(driver: Driver, adapter: Mock) -> None:
    def said() -> Spoken:
        return adapter.update_if_active.call_args.args[0]()

    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert said().status == "nothing to undo"
    count = adapter.update_if_active.call_count
    driver.frames(5)
    assert adapter.update_if_active.call_count == count
    driver.key(pygame.K_w)
    assert said() == (f"What happened. {summary_text(driver.session)}", "Close")
    driver.key(pygame.K_ESCAPE)
    driver.key(pygame.K_TAB)
    assert said().control == "← Scenes"
    for event, focused in ((pygame.WINDOWFOCUSGAINED, True), (pygame.WINDOWFOCUSLOST, False)):
        driver.post(event)
        adapter.update_window_focus_state.assert_called_with(focused)


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
