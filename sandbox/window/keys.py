"""The one table of keys: pressed keys are looked up in it, and the help overlay is made from it."""

from __future__ import annotations

from typing import NamedTuple

import pygame
from softcradle.sandbox.draw.number_format import MINUS
from softcradle.sandbox.window.plots.plot_kinds import PLOT_KINDS

CTRL, SHIFT, PLAIN = pygame.KMOD_CTRL, pygame.KMOD_SHIFT, 0
_NAMES = {
    pygame.K_SPACE: "Space",
    pygame.K_ESCAPE: "Esc",
    pygame.K_RETURN: "Enter",
    pygame.K_DELETE: "Del",
    pygame.K_BACKSPACE: "Backspace",
    pygame.K_LEFT: "←",
    pygame.K_RIGHT: "→",
    pygame.K_UP: "↑",
    pygame.K_DOWN: "↓",
    pygame.K_HOME: "Home",
    pygame.K_END: "End",
    pygame.K_PERIOD: ".",
    pygame.K_COMMA: ",",
    pygame.K_MINUS: MINUS,
    pygame.K_EQUALS: "+",
    pygame.K_TAB: "Tab",
    pygame.K_F1: "F1",
    pygame.K_F9: "F9",
    pygame.K_F10: "F10",
    pygame.K_F11: "F11",
    pygame.K_F12: "F12",
}


class Key(NamedTuple):
    """A key with its modifiers (CTRL, SHIFT or both); the command key of a Mac counts as Ctrl."""

    code: int
    modifiers: int = PLAIN

    def __str__(self) -> str:
        parts = [name for bit, name in ((CTRL, "Ctrl"), (SHIFT, "Shift")) if self.modifiers & bit]
        return "+".join([*parts, _NAMES.get(self.code) or chr(self.code).upper()])


class Binding(NamedTuple):
    """What some keys do: the name of the action, the keys, and the group and line of the help."""

    action: str
    keys: tuple[Key, ...]
    group: str
    text: str


def _keys(*keys: int | tuple[int, int]) -> tuple[Key, ...]:
    return tuple(Key(*key) if isinstance(key, tuple) else Key(key) for key in keys)


