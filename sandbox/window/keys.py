"""The table of keys. Pressed keys are looked up in it, and the help overlay is generated from it."""

from __future__ import annotations

from typing import NamedTuple

import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.story.numbers import MINUS
from softcradle.sandbox.window.plots.kinds import PLOT_KINDS

CTRL, SHIFT, PLAIN = pygame.KMOD_CTRL, pygame.KMOD_SHIFT, 0
_NAMES = {
    pygame.K_SPACE: N_("Space"),
    pygame.K_ESCAPE: N_("Esc"),
    pygame.K_RETURN: N_("Enter"),
    pygame.K_DELETE: N_("Del"),
    pygame.K_BACKSPACE: N_("Backspace"),
    pygame.K_LEFT: "←",
    pygame.K_RIGHT: "→",
    pygame.K_UP: "↑",
    pygame.K_DOWN: "↓",
    pygame.K_HOME: N_("Home"),
    pygame.K_END: N_("End"),
    pygame.K_PERIOD: ".",
    pygame.K_COMMA: ",",
    pygame.K_MINUS: MINUS,
    pygame.K_PLUS: "+",
    pygame.K_TAB: N_("Tab"),
    **{getattr(pygame, f"K_F{k}"): f"F{k}" for k in range(1, 13)},
}


class Key(NamedTuple):
    """A key with its modifiers (CTRL, SHIFT or both). The command key of a Mac counts as Ctrl."""

    code: int
    modifiers: int = PLAIN

    def __str__(self) -> str:
        parts = [name for bit, name in ((CTRL, _("Ctrl")), (SHIFT, _("Shift"))) if self.modifiers & bit]
        return "+".join([*parts, _(_NAMES.get(self.code, "")) or chr(self.code).upper()])


class Binding(NamedTuple):
    """An action with its keys, and with its group and text in the help. It also states if the action repeats while the
    key is held.
    """

    action: str
    keys: tuple[Key, ...]
    group: str
    text: str
    repeated: bool = False


def _keys(*keys: int | tuple[int, int]) -> tuple[Key, ...]:
    return tuple(Key(*key) if isinstance(key, tuple) else Key(key) for key in keys)


