"""The row of time controls: to the start, back, play, forward, restart; slow motion; which plots are shown."""

from __future__ import annotations

import math
from collections.abc import Callable

import pygame
import pygame_gui
from pygame_gui.elements import UIButton, UIHorizontalSlider
from softcradle.sandbox.draw.number_format import fixed, time_unit
from softcradle.sandbox.draw.palette import BACKGROUND, FOREGROUND, MUTED, WARNING
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.session.inputs import SetSlow
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.icons import put_icon
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.plots.plot_board import Board
from softcradle.sandbox.window.plots.plot_kinds import CHIPS
from softcradle.sandbox.window.window_page import Host

SLOWEST = 1000.0
STEPS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, SLOWEST)
BUTTONS = ("first", "back", "play_pause", "forward", "last", "restart")
LATE = 0.95  # clock ratio below which the page says that the clock is slow
CHIP_WIDTHS = {
    "velocities": 74.0,
    "forces": 58.0,
    "overlaps": 70.0,
    "energy": 60.0,
    "strip": 84.0,
    "kymograph": 84.0,
    "difference": 82.0,
}


class Transport:
    """Time controls; what they do are the page's `actions`."""

    def __init__(self, host: Host, session: Session, board: Board, actions: dict[str, Callable[[], None]]) -> None:
        self.host, self.session, self.board, self.actions = host, session, board, actions
        self.rect = pygame.Rect(0, 0, 1, 1)
        self.buttons: dict[str, UIButton] = {}
        self.chips: dict[str, UIButton] = {}
        self.slider: UIHorizontalSlider | None = None
        self._wanted: float | None = None

    @property
    def slow(self) -> float:
        """The slow motion that holds, or will hold as soon as the scene plays on."""
        return self.session.slow if self._wanted is None else self._wanted

    def build(self, rect: pygame.Rect) -> None:
        """Make the widgets inside `rect`."""
        self.rect, unit, manager = rect, self.host.unit, self.host.manager
        side, x = round(34 * unit), rect.left
        for name in BUTTONS:
            wide = side + (round(16 * unit) if name == "play_pause" else 0)
            place = pygame.Rect(x, rect.centery - side // 2, wide, side)
            self.buttons[name] = UIButton(
                place, "", manager, object_id="#primary" if name == "play_pause" else None,
                tool_tip_text=hint(name), command=self.actions[name],
            )  # fmt: skip
            x += wide + round(5 * unit)
        self.slow_at = x + round(14 * unit)
        place = pygame.Rect(self.slow_at, rect.centery + round(2 * unit), round(190 * unit), round(14 * unit))
        self.slider = UIHorizontalSlider(place, self._share(), (0.0, 1.0), manager)
        self.clock_at = place.right + round(22 * unit)
        self._build_chips(rect.right)

    def _build_chips(self, right: int) -> None:
        unit, manager = self.host.unit, self.host.manager
        kinds = [kind for kind in CHIPS if kind != "difference" or self.board.lanes == 2]
        x = right - sum(CHIP_WIDTHS[kind] + 4 for kind in kinds) * unit
        self.chips.clear()
        for kind in kinds:
            place = pygame.Rect(
                round(x), self.rect.centery - round(13 * unit), round(CHIP_WIDTHS[kind] * unit), round(26 * unit)
            )
            chip = UIButton(
                place,
                CHIPS[kind],
                manager,
                object_id="#chip",
                tool_tip_text="plot: " + hint(kind),
                command=self.actions[kind],
            )
            if kind in self.board.shown and not self.board.hidden:
                chip.select()
            self.chips[kind] = chip
            x += (CHIP_WIDTHS[kind] + 4) * unit

    def _share(self) -> float:
        return min(max(math.log(self.slow) / math.log(SLOWEST), 0.0), 1.0)

    def handle(self, event: pygame.Event) -> bool:
        """The slider."""
        if event.type == pygame_gui.UI_HORIZONTAL_SLIDER_MOVED and event.ui_element is self.slider:
            slow = SLOWEST**event.value
            self.set_slow(float(f"{slow:.3g}"))
            return True
        return False

    def set_slow(self, slow: float) -> None:
        """Choose the slow motion; 1 is real time. An edit would drop what is later than a moment that is looked at."""
        self._wanted = min(max(slow, 1.0), SLOWEST)
        if not self.session.scrubbed:
            self.settle()
        if self.slider is not None:
            self.slider.set_current_value(self._share())

    def settle(self) -> None:
        """Let the wanted slow motion hold."""
        if self._wanted is not None:
            self.session.apply(SetSlow(self._wanted))
            self._wanted = None
            self.board.respan()

    def step_slow(self, direction: int) -> None:
        """The next of 1, 2, 5, 10 ...: slower (1) or faster (-1)."""
        slow = self.slow
        if direction > 0:
            self.set_slow(next((s for s in STEPS if s > slow * 1.001), SLOWEST))
        else:
            self.set_slow(next((s for s in reversed(STEPS) if s < slow * 0.999), 1.0))

    def paint_over(self, surface: pygame.Surface) -> None:
        """Icons on the buttons, and the numbers beside them."""
        unit = self.host.unit
        for name, button in self.buttons.items():
            shape = ("pause" if self.session.playing else "play") if name == "play_pause" else name
            put_icon(surface, shape, button.rect.center, 14 * unit, BACKGROUND if name == "play_pause" else FOREGROUND)
        slow = self.slow
        text = "real time" if slow <= 1.0 else f"slow motion 1/{slow:.4g}"
        write(surface, text, (self.slow_at, self.rect.centery - 17 * unit), 13 * unit, FOREGROUND)
        self._clock(surface)

    def _clock(self, surface: pygame.Surface) -> None:
        unit, session = self.host.unit, self.session
        size, name = time_unit(self.board.span.seconds)
        decimals = max(0, 3 - math.floor(math.log10(self.board.span.seconds / size)))
        place = (self.clock_at, self.rect.centery - 17 * unit)
        write(surface, f"t = {fixed(session.time / size, decimals)} {name}", place, 16 * unit, FOREGROUND, bold=True)
        ratio = session.pace.clock_ratio
        below = (self.clock_at, self.rect.centery + 4 * unit)
        if session.playing and ratio < LATE:
            write(surface, f"late: clock at {100 * ratio:.0f} %", below, 12 * unit, WARNING, bold=True)
        elif session.scrubbed:
            write(surface, "looking back", below, 12 * unit, MUTED)
        else:
            write(surface, "playing" if session.playing else "paused", below, 12 * unit, MUTED)