_BINDINGS: tuple[Binding, ...] = (
    Binding("play_pause", _keys(pygame.K_SPACE), "Time", "play or pause"),
    Binding("forward", _keys(pygame.K_PERIOD), "Time", "one frame forward"),
    Binding("back", _keys(pygame.K_COMMA), "Time", "one frame back"),
    Binding("slower", _keys(pygame.K_MINUS, pygame.K_LEFTBRACKET), "Time", "slower motion"),
    Binding("faster", _keys(pygame.K_EQUALS, pygame.K_RIGHTBRACKET), "Time", "faster motion"),
    Binding("restart", _keys(pygame.K_r), "Time", "restart"),
    Binding("first", _keys(pygame.K_HOME), "Time", "to the oldest frame"),
    Binding("last", _keys(pygame.K_END), "Time", "to the latest frame"),
    Binding("previous_event", _keys((pygame.K_COMMA, SHIFT)), "Time", "to the previous contact event"),
    Binding("next_event", _keys((pygame.K_PERIOD, SHIFT)), "Time", "to the next contact event"),
    Binding("select_left", _keys(pygame.K_LEFT), "Beads", "select the neighbour on the left"),
    Binding("select_right", _keys(pygame.K_RIGHT), "Beads", "select the neighbour on the right"),
    Binding("add_bead", _keys(pygame.K_a), "Beads", "add a bead right of the selected"),
    Binding("remove_bead", _keys(pygame.K_DELETE, pygame.K_BACKSPACE), "Beads", "remove the selected bead"),
    Binding("lock", _keys(pygame.K_l), "Beads", "lock or unlock the selected contact"),
    Binding("law", _keys(pygame.K_g), "Beads", "contact: power law or draft gear"),
    Binding("law_all", _keys((pygame.K_g, SHIFT)), "Beads", "all contacts: power law or draft gear"),
    Binding("undo", _keys((pygame.K_z, CTRL)), "Beads", "undo the last edit"),
    Binding("redo", _keys((pygame.K_y, CTRL), (pygame.K_z, CTRL | SHIFT)), "Beads", "redo"),
    Binding("logarithmic", _keys(pygame.K_o), "Plots", "overlaps: logarithmic or linear axis"),
    Binding("plots", _keys(pygame.K_b), "Plots", "hide or show all plots"),
    Binding("fit", _keys(pygame.K_f), "View", "frame all beads"),
    Binding("zoom_in", _keys(pygame.K_UP), "View", "zoom in (or wheel)"),
    Binding("zoom_out", _keys(pygame.K_DOWN), "View", "zoom out"),
    Binding("pause_at_end", _keys(pygame.K_e), "Time", "pause at the end, or play on"),
    Binding("arrows", _keys(pygame.K_v), "View", "arrows: velocity, momentum, force"),
    Binding("lesson", _keys(pygame.K_q), "Tools", "a question: predict, then run"),
    Binding("values", _keys(pygame.K_t), "Tools", "table of values in place of the plots"),
    Binding("tell", _keys(pygame.K_w), "Tools", "what happened, in words"),
    Binding("copy_values", _keys(pygame.K_c), "Tools", "copy all values as CSV"),
    Binding("copy_scene", _keys((pygame.K_c, CTRL)), "Tools", "copy the scene as text, to share it"),
    Binding("paste", _keys((pygame.K_v, CTRL)), "Tools", "open a scene that was copied as text"),
    Binding("compare", _keys((pygame.K_d, CTRL)), "Tools", "the scene beside a copy, to compare"),
    Binding("stopwatch", _keys(pygame.K_k), "Tools", "stopwatch: start, stop, put away"),
    Binding("ruler", _keys(pygame.K_u), "Tools", "ruler, on or off"),
    Binding("data", _keys(pygame.K_x), "Tools", "measured data over a plot, or off"),
    Binding("signals", _keys((pygame.K_8, SHIFT)), "Tools", "choose two signals to plot"),
    Binding("sweep", _keys(pygame.K_y), "Tools", "nine values of a slider side by side"),
    Binding("tools", _keys(pygame.K_F10), "Tools", "the menu of tools"),
    Binding("method", _keys(pygame.K_m), "View", "next method"),
    Binding("inspector", _keys(pygame.K_i), "View", "hide or show the panel on the right"),
    Binding("sound", _keys(pygame.K_n), "View", "sound: clicks, tones of forces, off"),
    Binding("save_scene", _keys((pygame.K_s, CTRL)), "Save", "save the scene as a file"),
    Binding("save_session", _keys((pygame.K_s, CTRL | SHIFT)), "Save", "save the session, to be replayed"),
    Binding("export", _keys((pygame.K_e, CTRL)), "Save", "export the history as .npz or .csv"),
    Binding("share_page", _keys((pygame.K_h, CTRL)), "Save", "share what was played as a page"),
    Binding("screenshot", _keys(pygame.K_p, pygame.K_F12), "Save", "screenshot"),
    Binding("film", _keys((pygame.K_r, CTRL)), "Save", "begin or end a film of the window"),
    Binding("open", _keys((pygame.K_o, CTRL)), "Save", "open a file (or drop it here)"),
    Binding("search", _keys((pygame.K_f, CTRL)), "Window", "search the gallery"),
    Binding("next_control", _keys(pygame.K_TAB), "Window", "next control: Enter, arrows"),
    Binding("previous_control", _keys((pygame.K_TAB, SHIFT)), "Window", "previous control"),
    Binding("help", _keys(pygame.K_F1, pygame.K_h), "Window", "this help"),
    Binding("theme", _keys(pygame.K_F9), "Window", "dark or light theme"),
    Binding("fullscreen", _keys(pygame.K_F11), "Window", "fullscreen"),
    Binding("larger", _keys((pygame.K_EQUALS, CTRL)), "Window", "everything larger"),
    Binding("smaller", _keys((pygame.K_MINUS, CTRL)), "Window", "everything smaller"),
    Binding("normal", _keys((pygame.K_0, CTRL)), "Window", "normal size"),
    Binding("leave", _keys(pygame.K_ESCAPE), "Window", "close, deselect, back to the gallery"),
    Binding("quit", _keys((pygame.K_q, CTRL)), "Window", "quit"),
)


def bindings() -> tuple[Binding, ...]:
    """All bindings: those of the plots, and the others."""
    plots = (Binding(kind.name, _keys(kind.key), "Plots", kind.help) for kind in PLOT_KINDS.values())
    return (*plots, *_BINDINGS)


def action_of(code: int, modifiers: int) -> str | None:
    """The action of a pressed key, or None. Signs count with Shift too: on some keyboards they need it."""
    held = CTRL if modifiers & (pygame.KMOD_CTRL | pygame.KMOD_META) else PLAIN
    held |= SHIFT if modifiers & pygame.KMOD_SHIFT else PLAIN
    if modifiers & pygame.KMOD_ALT:
        return None
    actions = {key: binding.action for binding in bindings() for key in binding.keys}
    return actions.get(Key(code, held)) or (actions.get(Key(code)) if held == SHIFT and code < pygame.K_a else None)


def hint(action: str) -> str:
    """The text of a tooltip: what the action does, and its first key."""
    binding = next(binding for binding in bindings() if binding.action == action)
    return f"{binding.text} ({binding.keys[0]})"


def groups() -> dict[str, list[Binding]]:
    """The bindings by group, in the order of the table."""
    found: dict[str, list[Binding]] = {}
    for binding in bindings():
        found.setdefault(binding.group, []).append(binding)
    return found