_BINDINGS: tuple[Binding, ...] = (
    Binding("play_pause", _keys(pygame.K_SPACE), N_("Time"), N_("play or pause")),
    Binding("forward", _keys(pygame.K_PERIOD), N_("Time"), N_("one frame forward"), repeated=True),
    Binding("back", _keys(pygame.K_COMMA), N_("Time"), N_("one frame back"), repeated=True),
    Binding("slower", _keys(pygame.K_MINUS, pygame.K_LEFTBRACKET), N_("Time"), N_("slower motion"), repeated=True),
    Binding("faster", _keys(pygame.K_PLUS, pygame.K_RIGHTBRACKET), N_("Time"), N_("faster motion"), repeated=True),
    Binding("restart", _keys(pygame.K_r), N_("Time"), N_("restart")),
    Binding("first", _keys(pygame.K_HOME), N_("Time"), N_("to the oldest frame")),
    Binding("last", _keys(pygame.K_END), N_("Time"), N_("to the latest frame")),
    Binding(
        "previous_event", _keys((pygame.K_COMMA, SHIFT)), N_("Time"), N_("to the previous contact event"), repeated=True
    ),
    Binding("next_event", _keys((pygame.K_PERIOD, SHIFT)), N_("Time"), N_("to the next contact event"), repeated=True),
    Binding("select_left", _keys(pygame.K_LEFT), N_("Beads"), N_("select the neighbour on the left"), repeated=True),
    Binding("select_right", _keys(pygame.K_RIGHT), N_("Beads"), N_("select the neighbour on the right"), repeated=True),
    Binding("add_bead", _keys(pygame.K_a), N_("Beads"), N_("add a bead right of the selected")),
    Binding("remove_bead", _keys(pygame.K_DELETE, pygame.K_BACKSPACE), N_("Beads"), N_("remove the selected bead")),
    Binding("lock", _keys(pygame.K_l), N_("Beads"), N_("lock or unlock the selected contact")),
    Binding("lock_all", _keys((pygame.K_l, SHIFT)), N_("Beads"), N_("all contacts: lock or unlock")),
    Binding("law", _keys(pygame.K_g), N_("Beads"), N_("contact: power law or draft gear")),
    Binding("law_all", _keys((pygame.K_g, SHIFT)), N_("Beads"), N_("all contacts: power law or draft gear")),
    Binding("undo", _keys((pygame.K_z, CTRL)), N_("Beads"), N_("undo the last edit"), repeated=True),
    Binding("redo", _keys((pygame.K_y, CTRL), (pygame.K_z, CTRL | SHIFT)), N_("Beads"), N_("redo"), repeated=True),
    Binding("logarithmic", _keys(pygame.K_o), N_("Plots"), N_("overlaps: logarithmic or linear axis")),
    Binding("plots", _keys(pygame.K_b), N_("Plots"), N_("hide or show all plots")),
    Binding("fit", _keys(pygame.K_f), N_("View"), N_("frame all beads")),
    Binding("zoom_in", _keys(pygame.K_UP), N_("View"), N_("zoom in (or wheel)"), repeated=True),
    Binding("zoom_out", _keys(pygame.K_DOWN), N_("View"), N_("zoom out"), repeated=True),
    Binding("pause_at_end", _keys(pygame.K_e), N_("Time"), N_("stop at the end, or continue")),
    Binding("arrows", _keys(pygame.K_v), N_("View"), N_("arrows: velocity, momentum, force")),
    Binding("lesson", _keys(pygame.K_q), N_("Tools"), N_("predict first")),
    Binding("values", _keys(pygame.K_t), N_("Tools"), N_("table of values instead of plots")),
    Binding("why", _keys((pygame.K_w, SHIFT)), N_("Tools"), N_("why? the largest push, magnified")),
    Binding("tell", _keys(pygame.K_w), N_("Tools"), N_("describe what happened")),
    Binding("copy_values", _keys(pygame.K_c), N_("Tools"), N_("copy all values as CSV")),
    Binding("copy_scene", _keys((pygame.K_c, CTRL)), N_("Tools"), N_("copy the scene as text, to share it")),
    Binding("paste", _keys((pygame.K_v, CTRL)), N_("Tools"), N_("open a scene that was copied as text")),
    Binding("compare", _keys((pygame.K_d, CTRL)), N_("Tools"), N_("compare with a copy")),
    Binding("compare_balls", _keys((pygame.K_d, SHIFT)), N_("Tools"), N_("compare with steel (or soft) beads")),
    Binding("alone", _keys((pygame.K_d, CTRL | SHIFT)), N_("Tools"), N_("back to one row")),
    Binding("stopwatch", _keys(pygame.K_k), N_("Tools"), N_("stopwatch: start, stop, remove")),
    Binding("ruler", _keys(pygame.K_u), N_("Tools"), N_("ruler, on or off")),
    Binding("data", _keys(pygame.K_x), N_("Tools"), N_("measured data over a plot, or off")),
    Binding("signals", _keys((pygame.K_8, SHIFT)), N_("Tools"), N_("choose two signals to plot")),
    Binding("sweep", _keys(pygame.K_y), N_("Tools"), N_("try nine values at once")),
    Binding("share", _keys(pygame.K_F6), N_("Tools"), N_("the menu of files and sharing")),
    Binding("plots_menu", _keys(pygame.K_F7), N_("Tools"), N_("the menu of plots")),
    Binding("tools", _keys(pygame.K_F10), N_("Tools"), N_("the menu of tools")),
    Binding("method", _keys((pygame.K_m, SHIFT)), N_("View"), N_("next method")),
    Binding("inspector", _keys(pygame.K_i), N_("View"), N_("hide or show the panel on the right")),
    Binding("level", _keys(pygame.K_F3), N_("View"), N_("Explore (few controls) or Lab (all)")),
    Binding("sound", _keys(pygame.K_n), N_("View"), N_("sound: off, clicks, tones")),
    Binding("save_scene", _keys((pygame.K_s, CTRL)), N_("Save"), N_("save the scene as a file")),
    Binding("words", _keys(pygame.K_F4), N_("Save"), N_("title, text and question")),
    Binding("save_session", _keys((pygame.K_s, CTRL | SHIFT)), N_("Save"), N_("save a recording")),
    Binding("export", _keys((pygame.K_e, CTRL)), N_("Save"), N_("export data (.npz or .csv)")),
    Binding("share_page", _keys((pygame.K_h, CTRL)), N_("Save"), N_("web page of this run")),
    Binding("live_page", _keys((pygame.K_h, CTRL | SHIFT)), N_("Save"), N_("web page to play with")),
    Binding("screenshot", _keys(pygame.K_p, pygame.K_F12), N_("Save"), N_("screenshot")),
    Binding("film", _keys((pygame.K_r, CTRL)), N_("Save"), N_("record a video, or stop")),
    Binding("open", _keys((pygame.K_o, CTRL)), N_("Save"), N_("open a file (or drop it here)")),
    Binding("search", _keys((pygame.K_f, CTRL)), N_("Window"), N_("search the gallery")),
    Binding("next_control", _keys(pygame.K_TAB), N_("Window"), N_("next control: Enter, arrows"), repeated=True),
    Binding("previous_control", _keys((pygame.K_TAB, SHIFT)), N_("Window"), N_("previous control"), repeated=True),
    Binding("help", _keys(pygame.K_F1, pygame.K_h), N_("Window"), N_("this help")),
    Binding("theme", _keys(pygame.K_F9), N_("Window"), N_("dark or light theme")),
    Binding("language", _keys(pygame.K_F8), N_("Window"), N_("language (Sprache, langue)")),
    Binding("fullscreen", _keys(pygame.K_F11), N_("Window"), N_("fullscreen")),
    Binding("larger", _keys((pygame.K_PLUS, CTRL)), N_("Window"), N_("larger text"), repeated=True),
    Binding("smaller", _keys((pygame.K_MINUS, CTRL)), N_("Window"), N_("smaller text"), repeated=True),
    Binding("normal", _keys((pygame.K_0, CTRL)), N_("Window"), N_("normal size")),
    Binding("leave", _keys(pygame.K_ESCAPE), N_("Window"), N_("close, deselect, back to the gallery")),
    Binding("quit", _keys((pygame.K_q, CTRL)), N_("Window"), N_("quit")),
)


