"""Widgets that pygame_gui lacks: a slider with mouse and key support, a named text field, a control for a number, and
icons.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import pygame
from pygame_gui.core import UIElement
from pygame_gui.elements import UIButton, UIHorizontalSlider, UITextEntryBox, UITextEntryLine
from softcradle.sandbox.draw.palette import Colour, tones
from softcradle.sandbox.draw.surfaces import cached_surfaces
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.languages import _, localized
from softcradle.sandbox.session.editable_numbers import Parameter
from softcradle.sandbox.story.numbers import MINUS
from softcradle.sandbox.window.page import Host

# Fraction of the range by which an arrow key moves a slider. It is larger than the distance between two round values of
# a linear slider.
STEP = 0.02
PAGE = 0.1  # Fraction of the range by which Page Up and Page Down move a slider.
ENTRY = 92.0  # Width of the text field of a number in design pixels.
SWEEP = 26.0  # Width of the button for a sweep in design pixels.
PRESS = (pygame.K_RETURN, pygame.K_KP_ENTER, pygame.K_SPACE)  # Keys that press the button that has the focus.
KEYS = {
    pygame.K_LEFT: -STEP,
    pygame.K_DOWN: -STEP,
    pygame.K_RIGHT: STEP,
    pygame.K_UP: STEP,
    pygame.K_PAGEDOWN: -PAGE,
    pygame.K_PAGEUP: PAGE,
    pygame.K_HOME: -1.0,
    pygame.K_END: 1.0,
}


class Slider(UIHorizontalSlider):
    """A slider from 0 to 1."""

    def process_event(self, event: pygame.Event) -> bool:
        """Move the slider's button to a mouse press on the track. The user can then drag it further."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1 and self.is_enabled:
            button, point = self.sliding_button, self.ui_manager.calculate_scaled_mouse_position(event.pos)
            if button is not None and self.rect.collidepoint(point) and not button.rect.collidepoint(point):
                track = max(1, self.rect.width - button.rect.width)
                self._move_to((point[0] - self.rect.left - button.rect.width / 2) / track)
                button.hovered = True
                return bool(button.process_event(event))
        return bool(super().process_event(event))

    def move_by(self, step: float) -> None:
        """Move the value by `step`, a fraction of the range. The arrow keys use this method."""
        self._move_to(self.get_current_value() + step)

    def _move_to(self, share: float) -> None:
        self.set_current_value(min(max(share, 0.0), 1.0), warn=False)
        self.rebuild_button()
        self._update_data_and_fire_events_when_moved()

    def rebuild_button(self) -> None:
        """Move the button to the present value at once."""
        self.scroll_position = round(self.current_percentage * self.scrollable_width)
        if self.sliding_button is not None:
            self.sliding_button.set_relative_position((self.scroll_position + self.arrow_button_width, 0))


REPEAT = 350, 45  # Milliseconds until a held key repeats, and milliseconds between two repetitions.


class _Typed(UIElement):
    """Base class of text fields."""

    def unfocus(self) -> None:
        """Remove the focus, and switch the key repetition on again. pygame_gui switches it off."""
        super().unfocus()
        pygame.key.set_repeat(*REPEAT)


class TextEntry(_Typed, UITextEntryLine):
    """A text field with one line."""


class TextBox(_Typed, UITextEntryBox):
    """A text field with several lines."""


Point = tuple[float, float]
Shape = Sequence[Sequence[Point]]

# Polygons of the icons, in a square from -1 to 1.
_BAR_LEFT: Sequence[Point] = ((-0.9, -0.9), (-0.62, -0.9), (-0.62, 0.9), (-0.9, 0.9))
SHAPES: dict[str, Shape] = {
    "play": (((-0.7, -1.0), (1.0, 0.0), (-0.7, 1.0)),),
    "pause": (
        ((-0.8, -0.9), (-0.2, -0.9), (-0.2, 0.9), (-0.8, 0.9)),
        ((0.2, -0.9), (0.8, -0.9), (0.8, 0.9), (0.2, 0.9)),
    ),
    "back": (((0.3, -0.9), (-1.0, 0.0), (0.3, 0.9)), ((0.55, -0.9), (0.9, -0.9), (0.9, 0.9), (0.55, 0.9))),
    "forward": (((-0.3, -0.9), (1.0, 0.0), (-0.3, 0.9)), ((-0.55, -0.9), (-0.9, -0.9), (-0.9, 0.9), (-0.55, 0.9))),
    "first": (_BAR_LEFT, ((0.15, -0.9), (-0.6, 0.0), (0.15, 0.9)), ((0.95, -0.9), (0.2, 0.0), (0.95, 0.9))),
    "fit": (
        ((-1.0, 0.0), (-0.45, -0.5), (-0.45, 0.5)),
        ((1.0, 0.0), (0.45, -0.5), (0.45, 0.5)),
        ((-0.3, -0.25), (0.3, -0.25), (0.3, 0.25), (-0.3, 0.25)),
    ),
    "last": (
        ((0.9, -0.9), (0.62, -0.9), (0.62, 0.9), (0.9, 0.9)),
        ((-0.15, -0.9), (0.6, 0.0), (-0.15, 0.9)),
        ((-0.95, -0.9), (-0.2, 0.0), (-0.95, 0.9)),
    ),
}


