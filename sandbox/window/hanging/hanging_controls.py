"""The controls of the hanging cradle: the scrub bar, the buttons of time with the slow motion, and the menus of the panel."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import pygame
import pygame_gui
from pygame_gui.elements import UIDropDownMenu
from softcradle.sandbox.draw.number_format import fixed
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.languages import N_, _, pgettext
from softcradle.sandbox.window.hanging.hanging_cradle import BALLS, LAWS, METHODS
from softcradle.sandbox.window.hanging.hanging_model import FRAME, RATES, HangingModel
from softcradle.sandbox.window.scene.time_controls import paint_icons, speed_text, time_buttons
from softcradle.sandbox.window.scrub_bar import ScrubBar
from softcradle.sandbox.window.slider import Slider
from softcradle.sandbox.window.window_page import Host

LEAST_FRAMES = round(10.0 / FRAME)  # that the scrub bar stands for at first
SLOW_MOTIONS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
MENU_ROW = 34.0  # design pixels of a menu in the panel
MENU = 166.0  # design pixels, the width of a menu
# Of each menu: the field of the model, its name, and the choices.
MENUS: tuple[tuple[str, str, Sequence[str]], ...] = (
    ("method", N_("method"), METHODS),
    ("law", N_("contacts"), tuple(LAWS)),
    ("rate", N_("steps a second"), tuple(map(str, RATES))),
    ("lifted", N_("balls lifted"), tuple(str(k) for k in range(1, BALLS))),
)


class HangingScrubBar(ScrubBar):
    """The scrub bar over the frames of a model."""

    def __init__(self, model: HangingModel) -> None:
        super().__init__(LEAST_FRAMES)
        self.model = model

    @property
    def bounds(self) -> tuple[int, int]:
        """See `ScrubBar.bounds`."""
        return self.model.dropped, self.model.dropped + len(self.model.frames) - 1

    @property
    def shown(self) -> int:
        """See `ScrubBar.shown`."""
        return self.model.dropped + self.model.shown

    def scrub(self, frame: int) -> None:
        """See `ScrubBar.scrub`."""
        self.model.scrub(frame - self.model.dropped)

    def time_of(self, frame: int) -> float:
        """See `ScrubBar.time_of`."""
        return self.model.frames[frame - self.model.dropped].time


class HangingControls:
    """The widgets of the page, apart from the toolbar.

    Attributes:
        slow: wall seconds for one of the model, of SLOW_MOTIONS.
        menus: those of the panel, by field of the model.
    """

    def __init__(self, host: Host, actions: Mapping[str, Callable[[], None]]) -> None:
        self.host, self.actions, self.slow = host, actions, 1.0
        self.menus: dict[str, UIDropDownMenu] = {}
        self.labels: list[tuple[str, int, int]] = []

    def build(self, row: pygame.Rect, panel: pygame.Rect, model: HangingModel) -> int:
        """Make the widgets in the `row` of time and at the top of the `panel`; returns where the rest of it begins."""
        unit = self.host.unit
        self.row = row
        self.buttons = time_buttons(self.host, row, self.actions)
        left = max(button.rect.right for button in self.buttons.values()) + round(19 * unit)
        place = pygame.Rect(left, row.centery + round(2 * unit), round(190 * unit), round(14 * unit))
        self.slider = Slider(place, self._share(), (0.0, 1.0), self.host.manager)
        self.slider.name = _("slow motion")
        self.clock_left = place.right + round(22 * unit)
        self.menus, self.labels, y = {}, [], panel.top
        for field, name, choices in MENUS:
            wide = round(MENU * unit)
            place = pygame.Rect(panel.right - wide, y, wide, round(27 * unit))
            present = _shown(str(getattr(model, field)))
            self.menus[field] = UIDropDownMenu([*map(_shown, choices)], present, place, self.host.manager)
            self.labels.append((_(name), panel.left, place.centery))
            y += round(MENU_ROW * unit)
        return y

    def _share(self) -> float:
        return SLOW_MOTIONS.index(self.slow) / (len(SLOW_MOTIONS) - 1)

    def step_slow(self, by: int) -> None:
        """The next of SLOW_MOTIONS: slower (1) or faster (-1)."""
        place = min(max(SLOW_MOTIONS.index(self.slow) + by, 0), len(SLOW_MOTIONS) - 1)
        self.slow = SLOW_MOTIONS[place]
        self.slider.set_current_value(self._share())

    def handle(self, event: pygame.Event, model: HangingModel) -> HangingModel | None:
        """Take an event of the slider or a menu; the model that a choice asks for."""
        if event.type == pygame_gui.UI_HORIZONTAL_SLIDER_MOVED and event.ui_element is self.slider:
            self.slow = SLOW_MOTIONS[round(event.value * (len(SLOW_MOTIONS) - 1))]
        if event.type == pygame_gui.UI_DROP_DOWN_MENU_CHANGED:
            for field, _name, choices in MENUS:
                if event.ui_element is self.menus[field]:
                    kind, chosen = (
                        type(getattr(model, field)),
                        {_shown(choice): choice for choice in choices}[event.text],
                    )
                    return model.with_choice(**{field: kind(chosen)})
        return None

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the names of the menus."""
        for name, x, y in self.labels:
            write(surface, name, (x, y), 13 * self.host.unit, tones.foreground, align=(0, 0.5))

    def paint_over(self, surface: pygame.Surface, model: HangingModel, activity: str) -> None:
        """Draw icons, slow motion and clock."""
        unit, middle = self.host.unit, self.row.centery
        paint_icons(surface, self.buttons, activity == "playing", unit)
        write(surface, speed_text(self.slow), (self.slider.rect.left, middle - 17 * unit), 13 * unit, tones.foreground)
        place = (self.clock_left, middle - 17 * unit)
        write(surface, f"t = {fixed(model.time, 2)} s", place, 16 * unit, tones.foreground, bold=True)
        state = _("looking back") if model.scrubbed else _(activity)
        write(surface, state, (self.clock_left, middle + 4 * unit), 12 * unit, tones.muted)


def _shown(choice: str) -> str:
    """A choice in the language in use."""
    return pgettext("button", choice)
