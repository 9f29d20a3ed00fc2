"""Output for screen readers: messages, dialogs and the control in focus, passed to the system by accesskit if it is
installed.
"""

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

ROOT, STATUS, CONTROL = 1, 2, 3  # Identifiers of the nodes: the window, the status text, and the control in focus.


class Spoken(NamedTuple):
    """The texts for a screen reader: the text of a dialog or of the newest message, and the name of the control in
    focus.
    """

    status: str
    control: str


def spoken_by(window: Host) -> Spoken:
    """Return the present texts of a window for a screen reader."""
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
    """Return the name of a control: its text or tooltip. A slider adds its position, a text field its text."""
    if control is None:
        return ""
    if isinstance(control, Slider):
        return f"{control.name} {100.0 * control.get_current_value():.0f} %".strip()
    if isinstance(control, TextEntry | TextBox):
        return f"{control.name} {control.get_text()}".strip()
    text = getattr(control, "text", "") or getattr(control, "selected_option", ("",))[0]
    return str(text or getattr(control, "tool_tip_text", "") or "")


class ScreenReader:
    """Adapter to accesskit. It does nothing if accesskit is not installed.

    Attributes:
        spoken: texts that were passed on last.
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
            self._adapter = None  # accesskit is not installed or does not support this system.

    def tell(self, spoken: Spoken) -> None:
        """Pass the texts to the system if they have changed."""
        if spoken == self.spoken:
            return
        self.spoken = spoken
        if self._adapter is not None:
            events = self._adapter.update_if_active(self._tree)
            if events is not None:  # On Windows and macOS the caller has to raise the events.
                events.raise_events()

    def take_focus(self, focused: bool) -> None:
        """Report to the system if the window has the keyboard focus."""
        tell = getattr(self._adapter, "update_window_focus_state", None)
        if tell is not None:
            tell(focused)

    def _tree(self) -> Any:
        return tree_of(self._kit, self.title, self.spoken)


def tree_of(kit: Any, title: str, spoken: Spoken) -> Any:
    """Return the accessibility tree: the window, a status text that is read aloud when it changes, and the control in
    focus.
    """
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
    """Return the accesskit adapter of this operating system.

    Requests of a screen reader are ignored: everything that it could request can be done with the keys of the window.
    """

    def ignore(*request: Any) -> None:
        return

    if sys.platform == "win32":
        return kit.windows.SubclassingAdapter(pygame.display.get_wm_info()["window"], tree, ignore)
    if sys.platform == "darwin":
        return kit.macos.SubclassingAdapter.for_window(pygame.display.get_wm_info()["window"], tree, ignore)
    return kit.unix.Adapter(tree, ignore, ignore)