def _restart(fine: pygame.Surface, colour: Colour, centre: Point, size: float) -> None:
    """Draw the icon for a restart: an arrow along a circle."""
    box = pygame.Rect(0, 0, round(1.7 * size), round(1.7 * size))
    box.center = (round(centre[0]), round(centre[1]))
    pygame.draw.arc(fine, colour, box, 0.9, 6.6, max(2, round(0.26 * size)))
    x, y = box.right - 0.30 * size, box.top + 0.42 * size
    pygame.draw.polygon(
        fine, colour, [(x - 0.75 * size, y), (x + 0.35 * size, y + 0.1 * size), (x + 0.15 * size, y - 0.8 * size)]
    )


_DRAWN: dict[str, Callable[[pygame.Surface, Colour, Point, float], None]] = {"restart": _restart}


@cached_surfaces(1)
def icon(name: str, size: int, colour: Colour) -> pygame.Surface:
    """Return the icon `name`, `size` pixels wide and high, on a transparent surface."""
    fine = pygame.Surface((4 * size, 4 * size), pygame.SRCALPHA, 32)
    fine.fill((*colour, 0))
    half = 2.0 * size
    if name in _DRAWN:
        _DRAWN[name](fine, colour, (half, half), 0.92 * half)
    else:
        for polygon in SHAPES[name]:
            pygame.draw.polygon(fine, colour, [(half * (1 + 0.92 * x), half * (1 + 0.92 * y)) for x, y in polygon])
    return pygame.transform.smoothscale(fine, (size, size))


def draw_icon(surface: pygame.Surface, name: str, centre: Point, size: float, colour: Colour) -> None:
    """Draw the icon `name` with its centre at `centre`."""
    image = icon(name, max(6, round(size)), colour)
    surface.blit(image, image.get_rect(center=(round(centre[0]), round(centre[1]))))


def fits(text: str, rect: pygame.Rect, size: float) -> bool:
    """Return True if the whole `text` fits into `rect`."""
    return not text or 1.4 * size * len(wrapped(text, size, rect.width)) <= rect.height


