"""The cards of the lanes. Each card shows the method of its lane, and a badge with the reliability of the result."""

from __future__ import annotations

import math
from functools import partial

import pygame
import pygame_gui
from pygame_gui.elements import UIButton, UIDropDownMenu
from softcradle.physics import METHODS
from softcradle.physics.methods import refusal_of
from softcradle.sandbox.draw.palette import mix, tones
from softcradle.sandbox.draw.text import shortened, write
from softcradle.sandbox.languages import _, scene_words
from softcradle.sandbox.session.inputs import SetMethod
from softcradle.sandbox.session.run_verdict import Finding, Health
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.velocity_check import METHOD, VelocityCheck
from softcradle.sandbox.story import verdict
from softcradle.sandbox.story.numbers import fixed, scientific, time_unit
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.scene.editor import AUTO
from softcradle.sandbox.window.widgets import fits, paint_whole, write_wrapped

HEIGHT = 246.0  # Height of a single card in design pixels.
HEIGHT_COMPACT = 84.0  # Height in design pixels of a card without numbers. Such cards are used for two lanes.
GAP = 8.0  # Distance below a card in design pixels.
ROOM = 300.0  # Height in design pixels that the inspector needs below the cards.
SECONDS_BETWEEN_READINGS = 0.2
SUMMARIES = {method.name: method.summary for method in METHODS}


