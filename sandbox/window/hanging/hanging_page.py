"""The page of the hanging cradle: soft contacts beside pymunk's rigid ones, with the controls and badges of a scene."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.languages import N_, _, pgettext
from softcradle.sandbox.window.hanging.energy_plot import paint_energies
from softcradle.sandbox.window.hanging.hanging_badges import NAMES, badge_places, paint_badge
from softcradle.sandbox.window.hanging.hanging_controls import HangingControls, HangingScrubBar
from softcradle.sandbox.window.hanging.hanging_cradle import RADIUS
from softcradle.sandbox.window.hanging.hanging_model import HangingModel
from softcradle.sandbox.window.hanging.hanging_picture import paint_cradle, pixels_a_metre, to_model, to_screen
from softcradle.sandbox.window.hanging.hanging_text import HANGING_TEXT, HANGING_TITLE
from softcradle.sandbox.window.page_geometry import MARGIN, geometry
from softcradle.sandbox.window.scene.file_names import shown_path
from softcradle.sandbox.window.scene.save_dialogs import SaveDialogs, Saving, report
from softcradle.sandbox.window.scene.toolbar import TITLE_LEFT, Toolbar
from softcradle.sandbox.window.scene.window_film import WindowFilm
from softcradle.sandbox.window.window_page import Host

HEAD = 29.0  # design pixels of the name above a cradle
PICTURES = 0.58  # of the height between toolbar and footer


class HangingPage:
    """Both cradles side by side above a plot of their energies. `leave` goes back to the gallery."""

    typing = unsaved = False
    title = HANGING_TITLE

    def __init__(self, host: Host, leave: Callable[[], None]) -> None:
        self.host, self.leave = host, leave
        self.playing = False
        self.held: tuple[int, int] | None = None  # cradle and ball
        self.pointer = (0, 0)
        self.film = WindowFilm(host)
        self.toolbar = Toolbar(host, self.film)
        note = N_("a .csv table: the centres of all balls and the energies, a row a frame")
        saving = Saving(N_("Export the history"), note, ".csv", (".csv",), self._export)
        self.dialogs = SaveDialogs(host, HANGING_TITLE, self.film, {"export": saving})
        self.actions: dict[str, Callable[[], None]] = {
            "play_pause": self.play_pause,
            "restart": self.restart,
            "first": lambda: self.model.scrub(0),
            "last": lambda: self.model.scrub(len(self.model.frames) - 1),
            "back": partial(self.step, -1),
            "forward": partial(self.step, 1),
            "slower": lambda: self.controls.step_slow(1),
            "faster": lambda: self.controls.step_slow(-1),
            **self.dialogs.actions,
            "level": host.toggle_level,
            "help": host.toggle_help,
            "leave": leave,
        }
        self.controls = HangingControls(host, self.actions)
        self.take(HangingModel())

    def take(self, model: HangingModel) -> None:
        """Show another model."""
        self.model = model
        self.bar = HangingScrubBar(model)

    @property
    def slow(self) -> float:
        """Wall seconds for one of the model."""
        return self.controls.slow

    @property
    def moving(self) -> bool:
        """Whether it plays, holds a ball or is filmed."""
        return self.playing or self.held is not None or self.film.film is not None

    def play_pause(self) -> None:
        """Play or pause."""
        self.playing = not self.playing

    def restart(self) -> None:
        """Lift the balls again."""
        self.model.restart()

    def step(self, by: int) -> None:
        """Pause, and show the next frame (1) or the one before (-1)."""
        self.playing = False
        self.model.step(by)

    def _export(self, path: Path) -> None:
        report(self.host.messages, partial(self.model.write_csv, path), _("saved {path}", path=shown_path(path)))

    def call_unsaved(self) -> None:
        """Nothing here is saved."""

    def cancel_typing(self) -> None:
        """Nothing is typed here."""

    def build(self) -> None:
        """Make the widgets, in the places of a scene's page."""
        unit, places = self.host.unit, geometry(self.host.size, self.host.unit, 1, (), True)
        self.toolbar.build(places.toolbar, self.actions, self.leave)
        self.bar.place(places.footer, unit)
        margin, gap = round(12 * unit), round(MARGIN * unit)
        below = pygame.Rect(places.footer.left + margin, places.footer.top + round(42 * unit), 10, round(46 * unit))
        panel = places.panel.inflate(-2 * margin, -2 * round(9 * unit))
        y = self.controls.build(below, panel, self.model)
        main = pygame.Rect(gap, places.toolbar.bottom + gap // 2, places.panel.left - 2 * gap, 1)
        main.height = places.footer.top - main.top - gap // 2
        half, high = (main.width - gap) // 2, round(PICTURES * main.height)
        self.lanes = [pygame.Rect(main.left + k * (half + gap), main.top, half, high) for k in range(2)]
        head = round(HEAD * unit)
        self.pictures = [pygame.Rect(lane.left, lane.top + head, half, high - head) for lane in self.lanes]
        self.plot = pygame.Rect(main.left, main.top + high + round(6 * unit), main.width, main.height - high)
        self.plot.height -= round(6 * unit)
        self.badges = badge_places(pygame.Rect(panel.left, y, panel.width, panel.bottom - y), unit)
        top = self.badges[1].bottom + round(10 * unit)
        self.text = pygame.Rect(panel.left, top, panel.width, max(0, panel.bottom - top))
        self.places = places

    def follow(self) -> None:
        """What is drawn is read when an event comes."""

    def handle(self, event: pygame.Event) -> bool:
        """Menus and bar, and dragging of balls."""
        chosen = self.controls.handle(event, self.model)
        if chosen is not None:
            self.take(chosen)
            self.bar.place(self.places.footer, self.host.unit)
            return True
        if self.bar.handle(event):
            self.playing = False
            return True
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self.held, self.pointer = self._ball_at(event.pos), event.pos
            return self.held is not None
        if event.type == pygame.MOUSEMOTION and self.held is not None:
            self.pointer, self.playing = event.pos, True
            return True
        if event.type == pygame.MOUSEBUTTONUP and self.held is not None:
            self.held = None
            self.model.release()
            return True
        return False

    def take_file(self, path: str, point: tuple[int, int]) -> bool:
        """Files are opened."""
        return False

    def _ball_at(self, point: tuple[int, int]) -> tuple[int, int] | None:
        """Cradle and ball at `point`."""
        for k, (rect, centres) in enumerate(zip(self.pictures, self.model.moment.places, strict=True)):
            for ball, place in enumerate(centres):
                if math.dist(point, to_screen(rect, place)) <= RADIUS * pixels_a_metre(rect) + 3:
                    return k, ball
        return None

    def update(self, seconds: float) -> None:
        """Let time pass."""
        if self.held is not None and self.playing:
            self.model.hold(*self.held, to_model(self.pictures[self.held[0]], self.pointer))
        if self.playing:
            self.model.advance(seconds / self.slow)
        self.bar.make_room()
        self.toolbar.update()

    def paint(self, surface: pygame.Surface) -> None:
        """Draw all but the widgets."""
        unit, places = self.host.unit, self.places
        surface.fill(tones.background)
        title = shortened(_(HANGING_TITLE), 19 * unit, self.toolbar.title_room, bold=True)
        place = (TITLE_LEFT * unit, places.toolbar.centery)
        write(surface, title, place, 19 * unit, tones.foreground, bold=True, align=(0, 0.5))
        for y in (places.toolbar.bottom - 1, places.footer.top):
            surface.fill(tones.faint, (0, y, self.host.size[0], 1))
        surface.fill(tones.faint, (places.panel.left, places.panel.top, 1, places.panel.height))
        for side, (rect, centres) in enumerate(zip(self.pictures, self.model.moment.places, strict=True)):
            lane = self.lanes[side]
            surface.fill(tones.lane_background, lane)
            name = (
                _("{name}: {law}", name=_(NAMES[side]), law=pgettext("button", self.model.law))
                if side == 0
                else _(NAMES[side])
            )
            name = shortened(name, 15 * unit, rect.width - 20 * unit, bold=True)
            write(surface, name, (lane.left + 10 * unit, lane.top + 7 * unit), 15 * unit, tones.foreground, bold=True)
            paint_cradle(surface, rect, centres)
            paint_badge(surface, self.badges[side], unit, side, self.model)
        paint_energies(surface, self.plot, unit, self.model)
        self.bar.paint(surface)
        self.controls.paint(surface)
        self._paint_text(surface)

    def _paint_text(self, surface: pygame.Surface) -> None:
        """As many lines of the text as there is room for."""
        unit, line = self.host.unit, 18 * self.host.unit
        lines = wrapped(_(HANGING_TEXT), 13 * unit, self.text.width)
        room = max(0, int(self.text.height // line))
        for row, text in enumerate(lines[:room]):
            shown = shortened(f"{text} …", 13 * unit, self.text.width) if row == room - 1 < len(lines) - 1 else text
            write(surface, shown, (self.text.left, self.text.top + row * line), 13 * unit, tones.foreground)

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw icons, clock, and a ring at the pointer while it holds a ball."""
        self.controls.paint_over(surface, self.model, "playing" if self.playing else "paused")
        self.bar.paint_reading(surface, pygame.mouse.get_pos())
        if self.held is not None:
            pygame.draw.aacircle(surface, tones.foreground, self.pointer, 5 * self.host.unit, 2)

    def after_frame(self, surface: pygame.Surface, seconds: float) -> None:
        """Record the finished picture, if a film is being made."""
        self.film.record(surface, seconds)

    def close(self) -> None:
        """Close the film."""
        self.film.end()
