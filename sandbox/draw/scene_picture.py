"""Picture of a scene at one size. It is composed of pictures of the lanes. All lanes show the same time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame
from pygame import Rect
from softcradle.sandbox.draw.axes import decade_axis, linear_axis
from softcradle.sandbox.draw.curve_panels import Panel
from softcradle.sandbox.draw.energy_bars import EnergyBars
from softcradle.sandbox.draw.lane_drawing import KEY, LaneDrawing
from softcradle.sandbox.draw.magnified_insets import MagnifiedInsets
from softcradle.sandbox.draw.palette import mix, tones
from softcradle.sandbox.draw.shared_scales import Scales, scales_of
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.languages import _, scene_words
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.quantities import FORCE, OVERLAP, VELOCITY
from softcradle.sandbox.story.bodies import body_word
from softcradle.sandbox.story.lane_story import motion_outcome
from softcradle.sandbox.story.numbers import TIMES, fixed, plain, subscript, time_unit
from softcradle.sandbox.story.sentences import outcome_words
from softcradle.scenes import Scene

# Size of a picture in design pixels. A design pixel is 1/DESIGN_HEIGHT of the height of a picture. If 1/DESIGN_WIDTH of
# the width of the picture is smaller, a design pixel has this size. All lengths below are in design pixels.
DESIGN_HEIGHT = 720.0
DESIGN_WIDTH = 1000.0
MARGIN = 28.0  # Free space on the left and on the right of a picture.
HEADER = 82.0  # Height of the header, including the free space above it.
FOOTER = 14.0  # Free space at the lower edge of a picture.
GUTTER = 22.0  # Space between panels.
INSETS_HEIGHT = 92.0  # Height of the magnified insets in a picture of a single lane.
INSETS_HEIGHT_IN_ROW = 76.0  # Height of the magnified insets in a picture of several lanes.
BARS_HEIGHT = 40.0  # Height of the energy and momentum bars.


@dataclass(frozen=True)
class LaneLayout:
    """Rectangles of one lane [pixels]. There is one rectangle for the beads, one for the magnified insets, one for the
    bars of energy and momentum, and one for each panel of curves.
    """

    drawing: Rect
    insets: Rect
    bars: Rect
    panels: tuple[Rect, ...]


@dataclass(frozen=True)
class Layout:
    """Rectangles of a picture [pixels]. `unit` is the number of pixels per design pixel."""

    unit: float
    header: Rect
    lanes: tuple[LaneLayout, ...]


def picture_layout(size: tuple[int, int], lanes: int) -> Layout:
    """Return the layout of a picture of `size` [pixels].

    In a picture of a single lane, the beads are above three panels. Several lanes are stacked. Each of them has its
    beads on the left and two panels on the right.
    """
    unit = min(size[1] / DESIGN_HEIGHT, size[0] / DESIGN_WIDTH)
    margin = MARGIN * unit
    inner = size[0] - 2 * margin
    header = _rect(margin, 16 * unit, inner, (HEADER - 16) * unit)
    top, height = HEADER * unit, size[1] - (HEADER + FOOTER) * unit
    if lanes == 1:
        return Layout(unit, header, (_single(margin, top, inner, height, unit),))
    row = height / lanes
    rows = tuple(_row(margin, top + k * row, inner, row - GUTTER * unit / 2, unit) for k in range(lanes))
    return Layout(unit, header, rows)


def _single(x: float, y: float, width: float, height: float, unit: float) -> LaneLayout:
    insets, bars, gutter = INSETS_HEIGHT * unit, BARS_HEIGHT * unit, GUTTER * unit
    drawing = 0.42 * height
    panels = y + drawing + insets + 0.5 * gutter
    panel_height = y + height - bars - 0.5 * gutter - panels
    panel_width = (width - 2 * gutter) / 3
    return LaneLayout(
        _rect(x, y, width, drawing),
        _rect(x, y + drawing, width, insets),
        _rect(x, y + height - bars, width, bars),
        tuple(_rect(x + k * (panel_width + gutter), panels, panel_width, panel_height) for k in range(3)),
    )


def _row(x: float, y: float, width: float, height: float, unit: float) -> LaneLayout:
    left = 0.61 * width
    bars = BARS_HEIGHT * unit
    insets = INSETS_HEIGHT_IN_ROW * unit if height > 220 * unit else 0.0
    side, side_width = x + left + GUTTER * unit, width - left - GUTTER * unit
    panel = (height - 8 * unit) / 2
    return LaneLayout(
        _rect(x, y, left, height - insets - bars),
        _rect(x, y + height - insets - bars, left, insets),
        _rect(x, y + height - bars, left, bars),
        tuple(_rect(side, y + k * (panel + 8 * unit), side_width, panel) for k in range(2)),
    )


def _rect(x: float, y: float, width: float, height: float) -> Rect:
    return Rect(round(x), round(y), round(x + width) - round(x), round(y + height) - round(y))


class Picture:
    """Parts of the pictures of a scene that are the same in every frame. These parts are drawn only once.

    Arguments:
        scene: the scene.
        motions: one Motion for each lane, all with the same times.
        size: width and height [pixels].
        scales: common scales of all lanes; None computes them from the motions.
        slow: seconds of film per second of motion, for the label; None uses the value of the scene.
        ahead: strength of the colours of the curves after the cursor, from 0 to 1.
    """

    def __init__(
        self,
        scene: Scene,
        motions: Sequence[Motion],
        size: tuple[int, int],
        *,
        scales: Scales | None = None,
        slow: float | None = None,
        ahead: float = 0.2,
    ) -> None:
        self.scene, self.motions, self.size = scene, tuple(motions), size
        self.ahead = ahead
        self.slow = scene.view.slow if slow is None else slow
        self.scales = scales_of(scene, motions) if scales is None else scales
        self.layout: Layout = picture_layout(size, len(self.motions))
        self.lanes = [_LanePicture(self, k, place) for k, place in enumerate(self.layout.lanes)]
        self.background = pygame.Surface(size, 0, 32)
        self._backdrop(self.background)

    def paint(self, surface: pygame.Surface, row: int, centre: float | None = None, text_opacity: float = 0.0) -> None:
        """Draw the sample `row` of the motions on `surface`. The surface must have the size of the picture.

        `centre` [m] is the position of the camera. `text_opacity` (0 to 1) is the opacity of the text of the scene.
        """
        surface.blit(self.background, (0, 0))
        self._write_time(surface, float(self.motions[0].time[row]))
        for lane in self.lanes:
            lane.paint(surface, row, centre)
        if text_opacity > 0.0:
            self._write_text(surface, min(text_opacity, 1.0))

    def _backdrop(self, surface: pygame.Surface) -> None:
        surface.fill(tones.background)
        header, unit = self.layout.header, self.layout.unit
        room, line_y = header.width - 200 * unit, header.top + 35 * unit
        title = shortened(scene_words(self.scene.title), 25 * unit, room, bold=True)
        write(surface, title, header.topleft, 25 * unit, tones.foreground, bold=True)
        line = "  ·  ".join(
            part for part in (scene_words(self.scene.question or self.scene.source), self.motions[0].method) if part
        )
        write(surface, shortened(line, 14 * unit, room), (header.left, line_y), 14 * unit, tones.muted)
        write(surface, speed_text(self.slow), (header.right, line_y), 14 * unit, tones.muted, align=(1, 0))
        for lane in self.lanes:
            lane.backdrop(surface)

    def _write_text(self, surface: pygame.Surface, opacity: float) -> None:
        """Write the text of the scene between the key and the beads of the first lane."""
        drawing, unit = self.lanes[0].drawing, self.layout.unit
        size = min(15.5 * unit, drawing.rect.width / 42)
        width, room = 0.62 * drawing.rect.width, drawing.bar_base - (KEY + 2) * unit
        lines = wrapped(scene_words(self.scene.text), size, width)
        outcome = [line for words in self.outcomes() for line in wrapped(words, size, width)]
        if 1.4 * size * (len(lines) + len(outcome)) <= room:
            lines += outcome
        centred = (drawing.rect.top + drawing.bar_base + 10 * unit) / 2 - 0.7 * size * len(lines)
        y = max(centred, drawing.rect.top + (KEY + 2) * unit)
        veil = pygame.Surface((round(0.64 * drawing.rect.width), round(1.4 * size * len(lines))), 0, 32)
        veil.fill(tones.lane_background)
        veil.set_alpha(round(255 * opacity))
        surface.blit(veil, veil.get_rect(midtop=(drawing.rect.centerx, round(y))))
        colour = mix(tones.lane_background, tones.foreground, opacity)
        for k, line in enumerate(lines):
            write(surface, line, (drawing.rect.centerx, y + 1.4 * size * k), size, colour, align=(0.5, 0))

    def outcomes(self) -> list[str]:
        """Return a description of the outcome of each lane. If there are several lanes, each description starts with
        the label of its lane.
        """
        lasts, found = self.scene.duration is not None, []
        for lane, motion in zip(self.scene.lanes, self.motions, strict=False):
            words, label = (
                outcome_words(motion_outcome(motion, lasts), body_word(motion.chain)),
                scene_words(lane.label),
            )
            found.append(_("{label}: {words}", label=label, words=words) if len(self.motions) > 1 and label else words)
        return found

    def _write_time(self, surface: pygame.Surface, time: float) -> None:
        header, unit = self.layout.header, self.layout.unit
        span = self.scales.time[1] - self.scales.time[0]
        size, name = time_unit(span)
        decimals = max(0, 3 - int(np.floor(np.log10(span / size))))
        text = f"t = {fixed(time / size, decimals)} {name}"
        write(surface, text, header.topright, 25 * unit, tones.foreground, bold=True, align=(1, 0))


class _LanePicture:
    """Parts of the picture of one lane."""

    def __init__(self, picture: Picture, number: int, place: LaneLayout) -> None:
        scene, scales, unit = picture.scene, picture.scales, picture.layout.unit
        self.motion = picture.motions[number]
        self.drawing = LaneDrawing(place.drawing, unit, scene, number, scales)
        self.insets = MagnifiedInsets(place.insets, unit, self.drawing, scales.deepest[number])
        self.bars = EnergyBars(place.bars, unit, self.drawing.colours, self.drawing.chain.dissipative, scales)
        self.panels = [self._panel(rect, kind, scales, unit) for kind, rect in enumerate(place.panels)]
        self.ahead = picture.ahead
        for panel, values in zip(self.panels, _curves(self.motion), strict=False):
            panel.draw_curves(self.motion.time, values)

    def _panel(self, rect: pygame.Rect, kind: int, scales: Scales, unit: float) -> Panel:
        """Return one panel. The panel shows velocities if `kind` is 0, forces if it is 1 and overlaps if it is 2."""
        colours, contact_colours = self.drawing.colours, self.drawing.contact_colours
        contacts = range(len(contact_colours))
        if kind == 0:
            names = [VELOCITY.symbol + subscript(i) for i in range(len(colours))]
            axis = linear_axis(_(VELOCITY.title), *scales.velocity)
            return Panel(rect, unit, scales.time, axis, colours=colours, names=names)
        if kind == 1:
            axis, shown = linear_axis(_(FORCE.title), scales.pull, scales.force), FORCE
        else:
            axis, shown = decade_axis(_("overlap (m), logarithmic"), *scales.decades), OVERLAP
        names = [shown.symbol + subscript(i, i + 1) for i in contacts]
        return Panel(rect, unit, scales.time, axis, colours=contact_colours, names=names)

    def backdrop(self, surface: pygame.Surface) -> None:
        self.drawing.backdrop(surface)
        self.insets.backdrop(surface)
        self.bars.backdrop(surface)
        for panel, values, peaks in zip(self.panels, _curves(self.motion), _peaks(self.motion), strict=False):
            panel.backdrop(surface, self.motion.time, values, peaks, self.ahead)

    def paint(self, surface: pygame.Surface, row: int, centre: float | None) -> None:
        contacts = self.drawing.paint(surface, self.motion, row, self.drawing.left(centre))
        self.insets.paint(surface, self.motion, row, contacts)
        self.bars.paint(surface, self.motion, row)
        for panel, values in zip(self.panels, _curves(self.motion), strict=False):
            panel.paint(surface, float(self.motion.time[row]), values[row])


def _curves(motion: Motion) -> tuple[Array, Array, Array]:
    """Return the curves of the panels from left to right. If there are several lanes, each lane shows only the first
    two panels.
    """
    return motion.velocity, motion.force, motion.overlap


def speed_text(slow: float) -> str:
    """Return the label of a playback speed. At this speed, one second of motion lasts `slow` seconds."""
    if abs(slow - 1.0) < 1e-9:
        return _("real time")
    if slow > 1.0:
        return _("slow motion 1/{times}", times=plain(slow, 4))
    return _("fast motion {times}", times=TIMES + plain(1.0 / slow, 4))


def _peaks(motion: Motion) -> tuple[Array, Array, Array]:
    """Return the values that determine the heights of the names of the curves.

    These values are the final velocity of each bead, the strongest push or pull of each contact, and the largest
    overlap of each contact.
    """
    low, high = motion.force.min(axis=0), motion.force.max(axis=0)
    return motion.velocity[-1], np.where(-low > high, low, high), motion.overlap.max(axis=0)
