"""The page of the hanging cradle: one cradle with soft contacts, one with pymunk's rigid contacts, and an energy check
of each.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

import pygame
import pygame_gui
from pygame_gui.elements import UIDropDownMenu
from softcradle.sandbox.draw.bead_sprites import bead_sprite, number_sprite
from softcradle.sandbox.draw.palette import bead_colours, text_on, tones
from softcradle.sandbox.draw.supersampling import blit_sprite
from softcradle.sandbox.draw.text import shortened, write
from softcradle.sandbox.languages import N_, _, pgettext
from softcradle.sandbox.session.frame_pacing import FramePacer
from softcradle.sandbox.story.numbers import fixed
from softcradle.sandbox.story.verdict import GOOD
from softcradle.sandbox.window.hanging.cradle import (
    BALLS,
    FRAME,
    LAWS,
    RADIUS,
    RATES,
    HangingModel,
    Vector,
    anchors,
    start_places,
)
from softcradle.sandbox.window.page import Actions, Host, Page
from softcradle.sandbox.window.page_geometry import MARGIN, geometry
from softcradle.sandbox.window.scene.save_dialogs import SaveDialogs, WindowFilm
from softcradle.sandbox.window.scene.time_controls import TimeControls, late_note
from softcradle.sandbox.window.scene.toolbar import Toolbar
from softcradle.sandbox.window.widgets import fits, write_wrapped

HANGING_NAME = "hanging-cradle"
HANGING_TITLE = N_("Newton's cradle, hanging, in pymunk")
HANGING_SOURCE = N_("SoftChain, PinJoint strings, gravity")
HANGING_TEXT = N_(
    "Balls on strings in an ordinary pymunk Space, once with soft contacts between them and once with pymunk's own "
    "rigid collisions. Strings, gravity and steps are the same. With a small exponent the balls that are hit swing off "
    "nearly as one body; steel balls pass the blow on to the last; rigid ones share it in the order in which they "
    "are solved. Drag a ball and release it."
)
NAMES = (N_("soft contacts"), N_("pymunk's rigid collisions"))
WIDTH, HEIGHT = 2.3, 1.3  # Width and height of the picture in metres.
MOST_STEPS = 100  # Largest number of steps that can be undone.
HEAD, FOOT = 29.0, 58.0  # Height in design pixels of the name above a cradle and of the energy check below it.
MENU_ROW = 34.0  # Height of a menu in the panel in design pixels.
MENU = 166.0  # Width of a menu in design pixels.
# For each menu: the attribute of the model, the name, and the choices.
MENUS: tuple[tuple[str, str, Sequence[str]], ...] = (
    ("law", N_("contacts"), tuple(LAWS)),
    ("lifted", N_("balls lifted"), tuple(str(k) for k in range(1, BALLS))),
    ("rate", N_("steps a second"), tuple(map(str, RATES))),
)


class HangingPage(Page):
    """The page with both cradles side by side. `leave` returns to the gallery."""

    title = HANGING_TITLE

    def __init__(self, host: Host, leave: Callable[[], None]) -> None:
        self.host, self.leave, self.model = host, leave, HangingModel()
        self.playing, self.pacer = False, FramePacer(clock=host.clock)
        self.time_controls = TimeControls(host, lambda: N_("playing") if self.playing else N_("paused"))
        self.done: list[HangingModel] = []  # Earlier states for undo, the newest last.
        self.held: tuple[int, int] | None = None  # Indices of the cradle and the ball that the pointer holds.
        self.pointer = (0, 0)
        self.film = WindowFilm(host)
        self.toolbar = Toolbar(host, self.film)
        self.dialogs = SaveDialogs(host, self.film, {})
        self.menus: dict[str, UIDropDownMenu] = {}
        self.actions: Actions = {
            "play_pause": self.play_pause,
            "restart": self.restart,
            "undo": self.undo,
            "forward": self.step,
            "slower": partial(self.time_controls.step_slow, 1),
            "faster": partial(self.time_controls.step_slow, -1),
            **self.dialogs.actions,
            **self.toolbar.actions,
            "level": host.toggle_level,
            "help": host.toggle_help,
            "leave": leave,
        }

    @property
    def moving(self) -> bool:  # type: ignore[override]
        """True while the page plays, holds a ball or records a film."""
        return self.playing or self.held is not None or self.film.recording

    def _remember(self) -> None:
        """Store the present state for undo."""
        self.done = [*self.done, self.model.copy()][-MOST_STEPS:]

    def restart(self) -> None:
        """Restart the motion, if it has started."""
        if self.model.time:
            self._remember()
            self.model.restart()

    def undo(self) -> None:
        """Return to the state before the last throw, choice or restart."""
        if not self.done:
            self.host.messages.hint(_("nothing to undo"))
            return
        self.held, self.playing = None, False
        self.model = self.done.pop()

    def play_pause(self) -> None:
        """Play or pause."""
        self.playing = not self.playing
        self.pacer.restart()

    def step(self) -> None:
        """Pause and advance by one frame."""
        self.playing = False
        self.model.advance()

    def message_place(self, size: tuple[int, int], unit: float) -> pygame.Rect:
        """Return the rectangle for messages: next to the clock, or on the timeline."""
        return self.time_controls.beside(self.places.footer)

    def made_of(self) -> object:
        """Return the values shown by the menus and if a film is recorded. The menus do not update by themselves."""
        return [getattr(self.model, field) for field, _name, _choices in MENUS], self.film.recording

    def build(self) -> None:
        """Create the widgets, with the same layout as the page of a scene."""
        host, unit = self.host, self.host.unit
        self.places = places = geometry(host.size, unit, 1, (), True)
        self.toolbar.build(places.toolbar, self.actions, self.leave)
        self.time_controls.build(places.footer.inflate(-2 * round(12 * unit), 0), self.actions)
        panel = places.panel.inflate(-2 * round(12 * unit), -2 * round(9 * unit))
        self.labels, y = list[tuple[str, int, int]](), panel.top
        for field, name, choices in MENUS:
            place = pygame.Rect(panel.right - round(MENU * unit), y, round(MENU * unit), round(27 * unit))
            shown = {pgettext("button", choice): choice for choice in choices}
            present = pgettext("button", str(getattr(self.model, field)))
            self.menus[field] = UIDropDownMenu([*shown], present, place, host.manager)
            self.labels.append((_(name), panel.left, place.centery))
            y += round(MENU_ROW * unit)
        top = y + round(16 * unit)
        self.text = pygame.Rect(panel.left, top, panel.width, max(0, panel.bottom - top))
        gap = round(MARGIN * unit)
        half = (places.panel.left - 3 * gap) // 2
        high = places.footer.top - places.toolbar.bottom - gap
        self.lanes = [
            pygame.Rect(gap + k * (half + gap), places.toolbar.bottom + gap // 2, half, high) for k in range(2)
        ]
        room, high = high - round((HEAD + FOOT) * unit), round(half * HEIGHT / WIDTH)
        top = places.toolbar.bottom + gap // 2 + round(HEAD * unit) + max(0, room - high) // 2
        self.pictures = [pygame.Rect(lane.left, top, half, min(room, high)) for lane in self.lanes]

    def handle(self, event: pygame.Event) -> bool:
        """Handle the slider, the menus, and balls that are dragged."""
        if self.time_controls.handle(event):
            return True
        if event.type == pygame_gui.UI_DROP_DOWN_MENU_CHANGED:
            return self._choose(event)
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self.held, self.pointer = self._ball_at(event.pos), event.pos
            return self.held is not None
        if event.type == pygame.MOUSEMOTION and self.held is not None:
            self.pointer, self.playing = event.pos, True
            return True
        return False

    def let_go(self) -> None:
        """Release the ball that is held."""
        if self.held is not None:
            self.held = None
            self.model.release()

    def _choose(self, event: pygame.Event) -> bool:
        """Restart with the value chosen in a menu."""
        for field, _name, choices in MENUS:
            if event.ui_element is self.menus[field]:
                chosen = next(choice for choice in choices if pgettext("button", choice) == event.text)
                self._remember()
                setattr(self.model, field, type(getattr(self.model, field))(chosen))
                self.model.restart()
                return True
        return False

    def _ball_at(self, point: tuple[int, int]) -> tuple[int, int] | None:
        """Return the indices of the cradle and the ball at `point`, or None."""
        for k, (rect, cradle) in enumerate(zip(self.pictures, self.model.cradles, strict=True)):
            for ball, place in enumerate(cradle.places()):
                if math.dist(point, to_screen(rect, place)) <= RADIUS * pixels_a_metre(rect) + 3:
                    return k, ball
        return None

    def update(self, seconds: float) -> None:
        """Advance by `seconds` of wall time."""
        if self.held is not None and self.playing:
            if not self.model.pulled:
                self._remember()
            self.model.hold(*self.held, to_model(self.pictures[self.held[0]], self.pointer))
        if self.playing:
            self.pacer.run(seconds, self.model.advance, 1.0 / (FRAME * self.time_controls.slow))
        self.toolbar.update()

    def paint(self, surface: pygame.Surface) -> None:
        """Draw everything below the widgets."""
        unit, places = self.host.unit, self.places
        surface.fill(tones.background)
        self.toolbar.paint_title(surface, _(HANGING_TITLE))
        for y in (places.toolbar.bottom - 1, places.footer.top):
            surface.fill(tones.faint, (0, y, self.host.size[0], 1))
        surface.fill(tones.faint, (places.panel.left, places.panel.top, 1, places.panel.height))
        for side in range(2):
            self._paint_side(surface, side)
        for name, x, y in self.labels:
            write(surface, name, (x, y), 13 * unit, tones.foreground, align=(0, 0.5))
        write_wrapped(surface, _(HANGING_TEXT), self.text, 13 * unit, tones.foreground)

    def _paint_side(self, surface: pygame.Surface, side: int) -> None:
        """Draw a cradle with its name and its energy check."""
        unit, lane, cradle = self.host.unit, self.lanes[side], self.model.cradles[side]
        surface.fill(tones.lane_background, lane)
        name = _(NAMES[side])
        if side == 0:
            name = _("{name}: {law}", name=name, law=pgettext("button", self.model.law))
        name = shortened(name, 16 * unit, lane.width - 20 * unit, bold=True)
        write(surface, name, (lane.left + 10 * unit, lane.top + 7 * unit), 16 * unit, tones.foreground, bold=True)
        paint_cradle(surface, self.pictures[side], cradle.places())
        found = cradle.verdict()
        tint, top = getattr(tones, found.level), lane.bottom - FOOT * unit
        mark = "✓" if found.level == GOOD else "!"
        write(surface, mark, (lane.left + 10 * unit, top), 16 * unit, tint, bold=True)
        place = pygame.Rect(lane.left + round(30 * unit), round(top), lane.width - round(44 * unit), round(56 * unit))
        size = 16 if fits(found.sentence, place, 16 * unit) else 13
        write_wrapped(surface, found.sentence, place, size * unit, tint)

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw the clock, and a ring at the pointer while it holds a ball."""
        clock = f"t = {fixed(self.model.time, 2)} s"
        late, warned = late_note(self.pacer) if self.playing else ("", False)
        self.time_controls.paint_clock(surface, clock, late or _(self.time_controls.activity()), warned)
        if self.held is not None:
            pygame.draw.aacircle(surface, tones.foreground, self.pointer, 5 * self.host.unit, 2)

    def after_frame(self, surface: pygame.Surface, seconds: float) -> None:
        """Record the finished picture, if a film is being made."""
        self.film.record(surface, seconds)

    def close(self) -> None:
        """Finish the film."""
        self.film.end()


