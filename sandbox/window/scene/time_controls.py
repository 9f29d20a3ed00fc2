"""The row of time controls: to the start, back, play, forward, restart; slow motion; which plots are shown."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import pygame
import pygame_gui
from pygame_gui.elements import UIButton
from softcradle.sandbox.draw.number_format import fixed, time_unit
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.languages import _, pgettext
from softcradle.sandbox.session.inputs import SetSlow
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.icons import draw_icon
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.plots.plot_board import PlotBoard
from softcradle.sandbox.window.slider import Slider
from softcradle.sandbox.window.window_page import Host

SLOWEST = 1000.0  # wall seconds for one second of the model
FASTEST = 0.01  # wall seconds for one second of the model
# by keys
SLOW_MOTIONS = FASTEST, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, SLOWEST
BUTTONS = ("first", "back", "play_pause", "forward", "last", "restart", "fit")
FEW = ("play_pause", "restart")  # buttons of the first level
LATE = 0.95  # clock ratio below which the page shows that the clock is slow
TOGGLE_MARGIN = 16.0  # design pixels of a toggle button beside its name

MOVING = ("playing", "replaying")  # activities that can be paused

Actions = Mapping[str, Callable[[], None]]


class TimeControls:
    """Buttons of time, the slider of slow motion, toggle buttons of the plots."""

    def __init__(self, host: Host, session: Session, board: PlotBoard, activity: Callable[[], str]) -> None:
        self.activity = activity
        self.host, self.session, self.board = host, session, board
        self.rect = pygame.Rect(0, 0, 1, 1)
        self.buttons: dict[str, UIButton] = {}
        self.toggles: dict[str, UIButton] = {}
        self.slider: Slider | None = None
        self._wanted: float | None = None  # slow motion that is applied when the scene plays on

    @property
    def slow(self) -> float:
        """The slow motion: the present one, or the one that is applied when the scene plays on."""
        return self.session.slow if self._wanted is None else self._wanted

    def build(self, rect: pygame.Rect, second: pygame.Rect, actions: Actions) -> None:
        """Make the widgets inside `rect`, those of plots at the right of `second`; they do the page's `actions`."""
        self.rect, unit, manager = rect, self.host.unit, self.host.manager
        few = {name: actions[name] for name in FEW}
        self.buttons = time_buttons(self.host, rect, few if self.host.explore else actions)
        self.slow_left = max(button.rect.right for button in self.buttons.values()) + round(19 * unit)
        place = pygame.Rect(self.slow_left, rect.centery + round(2 * unit), round(190 * unit), round(14 * unit))
        self.slider = Slider(place, self._share(), (0.0, 1.0), manager)
        self.slider.name = _("slow motion")
        self.clock_left = place.right + round(22 * unit)
        self._build_toggles(second, actions)

    def _build_toggles(self, rect: pygame.Rect, actions: Actions) -> None:
        """A toggle button for each plot, from the right end of `rect`."""
        unit, names = self.host.unit, [] if self.host.explore else self.board.available()
        x = rect.right - sum(toggle_width(name) + 4 for name in names) * unit
        self.toggles.clear()
        for name in names:
            wide = toggle_width(name)
            place = pygame.Rect(round(x), rect.centery - round(13 * unit), round(wide * unit), round(26 * unit))
            self.toggles[name] = UIButton(
                place,
                pgettext("button", name),
                self.host.manager,
                object_id="#chip",
                tool_tip_text=_("plot: {what}", what=hint(name)),
                command=actions[name],
            )
            if name in self.board.shown and not self.board.hidden:
                self.toggles[name].select()
            x += (wide + 4) * unit

    def _share(self) -> float:
        """Place of the slow motion on the slider."""
        return min(max(math.log(self.slow / FASTEST) / math.log(SLOWEST / FASTEST), 0.0), 1.0)

    def handle(self, event: pygame.Event) -> bool:
        """The slider."""
        if event.type == pygame_gui.UI_HORIZONTAL_SLIDER_MOVED and event.ui_element is self.slider:
            slow = FASTEST * (SLOWEST / FASTEST) ** event.value
            self.set_slow(float(f"{slow:.3g}"))
            return True
        return False

    def set_slow(self, slow: float) -> None:
        """Set the slow motion; 1 is real time. While scrubbed it is not yet applied: an edit would drop later frames."""
        self._wanted = min(max(slow, FASTEST), SLOWEST)
        if not self.session.scrubbed:
            self.apply_slow()
        if self.slider is not None:
            self.slider.set_current_value(self._share())

    def apply_slow(self) -> None:
        """Apply the slow motion that was set."""
        if self._wanted is not None:
            self.session.apply(SetSlow(self._wanted))
            self._wanted = None
            self.board.follow_slow_motion()

    def step_slow(self, direction: int) -> None:
        """The next of SLOW_MOTIONS: slower (1) or faster (-1)."""
        slow = self.slow
        if direction > 0:
            self.set_slow(next((s for s in SLOW_MOTIONS if s > slow * 1.001), SLOWEST))
        else:
            self.set_slow(next((s for s in reversed(SLOW_MOTIONS) if s < slow * 0.999), FASTEST))

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw the icons on the buttons, and the numbers beside them."""
        unit = self.host.unit
        paint_icons(surface, self.buttons, self.activity() in MOVING, unit)
        slow = self.slow
        text = speed_text(slow)
        write(surface, text, (self.slow_left, self.rect.centery - 17 * unit), 13 * unit, tones.foreground)
        self._clock(surface)

    def _clock(self, surface: pygame.Surface) -> None:
        unit, session = self.host.unit, self.session
        size, name = time_unit(self.board.span.seconds)
        decimals = max(0, 3 - math.floor(math.log10(self.board.span.seconds / size)))
        place = (self.clock_left, self.rect.centery - 17 * unit)
        write(
            surface, f"t = {fixed(session.time / size, decimals)} {name}", place, 16 * unit, tones.foreground, bold=True
        )
        ratio = session.pacer.clock_ratio
        below = (self.clock_left, self.rect.centery + 4 * unit)
        if session.playing and ratio < LATE:
            text = _("late: clock at {percent:.0f} %", percent=100 * ratio)
            write(surface, text, below, 12 * unit, tones.warning, bold=True)
        elif session.scrubbed:
            write(surface, _("looking back"), below, 12 * unit, tones.muted)
        else:
            write(surface, _(self.activity()), below, 12 * unit, tones.muted)


def time_buttons(host: Host, rect: pygame.Rect, actions: Actions) -> dict[str, UIButton]:
    """The buttons of time for which there are `actions`, side by side from the left end of `rect`."""
    unit, found = host.unit, {}
    side, x = round(34 * unit), rect.left
    for name in BUTTONS:
        if name not in actions:
            continue
        wide = side + (round(16 * unit) if name == "play_pause" else 0)
        place = pygame.Rect(x, rect.centery - side // 2, wide, side)
        style = "#primary" if name == "play_pause" else None
        found[name] = UIButton(
            place, "", host.manager, object_id=style, tool_tip_text=hint(name), command=actions[name]
        )
        x += wide + round(5 * unit)
    return found


def paint_icons(surface: pygame.Surface, buttons: Mapping[str, UIButton], moving: bool, unit: float) -> None:
    """Draw the icons on the buttons of time."""
    for name, button in buttons.items():
        icon = ("pause" if moving else "play") if name == "play_pause" else name
        colour = tones.on_accent if name == "play_pause" else tones.foreground
        draw_icon(surface, icon, button.rect.center, 14 * unit, colour)


def toggle_width(name: str) -> float:
    """Design pixels of the toggle button `name`."""
    return width(pgettext("button", name), 12.0) + TOGGLE_MARGIN


def speed_text(slow: float) -> str:
    """How fast the clock is, for `slow` wall seconds for one of the model."""
    if abs(slow - 1.0) < 0.005:
        return _("real time")
    if slow > 1.0:
        return _("slow motion 1/{times:.4g}", times=slow)
    return _("{times:.3g} times as fast", times=1.0 / slow)