# Keys that have the same action as another key, for example on the number pad.
SAME = {
    pygame.K_EQUALS: pygame.K_PLUS,
    pygame.K_KP_PLUS: pygame.K_PLUS,
    pygame.K_KP_MINUS: pygame.K_MINUS,
    pygame.K_KP_0: pygame.K_0,
    pygame.K_KP_ENTER: pygame.K_RETURN,
}
REPEATED = frozenset(binding.action for binding in _BINDINGS if binding.repeated)


def bindings() -> tuple[Binding, ...]:
    """Return all bindings. The bindings that show or hide a plot come first."""
    plots = (Binding(kind.name, _keys(kind.key), N_("Plots"), kind.help) for kind in PLOT_KINDS.values())
    return (*plots, *_BINDINGS)


def action_of(code: int, modifiers: int, text: str = "") -> str | None:
    """Return the action of a pressed key that types `text`, or None.

    The key that types a sign depends on the keyboard layout. For example, + may share a key with = or have its own key,
    and . may need Shift. If the key itself has no action, the typed sign is looked up, with and without Shift. Keys of
    the number pad count as the same signs.
    """
    held = CTRL if modifiers & (pygame.KMOD_CTRL | pygame.KMOD_META) else PLAIN
    held |= SHIFT if modifiers & pygame.KMOD_SHIFT else PLAIN
    if modifiers & pygame.KMOD_ALT:
        return None
    code = SAME.get(code, code)
    actions = {key: binding.action for binding in bindings() for key in binding.keys}
    found = actions.get(Key(code, held))
    if found is None and len(text) == 1 and not text.isalpha():
        found = actions.get(Key(ord(text), held & CTRL))
    return found or (actions.get(Key(code, held & CTRL)) if code < pygame.K_a else None)


def binding_of(action: str) -> Binding:
    """Return the binding of an action."""
    return next(binding for binding in bindings() if binding.action == action)


def hint(action: str) -> str:
    """Return the text of a tooltip: the help text of the action and its first key."""
    binding = binding_of(action)
    return f"{_(binding.text)} ({binding.keys[0]})"


def groups() -> dict[str, list[Binding]]:
    """Return the bindings by group, in the order of the table."""
    found: dict[str, list[Binding]] = {}
    for binding in bindings():
        found.setdefault(binding.group, []).append(binding)
    return found


LINE = 21.0  # Height of a line in design pixels.
KEYS_ROOM = 134.0  # Width in design pixels of the column with the names of keys.
COLUMN = 374.0  # Width of a column in design pixels.
TITLE = 27.0  # Height of the title of a group in design pixels.
MARGIN = 26.0  # Distance in design pixels between columns, and between the columns and the edges of the help.
HEAD, FOOT = 58.0, 20.0  # Heights in design pixels of the areas above and below the columns.
# Smallest factor by which the help is scaled down to fit into the window. In smaller windows the help scrolls instead.
LEAST_SHRINKING = 0.85
MOUSE = (
    (N_("drag a bead"), N_("pull it by a spring; release to throw")),
    (N_("drag it, paused"), N_("place it")),
    (N_("click"), N_("select a bead or a contact")),
    (N_("wheel"), N_("zoom, over the beads")),
    (N_("drag beside beads"), N_("move the view; F frames all beads")),
    (N_("drag the timeline"), N_("scrub; playing on starts a new branch")),
    (N_("over a plot"), N_("read values at the cursor")),
    (N_("drop a file"), N_("open it; a table or a picture: over a plot")),
)
ORDER = N_("Time"), N_("Mouse"), N_("Save"), N_("Beads"), N_("Window"), N_("View"), N_("Plots"), N_("Tools")