def pixels_a_metre(rect: pygame.Rect) -> float:
    """Return the scale of the picture in pixels per metre."""
    return min(rect.width / WIDTH, rect.height / HEIGHT)


def _origin(rect: pygame.Rect) -> tuple[float, float]:
    """Return the pixel of the first string's anchor."""
    return rect.centerx - (BALLS - 1) * RADIUS * pixels_a_metre(rect), rect.top + 0.06 * rect.height


def to_screen(rect: pygame.Rect, place: tuple[float, float]) -> tuple[float, float]:
    """Return the pixel of a position [m]."""
    x, y = _origin(rect)
    return x + place[0] * pixels_a_metre(rect), y - place[1] * pixels_a_metre(rect)


def to_model(rect: pygame.Rect, point: tuple[int, int]) -> tuple[float, float]:
    """Return the position [m] of a pixel."""
    x, y = _origin(rect)
    return (point[0] - x) / pixels_a_metre(rect), (y - point[1]) / pixels_a_metre(rect)


def paint_cradle(surface: pygame.Surface, rect: pygame.Rect, places: Sequence[Vector]) -> None:
    """Draw the beam, the strings and the balls."""
    ends = [to_screen(rect, (x, 0.0)) for x in anchors()]
    size = 2.0 * RADIUS * pixels_a_metre(rect)
    beam = pygame.Rect(0, 0, round(ends[-1][0] - ends[0][0] + 2 * size), max(4, round(0.1 * size)))
    beam.midbottom = (round((ends[0][0] + ends[-1][0]) / 2), round(ends[0][1]))
    surface.fill(tones.muted, beam)
    for k, (end, place, colour) in enumerate(zip(ends, places, bead_colours(BALLS), strict=True)):
        centre = to_screen(rect, place)
        share = 1.0 - 0.5 * size / max(math.dist(end, centre), size)  # Fraction of the string outside the ball.
        tip = end[0] + share * (centre[0] - end[0]), end[1] + share * (centre[1] - end[1])
        pygame.draw.aaline(surface, tones.muted, end, tip, 2)
        side, letters = math.ceil(size), 0.38 * size
        blit_sprite(surface, bead_sprite(size, colour, 0.0), centre[0] - 0.5 * side, centre[1] - 0.5 * side)
        number = number_sprite(str(k), letters, text_on(colour))
        half = 0.5 * math.ceil(3.0 * letters)
        blit_sprite(surface, number, centre[0] - half, centre[1] - half)


def hanging_thumbnail(size: tuple[int, int]) -> pygame.Surface:
    """Return the thumbnail for the gallery."""
    surface = pygame.Surface(size, 0, 32)
    surface.fill(tones.lane_background)
    paint_cradle(surface, surface.get_rect(), start_places(1))
    return surface
