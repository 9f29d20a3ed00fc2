"""The slider of the window: a click on its track moves the button there, and keys move it in steps."""

from __future__ import annotations

import pygame
from pygame_gui.elements import UIHorizontalSlider

STEP = 0.01  # of the range, for an arrow key
PAGE = 0.1  # of the range, for Page Up and Page Down
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
    """A slider from 0 to 1; its `name` is for screen readers."""

    name = ""

    def process_event(self, event: pygame.Event) -> bool:
        """A press on the track takes the button there; it can then be dragged on."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1 and self.is_enabled:
            button, point = self.sliding_button, self.ui_manager.calculate_scaled_mouse_position(event.pos)
            if button is not None and self.rect.collidepoint(point) and not button.rect.collidepoint(point):
                track = max(1, self.rect.width - button.rect.width)
                self._move_to((point[0] - self.rect.left - button.rect.width / 2) / track)
                button.hovered = True
                return bool(button.process_event(event))
        return bool(super().process_event(event))

    def move_by(self, step: float) -> None:
        """Move by a part of the range, as the arrow keys do."""
        self._move_to(self.get_current_value() + step)

    def _move_to(self, share: float) -> None:
        self.set_current_value(min(max(share, 0.0), 1.0), warn=False)
        self.rebuild_button()
        self._update_data_and_fire_events_when_moved()

    def rebuild_button(self) -> None:
        """Put the button where the value is, at once."""
        self.scroll_position = round(self.current_percentage * self.scrollable_width)
        if self.sliding_button is not None:
            self.sliding_button.set_relative_position((self.scroll_position + self.arrow_button_width, 0))