def paint_help(surface: pygame.Surface, unit: float, scroll: float) -> float:
    """Draw the help over the whole `surface`, scrolled down by `scroll` pixels. Return the scroll distance.

    The distance is limited by the length of the help.
    """
    size = surface.get_size()
    shade = pygame.Surface(size)
    shade.fill(tones.shadow)
    shade.set_alpha(130)
    surface.blit(shade, (0, 0))
    blocks = {name: [(_caps(b), _(b.text)) for b in bindings] for name, bindings in groups().items()}
    blocks["Mouse"] = [(_(what), _(text)) for what, text in MOUSE]
    unit = min(unit, size[0] / (COLUMN + 4 * MARGIN))
    count = min(3, int((size[0] / unit - 2 * MARGIN) // (COLUMN + MARGIN)))
    columns = _columns({name: len(blocks[name]) * LINE + TITLE + 10 for name in ORDER}, count)
    whole = HEAD + FOOT + max(sum(column.values()) for column in columns)
    fitting = (size[1] / unit - FOOT) / whole
    unit *= fitting if LEAST_SHRINKING < fitting < 1.0 else 1.0
    board = pygame.Rect(0, 0, round((count * (COLUMN + MARGIN) + MARGIN) * unit), 0)
    board.height = min(round(whole * unit), size[1] - round(20 * unit))
    board.center = size[0] // 2, size[1] // 2
    scroll = min(max(scroll, 0.0), whole * unit - board.height)
    pygame.draw.rect(surface, tones.background, board, border_radius=round(10 * unit))
    surface.set_clip(board)
    place = board.left + MARGIN * unit, board.top + 16 * unit - scroll
    write(surface, _("Keys and mouse"), place, 22 * unit, tones.foreground, bold=True)
    place = board.right - MARGIN * unit, board.top + 22 * unit - scroll
    write(surface, _("Esc or a click closes this"), place, 13 * unit, tones.muted, align=(1, 0))
    for k, column in enumerate(columns):
        x, y = board.left + (MARGIN + k * (COLUMN + MARGIN)) * unit, board.top + HEAD * unit - scroll
        for name in column:
            y = _block(surface, name, blocks[name], (x, y), unit)
    surface.set_clip(None)
    if board.height < int(whole * unit):
        share = board.height / (whole * unit)
        bar = pygame.Rect(board.right - round(8 * unit), 0, round(4 * unit), round(share * board.height))
        bar.top = board.top + round(share * scroll)
        pygame.draw.rect(surface, tones.muted, bar, border_radius=round(2 * unit))
    return scroll


def _columns(heights: dict[str, float], count: int) -> list[dict[str, float]]:
    """Distribute the blocks over `count` columns of similar height, without changing their order."""
    columns: list[dict[str, float]] = [{}]
    for name, height in heights.items():
        if (
            columns[-1]
            and len(columns) < count
            and sum(columns[-1].values()) + 0.5 * height > sum(heights.values()) / count
        ):
            columns.append({})
        columns[-1][name] = height
    return columns


def _caps(binding: Binding) -> str:
    return "  ".join(str(key) for key in binding.keys)


def _block(
    surface: pygame.Surface, name: str, rows: list[tuple[str, str]], place: tuple[float, float], unit: float
) -> float:
    """Draw one group of key bindings. Return the vertical position for the next group."""
    x, y = place
    write(surface, _(name), (x, y), 16 * unit, tones.foreground, bold=True)
    surface.fill(tones.faint, (round(x), round(y + 21 * unit), round(COLUMN * unit), max(1, round(unit))))
    y += TITLE * unit
    for keys, text in rows:
        _cap(surface, keys, (x, y), unit)
        write(surface, text, (x + (KEYS_ROOM + 4) * unit, y + 1 * unit), 13 * unit, tones.foreground)
        y += LINE * unit
    return y + 10 * unit


def _cap(surface: pygame.Surface, keys: str, place: tuple[float, float], unit: float) -> None:
    """Draw the names of keys, each on a small plate."""
    x, y = place
    for text in keys.split("  "):
        wide = width(text, 13 * unit, bold=True) + 10 * unit
        if x + wide > place[0] + (KEYS_ROOM - 6.0) * unit and x > place[0]:
            return  # The line is full. The keys that are left out have the same action.
        plate = pygame.Rect(round(x), round(y), round(wide), round(18 * unit))
        pygame.draw.rect(surface, tones.lane_background, plate, border_radius=round(4 * unit))
        pygame.draw.rect(surface, tones.faint, plate, 1, border_radius=round(4 * unit))
        write(surface, text, plate.center, 13 * unit, tones.foreground, bold=True, align=(0.5, 0.5))
        x += wide + 4 * unit
