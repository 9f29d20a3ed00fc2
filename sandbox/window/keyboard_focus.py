"""The keyboard focus: Tab goes over every control of the page, Enter and Space press it, arrows move sliders and menus."""

from __future__ import annotations

import math
from typing import Any

import pygame
import pygame_gui
from pygame_gui.core import UIElement
from pygame_gui.elements import UIButton, UIDropDownMenu, UITextEntryLine
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.window.slider import KEYS, Slider
from softcradle.sandbox.window.window_page import Host

NEAR = 3.0  # pixels: a control that is made anew has its middle so near to the old one
PRESS = (pygame.K_RETURN, pygame.K_KP_ENTER, pygame.K_SPACE)


class KeyboardFocus:
    """Which control keys go to; widgets that are made anew at the same place keep it."""

    def __init__(self, host: Host) -> None:
        self.host = host
        self.place: tuple[int, int] | None = None  # the middle of the control

    def controls(self) -> list[UIElement]:
        """Every control that can be used, from top to bottom and left to right."""
        kinds = (UIButton, Slider, UIDropDownMenu, UITextEntryLine)
        root: Any = self.host.manager.get_root_container()
        usable = [one for one in root.elements if isinstance(one, kinds) and one.visible and one.is_enabled]
        row = max(1.0, 20.0 * self.host.unit)
        return sorted(usable, key=lambda one: (one.rect.centery // row, one.rect.left))

    @property
    def control(self) -> UIElement | None:
        """The control that has the focus: a line in which is being typed, wherever Tab has been."""
        if self.typed is not None:
            return self.typed
        if self.place is None:
            return None
        return next((one for one in self.controls() if math.dist(one.rect.center, self.place) < NEAR), None)

    @property
    def typed(self) -> UIElement | None:
        """The line in which is being typed."""
        focused = self.host.manager.get_focus_set() or ()
        return next((one for one in focused if isinstance(one, UITextEntryLine)), None)

    def follow(self) -> None:
        """Leave the control that Tab has reached where something else is being typed in."""
        typed = self.typed
        if typed is not None and self.place is not None and math.dist(typed.rect.center, self.place) >= NEAR:
            self.place = None

    def move(self, by: int) -> None:
        """Go to the next control (1) or the one before (-1)."""
        controls, present = self.controls(), self.control
        if not controls:
            return
        k = controls.index(present) + by if present in controls else (0 if by > 0 else -1)
        chosen = controls[k % len(controls)]
        self.place = chosen.rect.center
        self.host.manager.set_focus_set({chosen} if isinstance(chosen, UITextEntryLine) else None)

    def handle(self, event: pygame.Event) -> bool:
        """Give a key to the control; whether it took it."""
        control = self.control
        if event.type == pygame.MOUSEBUTTONDOWN:
            self.place = None
        if control is None or event.type != pygame.KEYDOWN:
            return False
        if event.key == pygame.K_ESCAPE:
            self.place = None
        elif isinstance(control, UIButton) and event.key in PRESS:
            control.on_self_event(pygame_gui.UI_BUTTON_PRESSED, {"mouse_button": 1})
        elif isinstance(control, Slider) and event.key in KEYS:
            control.move_by(KEYS[event.key])
        elif isinstance(control, UIDropDownMenu) and event.key in (pygame.K_UP, pygame.K_DOWN):
            self._choose(control, 1 if event.key == pygame.K_DOWN else -1)
        else:
            return False
        return True

    def hide_tooltip(self, point: tuple[int, int]) -> None:
        """Take away what the control at `point` says of itself: it is pressed, so that is known."""
        for one in self.controls():
            if one.rect.collidepoint(point):
                one.tool_tip_delay = math.inf
                if one.tool_tip is not None:
                    one.tool_tip.kill()
                    one.tool_tip = None

    def close_list(self) -> bool:
        """Close the list of a menu; whether one was open."""
        menus = [one for one in self.controls() if isinstance(one, UIDropDownMenu)]
        for menu in menus:
            if menu.current_state is menu.menu_states["expanded"]:
                menu.current_state.should_transition = True
                return True
        return False

    def _choose(self, menu: UIDropDownMenu, by: int) -> None:
        """Choose the next entry of a menu."""
        names = [option[0] if isinstance(option, tuple) else option for option in menu.options_list]
        chosen = names[(names.index(menu.selected_option[0]) + by) % len(names)]
        event = {"text": chosen, "ui_element": menu, "ui_object_id": menu.most_specific_combined_id}
        menu.selected_option = (chosen, chosen)
        pygame.event.post(pygame.Event(pygame_gui.UI_DROP_DOWN_MENU_CHANGED, event))

    def paint(self, surface: pygame.Surface) -> None:
        """Draw a ring about the control."""
        control = self.control
        if control is not None:
            pygame.draw.rect(surface, tones.foreground, control.rect.inflate(6, 6), 2, border_radius=6)
