"""The screen reader: messages, dialogs and the control in focus, told to the system by accesskit where it is installed."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, NamedTuple

import pygame
from pygame_gui.core import UIElement
from softcradle.sandbox.languages import _
from softcradle.sandbox.window.dialog import Dialog, EntryDialog, Menu
from softcradle.sandbox.window.keys import binding_of
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.widgets import Slider, TextBox, TextEntry

ROOT, STATUS, CONTROL = 1, 2, 3  # numbers of the nodes: the window, what is said, the control that has the focus


class Spoken(NamedTuple):
    """What there is to say: the sentence of a dialog or of the last message, and the control that has the focus."""

    status: str
    control: str


def spoken_by(window: Host) -> Spoken:
    """What a window has to say now."""
    dialog, visible = window.dialog, window.messages.visible
    if isinstance(dialog, Dialog) and dialog.open:
        focused = list(dialog.choices)[dialog.focus] if dialog.focus >= 0 else ""
        if isinstance(dialog, EntryDialog) and dialog.entry.is_focused:
            focused = control_name(dialog.entry)
        return Spoken(f"{dialog.title}. {dialog.note}", focused)
    status = visible[-1].text if visible else ""
    if isinstance(dialog, Menu) and dialog.open:
        return Spoken(status, _(binding_of(dialog.names[dialog.focus]).text))
    return Spoken(status, control_name(window.focus.control))


def control_name(control: UIElement | None) -> str:
    """Name of a control: its text, or what its tooltip says; of a slider its place, of a line to type in its text as well."""
    if control is None:
        return ""
    if isinstance(control, Slider):
        return f"{control.name} {100.0 * control.get_current_value():.0f} %".strip()
    if isinstance(control, TextEntry | TextBox):
        return f"{control.name} {control.get_text()}".strip()
    text = getattr(control, "text", "") or getattr(control, "selected_option", ("",))[0]
    return str(text or getattr(control, "tool_tip_text", "") or "")


class ScreenReader:
    """The adapter of accesskit; it is told nothing where there is none.

    Attributes:
        spoken: what was said last.
    """

    def __init__(self, title: str) -> None:
        self.title, self.spoken = title, Spoken("", "")
        self._kit: Any = None
        self._adapter: Any = None
        try:
            import accesskit

            self._kit = accesskit
            self._adapter = _adapter(accesskit, self._tree)
        except (ImportError, AttributeError, OSError, RuntimeError, pygame.error):
            self._adapter = None  # none is installed, or this system has none

    def tell(self, spoken: Spoken) -> None:
        """Say what is new."""
        if spoken == self.spoken:
            return
        self.spoken = spoken
        if self._adapter is not None:
            events = self._adapter.update_if_active(self._tree)
            if events is not None:  # Windows and macOS hand the events back to be raised
                events.raise_events()

    def take_focus(self, focused: bool) -> None:
        """Tell the system whether the window has the keyboard."""
        tell = getattr(self._adapter, "update_window_focus_state", None)
        if tell is not None:
            tell(focused)

    def _tree(self) -> Any:
        return tree_of(self._kit, self.title, self.spoken)


def tree_of(kit: Any, title: str, spoken: Spoken) -> Any:
    """The nodes for a system: a window with a sentence, read out as soon as it changes, and the control in focus."""
    window, status, control = kit.Node(kit.Role.WINDOW), kit.Node(kit.Role.LABEL), kit.Node(kit.Role.BUTTON)
    window.set_label(title)
    window.set_children([STATUS, CONTROL])
    status.set_value(spoken.status)
    status.set_live(kit.Live.POLITE)
    control.set_label(spoken.control)
    update = kit.TreeUpdate(CONTROL if spoken.control else ROOT)
    tree = kit.Tree(ROOT)
    tree.toolkit_name = "pygame"
    update.tree = tree
    for number, node in ((ROOT, window), (STATUS, status), (CONTROL, control)):
        update.nodes.append((number, node))
    return update


def _adapter(kit: Any, tree: Callable[[], Any]) -> Any:
    """The adapter of this system. The keys of the window do what a screen reader could ask for: it asks for nothing."""

    def ignore(*request: Any) -> None:
        return

    if sys.platform == "win32":
        return kit.windows.SubclassingAdapter(pygame.display.get_wm_info()["window"], tree, ignore)
    if sys.platform == "darwin":
        return kit.macos.SubclassingAdapter.for_window(pygame.display.get_wm_info()["window"], tree, ignore)
    return kit.unix.Adapter(tree, ignore, ignore)