class LaneCards:
    """The cards of all lanes.

    Attributes:
        rects: rectangles of the cards; empty while the cards are hidden to give space to the selection.
        menus: method menus of the cards.
        verdicts: buttons with the worst problem of the stored frames; a click goes to the frame of the problem.
        checks: checks of the velocities of each lane.
        health: latest verdict on each lane.
        tight: True if cards and inspector do not both fit.
        crowded_out: True while the cards are hidden.
    """

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        self.rects: list[pygame.Rect] = []
        self.menus: list[UIDropDownMenu] = []
        self.verdicts: list[UIButton] = []
        self.health: list[Health] = []
        self.checks = [VelocityCheck(session, lane) for lane in range(len(session.lanes))]
        self.tight = self.crowded_out = self.compact = False
        self._cut: list[tuple[pygame.Rect, str]] = []  # Rectangles of texts that do not fit, with the complete texts.
        self._seconds = math.inf  # Seconds since the last update of the verdicts.

    def build(self, rect: pygame.Rect, selected: bool) -> pygame.Rect:
        """Create the widgets at the top of `rect`. Return the remaining rectangle.

        If a bead or contact is `selected` and the space is tight, the cards are hidden and the complete `rect` is
        returned.
        """
        unit, count = self.host.unit, len(self.session.lanes)
        room = rect.height / unit - ROOM
        self.compact = count > 1 or room < HEIGHT + GAP
        self.tight = bool(rect.width) and room < count * (HEIGHT_COMPACT + GAP)
        self.crowded_out = self.tight and selected
        height = round((HEIGHT_COMPACT if self.compact else HEIGHT) * unit)
        pitch = height + round(GAP * unit)
        lanes = range(count) if rect.width and not self.crowded_out else range(0)
        self.rects = [pygame.Rect(rect.left, rect.top + k * pitch, rect.width, height) for k in lanes]
        self.menus = [self._menu(k) for k in lanes]
        self.verdicts = [self._verdict(k) for k in lanes]
        self._seconds = math.inf
        used = len(self.rects) * pitch
        return pygame.Rect(rect.left, rect.top + used, rect.width, rect.height - used)

    def made_of(self, selected: bool) -> object:
        """Return the values on which the widgets depend. Menus do not update themselves, and a selection may hide the
        cards.
        """
        return [self.method(k) for k in range(len(self.session.lanes))], self.tight and selected

    def _menu(self, lane: int) -> UIDropDownMenu:
        unit, rect = self.host.unit, self.rects[lane]
        width = round(132 * unit)
        place = pygame.Rect(rect.right - width, rect.top + round(8 * unit), width, round(26 * unit))
        return UIDropDownMenu([AUTO, *SUMMARIES], self.method(lane), place, self.host.manager)

    def _verdict(self, lane: int) -> UIButton:
        unit, rect = self.host.unit, self.rects[lane]
        high, margin = round(24 * unit), round(6 * unit)
        place = pygame.Rect(rect.left + margin, rect.bottom - high - margin // 2, rect.width - 2 * margin, high)
        show, tip = partial(self.show_fault, lane), _("for all stored frames")
        return UIButton(place, "", self.host.manager, object_id="#flat", tool_tip_text=tip, command=show)

    def show_fault(self, lane: int) -> None:
        """Show the first frame of the worst problem of a lane."""
        worst = _worst(self.session.findings(lane))
        if worst is not None:
            self.session.scrub_frame(max(worst.first, self.session.history.first))

    def method(self, lane: int) -> str:
        """Return the present entry of the method menu of a lane."""
        setup = self.session.lanes[lane].setup
        return AUTO if setup.automatic else setup.method

    def next_method(self) -> str:
        """Return the menu entry that follows the method of the first lane. Methods that cannot simulate all chains are
        skipped.
        """
        names, chains = [AUTO, *SUMMARIES], [lane.chain for lane in self.session.lanes]
        k = names.index(self.method(0)) + 1
        carrying = (n for n in names[k:] + names[:k] if n == AUTO or not any(refusal_of(n, chain) for chain in chains))
        return next(carrying)

    def handle(self, event: pygame.Event) -> SetMethod | None:
        """Return the input for an entry that was chosen in a method menu, or None."""
        if event.type == pygame_gui.UI_DROP_DOWN_MENU_CHANGED and event.ui_element in self.menus:
            return SetMethod(self.menus.index(event.ui_element), event.text)
        return None

    def update(self, seconds: float) -> None:
        """Update the verdict on every lane from time to time."""
        self._seconds += seconds
        if self._seconds < SECONDS_BETWEEN_READINGS:
            return
        self._seconds = 0.0
        self._check_velocities()
        self.health = [self.session.health(lane, check.error()) for lane, check in enumerate(self.checks)]
        for lane, button in enumerate(self.verdicts):
            whole = self._verdict_text(lane)
            text = shortened(whole, 13 * self.host.unit, self.rects[lane].width - 24 * self.host.unit)
            if button.text != text:
                button.set_text(text)
                button.tool_tip_text = _("for all stored frames") if text == whole else whole

    def _check_velocities(self) -> None:
        """Compare the velocities of each lane with an accurate run in the background thread."""
        for check in self.checks:
            if self.host.warmup.is_warm(METHOD):
                job = check.job()
                if job is not None:
                    self.host.warmup.submit(partial(check.take, check.base), job)

    def _verdict_text(self, lane: int) -> str:
        worst = _worst(self.session.findings(lane))
        if worst is None and self.session.history.first == 0:
            return _("whole run OK")
        size, name = time_unit(max(self.session.span[1], 1e-9))
        if worst is None:
            return _("no problem since {time} {unit}", time=fixed(self.session.span[0] / size, 2), unit=name)
        first, last = (fixed(time / size, 2) for time in (worst.begin, worst.end))
        return _("{cause}, {first} to {last} {unit}", cause=worst.cause, first=first, last=last, unit=name)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the badges."""
        self._cut.clear()
        for number, (rect, state) in enumerate(zip(self.rects, self.health, strict=False)):
            self._card(surface, rect, state, number)

    def _card(self, surface: pygame.Surface, rect: pygame.Rect, state: Health, number: int) -> None:
        unit = self.host.unit
        if state.level == verdict.BAD:
            pygame.draw.rect(surface, mix(tones.background, tones.bad, 0.12), rect.inflate(14, 0), border_radius=6)
        if self.compact:
            self._title(surface, rect, number)
            y: float = rect.top + 38 * unit
        else:
            y = self._method_lines(surface, rect, number)
            y = self._numbers(surface, rect, _numbers(state), y)
        self._sentence(surface, rect, state, y)

    def _title(self, surface: pygame.Surface, rect: pygame.Rect, number: int) -> None:
        unit, label = self.host.unit, scene_words(self.session.label(number))
        title = label if len(self.session.lanes) > 1 and label else _("method")
        title = shortened(title, 13 * unit, rect.width - 140 * unit, bold=True)
        write(surface, title, (rect.left, rect.top + 12 * unit), 13 * unit, tones.foreground, bold=True)

    def _method_lines(self, surface: pygame.Surface, rect: pygame.Rect, number: int) -> float:
        """Draw the title of a lane, its method with the step, and a summary. Return the position of the next line."""
        unit, lane = self.host.unit, self.session.lanes[number]
        self._title(surface, rect, number)
        x, y = rect.left, rect.top + 12 * unit
        step = lane.setup.step_for(self.session.setup.frame_time)
        method = lane.setup.method
        line = _("{method}, adaptive", method=method)
        if step:
            line = _("{method}, step {step} s", method=method, step=scientific(step))
        write(surface, line, (x, y + 26 * unit), 13 * unit, tones.muted)
        y += 43 * unit
        summary = shortened(_(SUMMARIES[method]), 13 * unit, rect.width)
        write(surface, summary, (x, y), 13 * unit, tones.muted)
        if summary != _(SUMMARIES[method]):
            self._cut.append((pygame.Rect(x, round(y), rect.width, round(18 * unit)), _(SUMMARIES[method])))
        return y + 20 * unit

    def _numbers(self, surface: pygame.Surface, rect: pygame.Rect, numbers: list[tuple[str, str]], y: float) -> float:
        """Draw each number on a separate line. Return the position of the next line."""
        unit = self.host.unit
        for name, text in numbers:
            write(surface, name, (rect.left, y), 13 * unit, tones.muted)
            write(surface, text, (rect.right, y), 13 * unit, tones.foreground, align=(1, 0))
            y += 18 * unit
        return y

    def _sentence(self, surface: pygame.Surface, rect: pygame.Rect, state: Health, y: float) -> None:
        """Draw a mark, and the part of the sentence about the reliability that fits above the button."""
        unit, tint, x = self.host.unit, getattr(tones, state.level), rect.left
        mark = "✓" if state.level == verdict.GOOD else "!"
        write(surface, mark, (x, y + 2 * unit), 13 * unit, tint, bold=True)
        place = pygame.Rect(round(x + 16 * unit), round(y + 2 * unit), rect.width - round(16 * unit), 0)
        place.height = max(round(19 * unit), round(rect.bottom - 30 * unit - y))
        write_wrapped(surface, state.sentence, place, 13 * unit, tint)
        if not fits(state.sentence, place, 13 * unit):
            self._cut.append((place, state.sentence))

    def paint_over(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """Draw the complete text while the pointer is on a text that does not fit."""
        unit = self.host.unit
        for place, text in self._cut:
            if place.collidepoint(point):
                corner = place.left - round(20 * unit), place.bottom
                paint_whole(surface, text, corner, round(1.4 * place.width), unit)


def _worst(found: list[Finding]) -> Finding | None:
    """Return the first of the most severe findings, or None."""
    gravest = sorted(found, key=lambda one: (-verdict.LEVELS.index(one.level), one.first))
    return gravest[0] if gravest else None


def _numbers(state: Health) -> list[tuple[str, str]]:
    """Return the names and values of the numbers in the badge."""
    chatter = fixed(state.chatter, 1) if state.chatter < 1e4 else scientific(state.chatter)
    return [
        (_("velocity error"), _error(state.velocity_error, _("not known"))),
        (_("energy error"), _error(state.energy_error, _("not known"))),
        (_("momentum error"), _error(state.momentum_error, _("not conserved"))),
        (_("chatter"), chatter),
        (_("time per frame"), f"{fixed(state.milliseconds, 2)} ms"),
    ]


def _error(error: float | None, none: str) -> str:
    if error is None:
        return none
    return scientific(error) if error >= 1e-17 else "0"