def write_wrapped(surface: pygame.Surface, text: str, rect: pygame.Rect, size: float, tint: Colour) -> float:
    """Draw the lines of `text` that fit into `rect`. Return the bottom edge of the text.

    An ellipsis is drawn if lines are left out.
    """
    lines, pitch = wrapped(text, size, rect.width), 1.4 * size
    room = max(0, int(rect.height // pitch))
    for k, line in enumerate(lines[:room]):
        shown = shortened(f"{line} …", size, rect.width) if k == room - 1 < len(lines) - 1 else line
        write(surface, shown, (rect.left, rect.top + k * pitch), size, tint)
    return rect.top + pitch * min(room, len(lines))


def paint_whole(surface: pygame.Surface, text: str, corner: tuple[int, int], wide: int, unit: float) -> None:
    """Draw the complete `text` in a box with the lower right corner `corner`. It is used for a text that does not fit
    on the page.
    """
    size, room = 13 * unit, wide - 24 * unit
    box = pygame.Rect(0, 0, wide, round(1.4 * size * len(wrapped(text, size, room)) + 20 * unit))
    box.bottomright = corner
    box.clamp_ip(surface.get_rect())
    pygame.draw.rect(surface, tones.background, box, border_radius=round(6 * unit))
    pygame.draw.rect(surface, tones.muted, box, 1, border_radius=round(6 * unit))
    write_wrapped(surface, text, box.inflate(-24 * unit, -16 * unit), size, tones.foreground)


def split(rect: pygame.Rect, sizes: Sequence[float], unit: float, gap: float = 8.0) -> list[pygame.Rect]:
    """Divide `rect` into rectangles side by side.

    `sizes` are the widths of the rectangles and `gap` is the distance between them [design pixels]. Rectangles of size
    0 share the remaining width.
    """
    spare = rect.width - unit * (sum(sizes) + gap * (len(sizes) - 1))
    share = max(0.0, spare / max(1, list(sizes).count(0)))
    found, x = [], float(rect.left)
    for size in sizes:
        wide = size * unit or share
        found.append(pygame.Rect(round(x), rect.top, round(wide), rect.height))
        x += wide + gap * unit
    return found


def stack(rect: pygame.Rect, heights: Sequence[float], unit: float, gap: float = 8.0) -> list[pygame.Rect]:
    """Divide `rect` into rectangles below each other. It corresponds to `split`, which divides from left to right."""
    turned = split(pygame.Rect(rect.top, rect.left, rect.height, rect.width), heights, unit, gap)
    return [pygame.Rect(one.top, one.left, one.height, one.width) for one in turned]


def number(text: str) -> float:
    """Return the number in `text`, such as 0.1, 1e-3 or 1/14. A decimal comma and a typographic minus sign are
    accepted.

    Raise ValueError if the text is not a finite number. A bead is made a wall with a button, not by typing 1e999 as its
    mass.
    """
    cleaned = text.replace(MINUS, "-").replace(",", ".").strip()
    numerator, slash, denominator = cleaned.partition("/")
    if slash and float(denominator) == 0.0:
        raise ValueError(_("{text!r} divides by zero", text=text))
    value = float(numerator) / float(denominator) if slash else float(cleaned)
    if not math.isfinite(value):
        raise ValueError(_("{text!r} is not finite", text=text))
    return value


@dataclass
class Control:
    """The widgets of one parameter: its slider and its text field.

    Attributes:
        shown: value in the text field.
        typed: True if the text field had the focus in the last frame.
    """

    parameter: Parameter
    slider: Slider
    entry: TextEntry
    sweep: UIButton | None
    shown: float
    typed: bool = False

    @property
    def grabbed(self) -> bool:
        """True while the user holds the slider."""
        return bool(self.slider.sliding_button is not None and self.slider.sliding_button.held)

    def left_text(self) -> str | None:
        """Return the typed text after the field has lost the focus in this frame, if its number has changed. Otherwise
        return None.
        """
        left, self.typed = self.typed and not self.entry.is_focused, self.entry.is_focused
        return self.new_text() if left else None

    def new_text(self) -> str | None:
        """Return the text in the field if it differs from the displayed form of the value, otherwise None.

        Text and value cannot be compared directly, because the value has more digits than the field displays.
        """
        text = str(self.entry.get_text())
        return text if text != number_text(self.shown) else None

    def show(self, parameter: Parameter, force: bool, with_slider: bool) -> None:
        """Show another value. A number that is being typed and a slider that is being held do not change."""
        self.parameter = parameter
        if (number_text(parameter.value) == number_text(self.shown) and not force) or self.entry.is_focused:
            return
        self.entry.set_text(number_text(parameter.value))
        if with_slider and not self.grabbed:
            self.slider.set_current_value(parameter.share())
        self.shown = parameter.value

    def kill(self) -> None:
        """Remove the widgets."""
        self.slider.kill()
        self.entry.kill()
        if self.sweep is not None:
            self.sweep.kill()


def parameter_control(
    host: Host, rect: pygame.Rect, parameter: Parameter, y: float, sweep: Callable[[], None] | None = None
) -> Control:
    """Create the widgets of `parameter` in the panel `rect`, below the height `y`. If `sweep` is given, add a button
    for it.
    """
    unit, manager, left, right = host.unit, host.manager, rect.left, rect.right
    place = pygame.Rect(round(right - ENTRY * unit), round(y), round(ENTRY * unit), round(25 * unit))
    entry = TextEntry(place, manager, initial_text=number_text(parameter.value))
    wide = round(SWEEP * unit) if sweep else 0
    bar = pygame.Rect(left, round(y + 26 * unit), right - left - wide - round(4 * unit), round(12 * unit))
    button = None
    if sweep:
        tip = _("{name}: try nine values at once", name=_(parameter.name))
        # Make the button higher than the slider, because its text needs more height.
        top, foot = entry.rect.bottom, round(y + 39 * unit)
        place = pygame.Rect(right - wide, top, wide, foot - top)
        button = UIButton(place, "…", manager, object_id="#chip", tool_tip_text=tip, command=sweep)
    slider = Slider(bar, parameter.share(), (0.0, 1.0), manager)
    return Control(parameter, slider, entry, button, parameter.value)


def number_text(value: float) -> str:
    """Return a number as the text field displays it. NaN stands for several different values and gives an empty text."""
    return "" if math.isnan(value) else localized(f"{value:.5g}")
