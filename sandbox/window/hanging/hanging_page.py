"""The page of the hanging cradle: soft contacts beside pymunk's rigid ones, and a plot of their energies."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import pygame
import pygame_gui
from pygame_gui.elements import UIButton, UIDropDownMenu
from softcradle.sandbox.draw.curve_panels import linear_axis
from softcradle.sandbox.draw.number_format import MINUS, fixed
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, FOREGROUND, LANE_BACKGROUND, MUTED, OKABE_ITO
from softcradle.sandbox.draw.text import wrapped, write
from softcradle.sandbox.window.hanging.hanging_cradle import BALLS, LAWS, RADIUS, HangingModel
from softcradle.sandbox.window.hanging.hanging_picture import paint_cradle, pixels_a_metre, to_model, to_screen
from softcradle.sandbox.window.icons import draw_icon
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.window_page import Host

HANGING_NAME = "hanging-cradle"
HANGING_TITLE = "A hanging cradle in pymunk"
HANGING_TEXT = (
    "Balls on strings in an ordinary pymunk Space, once with soft contacts between them and once with pymunk's own "
    "rigid collisions. Strings, gravity and steps are the same. With a small exponent the balls that are hit swing off "
    "nearly as one body; steel balls pass the blow on to the last; rigid ones share it in the order in which they "
    "are solved. Drag a ball and release it."
)
SLOW_MOTIONS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
SPAN = 12.0  # seconds of the plot
NAMES = ("soft contacts", "pymunk's rigid collisions")
CURVES = (OKABE_ITO[0], OKABE_ITO[3])


class HangingPage:
    """Both cradles side by side above a plot of their energies. `leave` goes back to the gallery."""

    typing = False

    def __init__(self, host: Host, leave: Callable[[], None]) -> None:
        self.host, self.leave = host, leave
        self.model = HangingModel()
        self.playing, self.slow = False, 1.0
        self.held: tuple[int, int] | None = None  # cradle and ball
        self.pointer = (0, 0)
        self.actions: dict[str, Callable[[], None]] = {
            "play_pause": self.play_pause,
            "restart": self.restart,
            "slower": partial(self.step_slow, 1),
            "faster": partial(self.step_slow, -1),
            "leave": leave,
        }

    def play_pause(self) -> None:
        """Play or pause."""
        self.playing = not self.playing

    def restart(self) -> None:
        """Lift the balls again."""
        self.model.restart()

    def step_slow(self, direction: int) -> None:
        """The next of SLOW_MOTIONS: slower (1) or faster (-1)."""
        place = SLOW_MOTIONS.index(self.slow) + direction
        self.slow = SLOW_MOTIONS[min(max(place, 0), len(SLOW_MOTIONS) - 1)]

    def build(self) -> None:
        """Make the widgets."""
        unit, manager, (width, height) = self.host.unit, self.host.manager, self.host.size
        margin, bar = round(14 * unit), round(48 * unit)
        place = pygame.Rect(round(12 * unit), round(9 * unit), round(84 * unit), round(30 * unit))
        UIButton(place, "← Scenes", manager, tool_tip_text="back to the gallery", command=self.leave)
        half = (width - 3 * margin) // 2
        high = round(0.52 * height)
        self.pictures = [pygame.Rect(margin + k * (half + margin), bar + margin, half, high) for k in range(2)]
        y = self.pictures[0].bottom
        self.plot = pygame.Rect(margin + round(44 * unit), y + round(34 * unit), round(0.56 * width), 10)
        self.plot.height = height - self.plot.top - round(92 * unit)
        self.text = pygame.Rect(self.plot.right + round(50 * unit), y + round(14 * unit), 10, 10)
        self.text.width = width - margin - self.text.left
        self._build_controls(height - round(50 * unit))

    def _build_controls(self, y: int) -> None:
        unit, manager, x = self.host.unit, self.host.manager, round(14 * self.host.unit)
        side = round(34 * unit)
        self.buttons = {}
        for name, wide in (("play_pause", 50), ("restart", 34)):
            place = pygame.Rect(x, y, round(wide * unit), side)
            style = "#primary" if name == "play_pause" else None
            self.buttons[name] = UIButton(
                place, "", manager, object_id=style, tool_tip_text=hint(name), command=self.actions[name]
            )
            x = place.right + round(6 * unit)
        self.clock_place = x + round(14 * unit), y
        x += round(330 * unit)
        self.labels = [("contacts", x - round(8 * unit), y + side // 2)]
        place = pygame.Rect(x, y, round(190 * unit), side)
        self.laws = UIDropDownMenu(list(LAWS), self.model.law, place, manager)
        x = place.right + round(90 * unit)
        self.labels.append(("balls lifted", x - round(8 * unit), y + side // 2))
        place = pygame.Rect(x, y, round(64 * unit), side)
        self.counts = UIDropDownMenu([str(k) for k in range(1, BALLS)], str(self.model.lifted), place, manager)

    def handle(self, event: pygame.Event) -> bool:
        """Menus, and dragging of balls."""
        if event.type == pygame_gui.UI_DROP_DOWN_MENU_CHANGED:
            return self._choose(event)
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self.held, self.pointer = self._ball_at(event.pos), event.pos
            return self.held is not None
        if event.type == pygame.MOUSEMOTION and self.held is not None:
            self.pointer = event.pos
            self.playing = True
            return True
        if event.type == pygame.MOUSEBUTTONUP and self.held is not None:
            self.held = None
            self.model.release()
            return True
        return False

    def _choose(self, event: pygame.Event) -> bool:
        law = event.text if event.ui_element is self.laws else self.model.law
        lifted = int(event.text) if event.ui_element is self.counts else self.model.lifted
        self.model = HangingModel(law, lifted)
        return True

    def _ball_at(self, point: tuple[int, int]) -> tuple[int, int] | None:
        """Cradle and ball at `point`."""
        for k, (rect, cradle) in enumerate(zip(self.pictures, self.model.cradles, strict=True)):
            for ball, place in enumerate(cradle.places()):
                if math.dist(point, to_screen(rect, place)) <= RADIUS * pixels_a_metre(rect) + 3:
                    return k, ball
        return None

    def update(self, seconds: float) -> None:
        """Let time pass."""
        if self.held is not None and self.playing:
            self.model.hold(*self.held, to_model(self.pictures[self.held[0]], self.pointer))
        if self.playing:
            self.model.advance(seconds / self.slow)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw all but the widgets."""
        unit = self.host.unit
        surface.fill(BACKGROUND)
        write(surface, HANGING_TITLE, (110 * unit, 24 * unit), 19 * unit, FOREGROUND, bold=True, align=(0, 0.5))
        surface.fill(FAINT, (0, round(48 * unit) - 1, self.host.size[0], 1))
        for rect, cradle, name in zip(self.pictures, self.model.cradles, NAMES, strict=True):
            surface.fill(LANE_BACKGROUND, rect)
            title = f"{name}: {self.model.law}" if cradle.chain is not None else name
            write(surface, title, (rect.left + 12 * unit, rect.top + 8 * unit), 15 * unit, FOREGROUND, bold=True)
            paint_cradle(surface, rect, cradle.places())
        self._plot_energies(surface)
        y = float(self.text.top)
        for line in wrapped(HANGING_TEXT, 13.5 * unit, self.text.width):
            write(surface, line, (self.text.left, y), 13.5 * unit, FOREGROUND)
            y += 19 * unit
        for label, x, middle in self.labels:
            write(surface, label, (x, middle), 13 * unit, MUTED, align=(1, 0.5))

    def _plot_energies(self, surface: pygame.Surface) -> None:
        """Plot both energies as shares of their first values."""
        unit, area, samples = self.host.unit, self.plot, list(self.model.energies)
        title = "energy, as a share of that at the start"
        write(surface, title, (area.left, area.top - 6 * unit), 13 * unit, align=(0, 1))
        first = samples[0]
        shares = [[sample[k] / first[k] if first[k] > 1e-9 else 1.0 for sample in samples] for k in (1, 2)]
        low, high = min(0.9, *map(min, shares)), max(1.04, *map(max, shares))

        def y(share: float) -> float:
            return area.bottom - (share - low) / (high - low) * area.height

        for value, text in linear_axis("", low, high).ticks:
            surface.fill(FAINT, (area.left, round(y(value)), area.width, 1))
            write(surface, text, (area.left - 6 * unit, y(value)), 11.5 * unit, MUTED, align=(1, 0.5))
        begin = max(first[0], samples[-1][0] - SPAN)
        for k, colour in enumerate(CURVES):
            points = [
                (area.left + (t - begin) / SPAN * area.width, y(share))
                for (t, _, _), share in zip(samples, shares[k], strict=True)
                if t >= begin
            ]
            if len(points) > 1:
                pygame.draw.aalines(surface, colour, False, points)
                pygame.draw.aalines(surface, colour, False, [(x, y + 1) for x, y in points])
            text = f"{NAMES[k]}: {100 * (shares[k][-1] - 1):+.1f} %".replace("-", MINUS)
            place = (area.left + k * 0.45 * area.width, area.bottom + 6 * unit)
            write(surface, text, place, 13 * unit, colour, bold=True)

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw icons, clock, and a ring at the pointer while it holds a ball."""
        unit = self.host.unit
        for name, button in self.buttons.items():
            icon = ("pause" if self.playing else "play") if name == "play_pause" else name
            colour = BACKGROUND if name == "play_pause" else FOREGROUND
            draw_icon(surface, icon, button.rect.center, 14 * unit, colour)
        x, y = self.clock_place
        write(surface, f"t = {fixed(self.model.time, 2)} s", (x, y - 2 * unit), 16 * unit, FOREGROUND, bold=True)
        speed = "real time" if self.slow == 1.0 else f"slow motion 1/{self.slow:.0f}"
        write(surface, speed, (x, y + 19 * unit), 12 * unit, MUTED)
        if self.held is not None:
            pygame.draw.aacircle(surface, FOREGROUND, self.pointer, 5 * unit, 2)

    def after_frame(self, surface: pygame.Surface, seconds: float) -> None:
        """Only scenes are filmed."""

    def close(self) -> None:
        """Nothing is open."""
