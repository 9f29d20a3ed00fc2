"""The sweep of a slider: nine values of a parameter side by side, each with the motion that it makes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pygame
from pygame_gui.elements import UIButton
from softcradle.sandbox.draw.curve_panels import Panel, linear_axis
from softcradle.sandbox.draw.palette import bead_colours, tones
from softcradle.sandbox.draw.text import shortened, write
from softcradle.sandbox.languages import _, error_words
from softcradle.sandbox.session.editable_numbers import Parameter, Variant, variants
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.dialog import Overlay, paint_box
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.plots.scales import motions_ahead
from softcradle.sandbox.window.scene.editor import Pick
from softcradle.sandbox.window.widgets import number_text, split, stack, write_wrapped

COLUMNS, ROWS = 3, 3
COUNT = COLUMNS * ROWS
HEAD = 46.0  # design pixels above the plots
MARGIN = 20.0  # design pixels around them


def swept_values(parameter: Parameter) -> list[float]:
    """COUNT values, evenly spaced on the slider from one of its ends to the other."""
    return [parameter.at(k / (COUNT - 1)) for k in range(COUNT)]


class SweepBoard(Overlay):
    """Small multiples over the page; a click on one takes its value, Esc takes none.

    Attributes:
        found: the variants; None until they are computed.
        focus: number of the variant that Enter takes.
    """

    def __init__(
        self, host: Host, session: Session, pick: Pick, parameter: Parameter, take: Callable[[float], object]
    ) -> None:
        self.parameter, self.take = parameter, take
        self.found: list[Variant] | None = None
        self.focus, self._panels = 0, list[Panel]()
        self.present = parameter.value
        self.places: list[pygame.Rect] = []
        super().__init__(host)
        scene = session.to_scene()
        job = partial(variants, scene, pick.lane, swept_values(parameter), parameter.edit, motions_ahead)
        host.warmup.submit(self._take_variants, job)

    def _take_variants(self, found: object) -> None:
        if isinstance(found, list):
            self.found = found
            values = np.array([variant.value for variant in found])
            self.focus = int(np.abs(values - self.present).argmin())
            self._make_panels()
        else:
            self.close()
            self.host.messages.show(_("this cannot be swept: {error}", error=error_words(found)), warning=True)

    def make_widgets(self) -> None:
        """Take a place in the middle of the page, with a button that closes it."""
        unit, (wide, high) = self.host.unit, self.host.size
        self.box = pygame.Rect(0, 0, min(wide - 8, round(1100 * unit)), min(high - 8, round(640 * unit)))
        self.box.center = wide // 2, high // 2
        margin, head = round(MARGIN * unit), round(HEAD * unit)
        place = pygame.Rect(self.box.right - margin - round(84 * unit), self.box.top + round(10 * unit), 1, 1)
        place.size = round(84 * unit), round(28 * unit)
        self.button = UIButton(place, _("Close"), self.manager, command=self.close)
        inner = pygame.Rect(self.box.left + margin, self.box.top + head, self.box.width - 2 * margin, 1)
        inner.height = self.box.bottom - margin // 2 - inner.top
        rows = stack(inner, [0.0] * ROWS, unit)
        self.places = [place for row in rows for place in split(row, [0.0] * COLUMNS, unit)]
        self._make_panels()

    def _make_panels(self) -> None:
        """Axes of velocity for all variants alike, so that they can be compared; each lasts as long as its motion."""
        motions = [variant.motion for variant in self.found or () if variant.motion is not None]
        self._panels = []
        if not motions:
            return
        speeds = np.concatenate([motion.velocity.ravel() for motion in motions])
        low, high = min(0.0, float(speeds.min())), max(0.0, float(speeds.max()))
        room = 0.06 * (high - low) or 1.0
        colours = bead_colours(max(motion.velocity.shape[1] for motion in motions))
        for variant, place in zip(self.found or (), self.places, strict=True):
            motion = variant.motion or motions[0]
            time = float(motion.time[0]), float(motion.time[-1])
            title = f"{_(self.parameter.name)} = {number_text(variant.value)} {self.parameter.unit}".strip()
            axis = linear_axis(shortened(title, 13 * self.host.unit, 0.8 * place.width), low - room, high + room)
            panel = Panel(place, self.host.unit, time, axis, colours=colours, names=[""] * len(colours))
            panel.labelled = False
            if variant.motion is not None:
                panel.colours = colours[: variant.motion.velocity.shape[1]]
                panel.draw_curves(variant.motion.time, variant.motion.velocity)
            self._panels.append(panel)

    def handle(self, event: pygame.Event) -> bool:
        """A click on a variant takes it, one beside the box closes it."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            if not self.box.collidepoint(event.pos):
                self.close()
            for k, place in enumerate(self.places):
                if self.found is not None and place.collidepoint(event.pos):
                    self._choose(k)
        return super().handle(event)

    def key(self, event: pygame.Event) -> None:
        """Arrows move, Enter takes, Esc closes."""
        steps = {pygame.K_LEFT: -1, pygame.K_RIGHT: 1, pygame.K_UP: -COLUMNS, pygame.K_DOWN: COLUMNS, pygame.K_TAB: 1}
        if event.key == pygame.K_ESCAPE:
            self.close()
        elif event.key in steps:
            self.focus = (self.focus + steps[event.key]) % COUNT
        elif event.key in (pygame.K_RETURN, pygame.K_KP_ENTER, pygame.K_SPACE) and self.found is not None:
            self._choose(self.focus)

    def _choose(self, k: int) -> None:
        """Close the board and take the value of variant `k`."""
        self.close()
        if self.found is not None:
            self.take(self.found[k].value)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the dimmed page, the box and its plots."""
        unit = self.host.unit
        paint_box(surface, self.box, unit)
        title = _("Velocities (m/s) for nine values: {name}. A click takes one.", name=_(self.parameter.name))
        room = self.button.rect.left - self.box.left - 2 * MARGIN * unit
        place = (self.box.left + MARGIN * unit, self.box.top + 13 * unit)
        write(surface, shortened(title, 16 * unit, room, bold=True), place, 16 * unit, tones.foreground, bold=True)
        if self.found is None:
            write(surface, _("computing ..."), self.box.center, 16 * unit, tones.muted, align=(0.5, 0.5))
        for variant, panel in zip(self.found or (), self._panels, strict=False):
            self._paint_variant(surface, variant, panel)
        if self.found is not None:
            pygame.draw.rect(surface, tones.accent, self.places[self.focus], max(2, round(2 * unit)), border_radius=5)
        super().paint(surface)

    def _paint_variant(self, surface: pygame.Surface, variant: Variant, panel: Panel) -> None:
        """Draw the axes and curves of one variant, or what is wrong with it."""
        none = np.zeros((0, len(panel.colours)))
        panel.backdrop(surface, np.zeros(0), none, np.zeros(len(panel.colours)), 0.0)
        if variant.motion is not None:
            panel.paint(surface, float(variant.motion.time[-1]), variant.motion.velocity[-1])
            return
        write_wrapped(surface, variant.problem, panel.area, 13 * self.host.unit, tones.warning)
