"""The control of a parameter: a slider, and a box in which its number is shown and typed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pygame
from pygame_gui.elements import UIButton
from softcradle.sandbox.languages import _, localized
from softcradle.sandbox.window.scene.editable_parameters import Parameter
from softcradle.sandbox.window.slider import Slider
from softcradle.sandbox.window.text_entry import TextEntry
from softcradle.sandbox.window.window_page import Host

ENTRY = 92.0  # design pixels of the box
SWEEP = 26.0  # design pixels of the button for a sweep


@dataclass
class Control:
    """The widgets of one parameter.

    Attributes:
        shown: the value in the box.
        typed: whether the box had the focus in the last frame.
    """

    parameter: Parameter
    slider: Slider
    entry: TextEntry
    sweep: UIButton | None
    shown: float
    typed: bool = False

    @property
    def grabbed(self) -> bool:
        """Whether the slider is held."""
        return bool(self.slider.sliding_button is not None and self.slider.sliding_button.held)

    def left_text(self) -> str | None:
        """What was typed into the box, if it has been left since the last frame and shows another number."""
        left, self.typed = self.typed and not self.entry.is_focused, self.entry.is_focused
        text = str(self.entry.get_text())
        return text if left and text != number_text(self.shown) else None

    def show(self, parameter: Parameter, force: bool, with_slider: bool) -> None:
        """Show another value; a number that is being typed, and a slider that is held, are left as they are."""
        self.parameter = parameter
        if (parameter.value == self.shown and not force) or self.entry.is_focused:
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
    """The widgets of `parameter` in the panel `rect`, from the height `y` on; `sweep` is done by a button of its own, if any."""
    unit, manager, left, right = host.unit, host.manager, rect.left, rect.right
    place = pygame.Rect(round(right - ENTRY * unit), round(y), round(ENTRY * unit), round(25 * unit))
    entry = TextEntry(place, manager, initial_text=number_text(parameter.value))
    wide = round(SWEEP * unit) if sweep else 0
    bar = pygame.Rect(left, round(y + 26 * unit), right - left - wide - round(4 * unit), round(12 * unit))
    button = None
    if sweep:
        tip = _("{name}: nine values side by side", name=_(parameter.name))
        place = pygame.Rect(right - wide, bar.top, wide, bar.height)
        button = UIButton(place, "…", manager, object_id="#chip", tool_tip_text=tip, command=sweep)
    slider = Slider(bar, parameter.share(), (0.0, 1.0), manager)
    slider.name = entry.name = f"{_(parameter.name)} {parameter.unit}".strip()
    return Control(parameter, slider, entry, button, parameter.value)


def number_text(value: float) -> str:
    """A number as the box shows it."""
    return localized(f"{value:.5g}")
