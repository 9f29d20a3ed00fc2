"""The bottom of the page: the timeline, the time buttons, the slow motion and the clock. The timeline is dragged to
look back.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import pygame
import pygame_gui
from pygame_gui.elements import UIButton
from softcradle.sandbox.draw.palette import bead_colours, mix, tones
from softcradle.sandbox.draw.scene_picture import speed_text
from softcradle.sandbox.draw.text import shortened, width, write
from softcradle.sandbox.languages import _
from softcradle.sandbox.session.contact_events import ContactEvents
from softcradle.sandbox.session.frame_pacing import FramePacer
from softcradle.sandbox.session.inputs import SetSlow
from softcradle.sandbox.session.session import FASTEST, Session
from softcradle.sandbox.story.live_rules import FRAME_RATE
from softcradle.sandbox.story.numbers import fixed, time_unit
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.page import Derived, Host
from softcradle.sandbox.window.page_geometry import MARGIN
from softcradle.sandbox.window.plots.board import PlotBoard
from softcradle.sandbox.window.widgets import Slider, draw_icon

GROWTH = 1.5  # Number of frames that the width of the timeline represents, relative to the length of the history.
LEAST_FRAMES = 6 * FRAME_RATE  # Number of frames that the width of the timeline represents at first.
PICTURES_BETWEEN_READINGS = 12  # Number of frames between two searches for new contact events: a fifth of a second.


class Timeline:
    """A bar that represents the frames of a session's history.

    Attributes:
        frames: number of frames that the complete width represents.
        dragged: True while the pointer scrubs.
        events: contact events that are drawn.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self.rect, self.unit = pygame.Rect(0, 0, 1, 1), 1.0
        self.frames, self.dragged = LEAST_FRAMES, False
        self.events: ContactEvents | None = None
        self._ticks = pygame.Surface((1, 1), pygame.SRCALPHA, 32)
        # Newest frame whose events were read, and number of frames drawn since these events were read.
        self._last, self._age = -1, 0
        self._read = Derived(self._read_of, self._read_events)

    @property
    def bounds(self) -> tuple[int, int]:
        """First and last frame of the history."""
        return self.session.history.first, self.session.history.last

    def place(self, footer: pygame.Rect, unit: float) -> None:
        """Place the timeline at the top of the `footer` of a page."""
        margin = 2 * round((MARGIN - 2.0) * unit)
        self.rect = footer.inflate(-2 * margin, 0)
        self.rect.top, self.rect.height = footer.top + round(12 * unit), round(22 * unit)
        self.unit = unit
        self._read.forget()

    def _time(self, frame: int) -> float:
        return self.session.history.snapshot(frame).time

    def x(self, frame: int) -> float:
        """Return the horizontal pixel of a frame."""
        return self.rect.left + (frame - self.bounds[0]) / self.frames * self.rect.width

    def frame(self, x: float) -> int:
        """Return the frame of the history nearest to the horizontal pixel `x`."""
        first, last = self.bounds
        return min(max(first + round((x - self.rect.left) / self.rect.width * self.frames), first), last)

    def handle(self, event: pygame.Event) -> bool:
        """Handle an event: scrub while the mouse button is down."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self.dragged = self.rect.inflate(0, round(10 * self.unit)).collidepoint(event.pos)
            if self.dragged:
                self.session.scrub_frame(self.frame(event.pos[0]))
            return self.dragged
        if event.type == pygame.MOUSEMOTION and self.dragged:
            self.session.scrub_frame(self.frame(event.pos[0]))
            return True
        return False

    def make_room(self) -> None:
        """Change the number of frames that the width represents, if the history has become longer or much shorter."""
        first, last = self.bounds
        if not self.frames / GROWTH**2 <= last - first <= self.frames:
            self.frames = max(LEAST_FRAMES, round(GROWTH * (last - first)))

    def scrub_to_event(self, direction: int) -> None:
        """Scrub to the next (1) or previous (-1) contact event."""
        frames, shown = self.session.contact_events().frame, self.session.frame
        chosen = frames[frames > shown][:1] if direction > 0 else frames[frames < shown][-1:]
        if len(chosen):
            self.session.scrub_frame(int(chosen[0]))

    def update(self) -> None:
        """Adapt the number of frames that the width represents. This is called once per frame."""
        self.make_room()
        self._age += 1

    def follow(self) -> None:
        """Draw the contact events again if they have changed. New events are added from time to time."""
        self._read.follow()

    def _read_of(self) -> object:
        history = self.session.history
        newest = history.last if self._age > PICTURES_BETWEEN_READINGS else self._last
        return history.branch, self.frames, newest

    def _read_events(self) -> None:
        self._last, self._age = self.session.history.last, 0
        self.events = self.session.contact_events()
        self._ticks = self._drawn_ticks(self.events)

    def _drawn_ticks(self, events: ContactEvents) -> pygame.Surface:
        """Return a transparent surface with a tick for each contact event. There is at most one tick per pixel and
        kind.

        Ticks of closing contacts point up from the middle. Ticks of opening contacts point down.
        """
        surface = pygame.Surface(self.rect.size, pygame.SRCALPHA, 32)
        colours = bead_colours(max(lane.chain.contacts for lane in self.session.lanes) + 1)
        middle, height = self.rect.height // 2, round(0.42 * self.rect.height)
        drawn: set[tuple[int, bool]] = set()
        columns = (events.frame.tolist(), events.contact.tolist(), events.closed.tolist())
        for frame, contact, closed in zip(*columns, strict=True):
            x = round(self.x(frame) - self.rect.left)
            if (x, closed) in drawn:
                continue
            drawn.add((x, closed))
            colour = colours[min(contact + 1, len(colours) - 1)]
            top = middle - height if closed else middle + 2
            surface.fill(colour, (x - 1, top, max(2, round(2 * self.unit)), height))
        return surface

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the timeline."""
        (first, last), unit, rect = self.bounds, self.unit, self.rect
        radius = round(4 * unit)
        pygame.draw.rect(surface, tones.lane_background, rect, border_radius=radius)
        computed = pygame.Rect(rect.left, rect.top, round(self.x(last)) - rect.left, rect.height)
        pygame.draw.rect(surface, tones.grid, computed, border_radius=radius)
        x = round(self.x(self.session.frame))
        past = pygame.Rect(rect.left, rect.top, x - rect.left, rect.height)
        pygame.draw.rect(surface, mix(tones.background, tones.faint, 0.75), past, border_radius=radius)
        surface.blit(self._ticks, self.rect)
        if first > 0:
            place = (rect.left + 6 * unit, rect.centery)
            write(surface, _("older frames are dropped"), place, 13 * unit, tones.muted, align=(0, 0.5))
        knob = pygame.Rect(0, 0, round(4 * unit), rect.height + round(8 * unit))
        knob.center = (x, rect.centery)
        pygame.draw.rect(surface, tones.foreground, knob, border_radius=round(2 * unit))

    def paint_reading(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """Draw the time that belongs to the position of the pointer."""
        if not (self.rect.collidepoint(point) or self.dragged):
            return
        first, last = self.bounds
        size, name = time_unit(max(self._time(last) - self._time(first), 1e-9))
        x = min(max(point[0], self.rect.left + 40 * self.unit), self.rect.right - 40 * self.unit)
        text = f"{fixed(self._time(self.frame(point[0])) / size, 3)} {name}"
        place = (x, self.rect.top - 5 * self.unit)
        box = write(surface, text, place, 13 * self.unit, tones.background, align=(0.5, 1))
        pygame.draw.rect(surface, tones.foreground, box.inflate(12 * self.unit, 4 * self.unit), border_radius=4)
        write(surface, text, place, 13 * self.unit, tones.background, align=(0.5, 1))


SLOWEST = 1000.0  # Slowest motion: wall time in seconds for one second of model time.
# Values of the slow motion that can be selected with keys.
SLOW_MOTIONS = FASTEST, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, SLOWEST
BUTTONS = ("first", "back", "play_pause", "forward", "last", "restart", "fit")
FEW = ("play_pause", "restart")  # Buttons that Explore shows.

MOVING = ("playing", "replaying")  # States of the clock in which it can be paused.
# Smallest speed of the clock that counts as on time, relative to the wanted speed. Below it, a text reports the slow
# clock.
LATE = 0.95
VERY_LATE = 0.70  # Relative speed of the clock below which the text is a warning, because the slower motion is visible.
SLOW_ROOM, GAP = 190.0, 24.0  # Width of the slider, and distance between groups of controls, in design pixels.
CLOCK_ROOM = 240.0  # Width of the clock and its note in design pixels.
# Smallest width in design pixels for messages next to the clock. If there is less space, messages cover the timeline.
MESSAGE_ROOM = 260.0


class TimeControls:
    """Time buttons, the slider of the slow motion, and the clock. `activity` returns the state of the clock.

    Attributes:
        slow: wall time in seconds for one second of model time.
    """

    def __init__(self, host: Host, activity: Callable[[], str]) -> None:
        self.host, self.activity, self.slow = host, activity, 1.0
        self.buttons: dict[str, UIButton] = {}
        self.why: UIButton | None = None
        self.explained = True  # True if there is a collision that can be explained.
        self.slider: Slider | None = None

    def build(self, rect: pygame.Rect, actions: Mapping[str, Callable[[], None]]) -> None:
        """Create the widgets inside `rect`. They perform the `actions` of the page."""
        self.rect, unit, x = rect, self.host.unit, rect.left
        self.buttons, side = {}, round(34 * unit)
        for name in FEW if self.host.explore else BUTTONS:
            if name in actions:
                wide, style = (side + round(16 * unit), "#primary") if name == "play_pause" else (side, "#flat")
                place, tip = pygame.Rect(x, rect.centery - side // 2, wide, side), hint(name)
                self.buttons[name] = UIButton(
                    place, "", self.host.manager, object_id=style, tool_tip_text=tip, command=actions[name]
                )
                x = place.right + round(8 * unit)
        self.why = None
        if "why" in actions:
            text, tip = _("Why?"), hint("why")
            place = pygame.Rect(x, rect.centery - side // 2, width(text, 13 * unit) + round(24 * unit), side)
            self.why = UIButton(
                place, text, self.host.manager, object_id="#primary", tool_tip_text=tip, command=actions["why"]
            )
            x = place.right + round(8 * unit)
            self.follow_why()
        self.slow_left = x + round((GAP - 8.0) * unit)
        place = pygame.Rect(self.slow_left, rect.centery + round(2 * unit), round(SLOW_ROOM * unit), round(14 * unit))
        self.slider = Slider(place, self._share(), (0.0, 1.0), self.host.manager)
        self.clock_left = place.right + round(GAP * unit)

    def follow_why(self) -> None:
        """Enable the button "Why?" if the motion contains a collision that can be explained."""
        if self.why is not None and self.why.is_enabled != self.explained:
            (self.why.enable if self.explained else self.why.disable)()

    def beside(self, footer: pygame.Rect) -> pygame.Rect:
        """Return the part of the `footer` next to the clock. If it is too narrow, return the rectangle of the timeline."""
        unit = self.host.unit
        left, high = self.clock_left + round(CLOCK_ROOM * unit), round(50 * unit)
        if footer.right - left > MESSAGE_ROOM * unit:
            return pygame.Rect(left, footer.bottom - high, footer.right - left, high - round(6 * unit))
        return pygame.Rect(footer.left, footer.top, footer.width, round(40 * unit))

    def _share(self) -> float:
        """Return the position of the slow motion on its slider, from 0 to 1."""
        return min(max(math.log(self.slow / FASTEST) / math.log(SLOWEST / FASTEST), 0.0), 1.0)

    def handle(self, event: pygame.Event) -> bool:
        """Handle events of the slider of the slow motion."""
        if event.type == pygame_gui.UI_HORIZONTAL_SLIDER_MOVED and event.ui_element is self.slider:
            slow = FASTEST * (SLOWEST / FASTEST) ** event.value
            self.set_slow(float(f"{slow:.3g}"))
            return True
        return False

    def set_slow(self, slow: float) -> None:
        """Set the slow motion; 1 is real time."""
        self.slow = min(max(slow, FASTEST), SLOWEST)
        if self.slider is not None:
            self.slider.set_current_value(self._share())

    def step_slow(self, direction: int) -> None:
        """Switch to the next slower (1) or faster (-1) value in SLOW_MOTIONS."""
        if direction > 0:
            beyond = [slow for slow in SLOW_MOTIONS if slow > self.slow * 1.001]
        else:
            beyond = [slow for slow in reversed(SLOW_MOTIONS) if slow < self.slow * 0.999]
        if beyond:  # The list is empty if the slow motion of the scene lies outside the range of the keys.
            self.set_slow(beyond[0])

    def paint_clock(self, surface: pygame.Surface, clock: str, note: str, late: bool = False) -> None:
        """Draw the icons on the buttons, the slow motion, the time `clock`, and the `note` below the time."""
        unit, above = self.host.unit, self.rect.centery - 17 * self.host.unit
        for name, button in self.buttons.items():
            icon = ("pause" if self.activity() in MOVING else "play") if name == "play_pause" else name
            colour = tones.on_accent if name == "play_pause" else tones.foreground
            draw_icon(surface, icon, button.rect.center, 14 * unit, colour)
        write(surface, speed_text(self.slow), (self.slow_left, above), 13 * unit, tones.foreground)
        write(surface, clock, (self.clock_left, above), 16 * unit, tones.foreground, bold=True)
        below, tint = (self.clock_left, self.rect.centery + 4 * unit), tones.warning if late else tones.muted
        write(surface, shortened(note, 13 * unit, CLOCK_ROOM * unit, bold=late), below, 13 * unit, tint, bold=late)


class SceneTimeControls(TimeControls):
    """The time controls of a session. A change of the slow motion is an input of the session.

    The text of `note` is shown below the time.
    """

    def __init__(
        self,
        host: Host,
        session: Session,
        board: PlotBoard,
        activity: Callable[[], str],
        note: Callable[[], tuple[str, bool]],
        may_edit: Callable[[], bool],
    ) -> None:
        super().__init__(host, activity)
        self.session, self.board, self.note, self.may_edit, self.slow = session, board, note, may_edit, session.slow
        self._set: float | None = None  # Slow motion that is applied when the scene continues to play.

    def set_slow(self, slow: float) -> None:
        """Set the slow motion. It is applied as soon as an edit loses no frames.

        Until then it only changes the pace of a replay.
        """
        super().set_slow(slow)
        self._set = self.slow
        if self.may_edit():
            self.apply_slow()

    @property
    def wanted(self) -> float:
        """The slow motion that the user has set, even if it is not applied yet."""
        return self.session.slow if self._set is None else self._set

    def apply_slow(self) -> None:
        """Apply the slow motion that the user has set."""
        if self._set is not None:
            self.session.apply(SetSlow(self._set))
            self._set = None

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw icons and numbers. The slow motion is read from the session again, because an undo or a replay may have
        changed it.
        """
        self.slow = self.wanted
        self.paint_clock(surface, f"t = {self.board.span.clock(self.session.time)}", *self.note())


def late_note(pacer: FramePacer) -> tuple[str, bool]:
    """Return a text about a clock that is slower than wanted. It is empty if the clock is on time.

    The second value is True if the text is a warning.
    """
    ratio = pacer.clock_ratio
    text = "" if ratio >= LATE else _("slower than shown: {percent:.0f} %", percent=100 * ratio)
    return text, ratio < VERY_LATE
