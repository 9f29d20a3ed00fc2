"""Event routing. Each event is offered to the window, the help, the messages, the dialog, the widgets and the page, in
this order.
"""

from __future__ import annotations

import math
from typing import Any

import pygame
import pygame_gui
from pygame_gui.core import UIElement
from pygame_gui.elements import UIButton, UIDropDownMenu, UITextEntryLine
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.window.keys import REPEATED, action_of
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.widgets import KEYS, PRESS, Slider

SCROLL = 60.0  # Scroll distance of the help in design pixels, for one notch of the wheel or one arrow key.
SCROLLING = {
    pygame.K_DOWN: SCROLL,
    pygame.K_UP: -SCROLL,
    pygame.K_PAGEDOWN: 6.0 * SCROLL,
    pygame.K_PAGEUP: -6.0 * SCROLL,
}
# Tolerance in pixels for finding a rebuilt control by its centre. A rebuilt control keeps the focus if its centre has
# moved less.
NEAR = 3.0
NOWHERE = (-1, -1)  # A position that lies on no widget.


class KeyboardFocus:
    """The control that receives keys. The focus is stored as a position on screen. A rebuilt control at the same
    position keeps the focus.
    """

    def __init__(self, host: Host) -> None:
        self.host = host
        self.place: tuple[int, int] | None = None  # Centre of the control that was reached with Tab.
        self.pressed = NOWHERE  # Position of the last mouse press. It is NOWHERE after the mouse has moved.

    def controls(self) -> list[UIElement]:
        """Return the enabled and visible controls, from top to bottom and from left to right."""
        kinds = (UIButton, Slider, UIDropDownMenu, UITextEntryLine)
        root: Any = self.host.manager.get_root_container()
        usable = [one for one in root.elements if isinstance(one, kinds) and one.visible and one.is_enabled]
        row = max(1.0, 20.0 * self.host.unit)
        return sorted(usable, key=lambda one: (one.rect.centery // row, one.rect.left))

    @property
    def control(self) -> UIElement | None:
        """The control that has the focus. A text field in use has priority over the control reached with Tab."""
        if self.typed is not None:
            return self.typed
        if self.place is None:
            return None
        return next((one for one in self.controls() if math.dist(one.rect.center, self.place) < NEAR), None)

    @property
    def typed(self) -> UIElement | None:
        """The text field in use, or None."""
        focused = self.host.manager.get_focus_set() or ()
        return next((one for one in focused if isinstance(one, UITextEntryLine)), None)

    def follow(self) -> None:
        """Drop the focus set with Tab if the user now types into another text field."""
        typed = self.typed
        if typed is not None and self.place is not None and math.dist(typed.rect.center, self.place) >= NEAR:
            self.place = None

    def move(self, by: int) -> None:
        """Move the focus to the next control (`by` is 1) or to the previous one (-1)."""
        controls, present = self.controls(), self.control
        if not controls:
            return
        k = controls.index(present) + by if present in controls else (0 if by > 0 else -1)
        chosen = controls[k % len(controls)]
        self.place = chosen.rect.center
        self.host.manager.set_focus_set({chosen} if isinstance(chosen, UITextEntryLine) else None)

    def handle(self, event: pygame.Event) -> bool:
        """Pass a pressed key to the control that has the focus. Return True if the control used it."""
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

    def hide_tooltips(self) -> None:
        """Remove all tooltips. A pressed control does not show its tooltip again while the mouse stays on it."""
        for one in self.controls():
            if one.rect.collidepoint(self.pressed):
                one.tool_tip_delay = math.inf
            if one.tool_tip is not None:
                one.tool_tip.kill()
                one.tool_tip = None

    def close_list(self) -> bool:
        """Close the open list of a drop-down menu. Return True if a list was open."""
        menus = [one for one in self.controls() if isinstance(one, UIDropDownMenu)]
        for menu in menus:
            if menu.current_state is menu.menu_states["expanded"]:
                menu.current_state.should_transition = True
                return True
        return False

    def _choose(self, menu: UIDropDownMenu, by: int) -> None:
        """Choose the next or previous entry of a drop-down menu."""
        names = [option[0] if isinstance(option, tuple) else option for option in menu.options_list]
        chosen = names[(names.index(menu.selected_option[0]) + by) % len(names)]
        event = {"text": chosen, "ui_element": menu, "ui_object_id": menu.most_specific_combined_id}
        menu.selected_option = (chosen, chosen)
        pygame.event.post(pygame.Event(pygame_gui.UI_DROP_DOWN_MENU_CHANGED, event))

    def paint(self, surface: pygame.Surface) -> None:
        """Draw a ring around the control that has the focus."""
        control = self.control
        if control is not None:
            pygame.draw.rect(surface, tones.foreground, control.rect.inflate(6, 6), 2, border_radius=6)


AWAY = frozenset((pygame.WINDOWMINIMIZED, pygame.WINDOWHIDDEN, pygame.WINDOWFOCUSLOST))
FOCUS = frozenset((pygame.WINDOWFOCUSGAINED, pygame.WINDOWFOCUSLOST))


class EventRouter:
    """Passes the events of a window to the part that handles them."""

    def __init__(self, app: Host) -> None:
        self.app = app
        self._held: set[int] = set()  # Keys that are down according to the events received.
        self._repeated = False  # True if the current event repeats a key that was already down.
        self._pressed = False  # True if the left button is down according to the events received.
        # Receiver of typed text at the moment when the current key was pressed.
        self._keyboard: tuple[object, ...] | None = None

    def take(self, event: pygame.Event) -> None:
        """Pass one event to the window, the help, the messages, or the page."""
        if event.type in AWAY or (event.type == pygame.MOUSEMOTION and self._pressed and not any(event.buttons)):
            self._let_go()
        if event.type in FOCUS:
            self._held.clear()
        if event.type == pygame.QUIT:
            self.app.act("quit")
        elif event.type in (pygame.WINDOWMINIMIZED, pygame.WINDOWHIDDEN):
            self.app.minimised = True
        elif event.type in (pygame.WINDOWRESTORED, pygame.WINDOWSHOWN, pygame.WINDOWMAXIMIZED):
            self.app.minimised = False
        elif event.type in (pygame.VIDEORESIZE, pygame.WINDOWSIZECHANGED):
            self.app.fit(pygame.display.get_surface())
        elif event.type == pygame.DROPFILE:
            if not self.app.page.take_file(event.file, pygame.mouse.get_pos()):
                self.app.open(event.file)
        elif event.type == pygame.DROPTEXT:
            self.app.open(event.text)
        else:
            self._take_input(event)

    def _take_input(self, event: pygame.Event) -> None:
        if event.type == pygame.KEYDOWN:
            self._repeated = event.key in self._held
            self._held.add(event.key)
            self._keyboard = self._typed_into
        elif event.type == pygame.KEYUP:
            self._held.discard(event.key)
            self._keyboard = None
        elif event.type == pygame.TEXTINPUT and self._keyboard not in (None, self._typed_into):
            # The key that typed this text has just opened the dialog or text field, so the text is not inserted.
            return
        if event.type == pygame.MOUSEBUTTONDOWN:
            self.app.focus.handle(event)
            self.app.focus.pressed = event.pos
            self.app.focus.hide_tooltips()
        elif event.type == pygame.MOUSEMOTION and math.dist(event.pos, self.app.focus.pressed) > NEAR:
            self.app.focus.pressed = NOWHERE
        if event.type in (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP) and event.button == 1:
            self._pressed = event.type == pygame.MOUSEBUTTONDOWN
        if self.app.help:
            self._take_in_help(event)
        elif not self.app.messages.handle(event):
            self._take_in_page(event)
        if event.type == pygame.MOUSEBUTTONUP and event.button == 1:
            self.app.page.let_go()

    @property
    def _typed_into(self) -> tuple[object, ...]:
        """The receiver of typed text: an open dialog or menu, and the text field in use."""
        dialog = self.app.dialog
        return (dialog if dialog is not None and dialog.open else None), self.app.focus.typed

    def _let_go(self) -> None:
        """Release a dragged object. This is necessary because a release outside the window sends no event."""
        if self._pressed:
            self._take_input(pygame.Event(pygame.MOUSEBUTTONUP, pos=NOWHERE, button=1))

    def _take_in_help(self, event: pygame.Event) -> None:
        if event.type == pygame.MOUSEBUTTONDOWN and event.button <= 3:  # Buttons 4 and 5 are the mouse wheel.
            self.app.help = False
        elif event.type == pygame.MOUSEWHEEL:
            self.app.help_scroll -= SCROLL * event.y * self.app.unit
        elif event.type == pygame.KEYDOWN and event.key in SCROLLING:
            self.app.help_scroll += SCROLLING[event.key] * self.app.unit
        elif event.type == pygame.KEYDOWN:
            action = action_of(event.key, event.mod, event.unicode)
            if action in ("help", "leave"):
                self.app.help = False
            elif action == "quit":
                self.app.act("quit")

    def _take_in_page(self, event: pygame.Event) -> None:
        if self.app.dialog is not None and self.app.dialog.open and self.app.dialog.handle(event):
            return
        if self.app.page.typing and event.type == pygame.KEYDOWN and event.key == pygame.K_TAB:
            if not self.app.page.handle(event):
                self.app.act(action_of(event.key, event.mod, event.unicode))
            return
        if event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE and self.app.focus.close_list():
            return
        if self.app.page.typing and event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE:
            self.app.page.cancel_typing()
            return
        if self.app.manager.process_events(event) or self.app.page.handle(event) or self.app.page.typing:
            return
        if event.type == pygame.KEYDOWN and not self.app.focus.handle(event):
            action = action_of(event.key, event.mod, event.unicode)
            if not self._repeated or action in REPEATED:
                self.app.act(action)
