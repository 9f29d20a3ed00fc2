"""The routing of events: to the window, the help, the messages, the dialog, the widgets or the page, in this order."""

from __future__ import annotations

import pygame
from softcradle.sandbox.window.keys import REPEATED, action_of
from softcradle.sandbox.window.window_page import Window

AWAY = frozenset((pygame.WINDOWMINIMIZED, pygame.WINDOWHIDDEN, pygame.WINDOWFOCUSLOST))
FOCUS = frozenset((pygame.WINDOWFOCUSGAINED, pygame.WINDOWFOCUSLOST))
NOWHERE = (-1, -1)  # a place on no widget


class EventRouter:
    """Passes the events of a window on."""

    def __init__(self, app: Window) -> None:
        self.app = app
        self._held: set[int] = set()  # keys that are down, as far as events tell
        self._repeated = False  # whether the key of the present event was down already
        self._pressed = False  # whether the left button is down, as far as events tell
        self._keyboard: tuple[object, ...] | None = None  # what had the keyboard when the key that is down went down

    def take(self, event: pygame.Event) -> None:
        """Pass one event on: to the window, the help, the messages, or the page."""
        if event.type in AWAY or (event.type == pygame.MOUSEMOTION and self._pressed and not any(event.buttons)):
            self._let_go()
        if event.type in FOCUS:
            self._held.clear()
            self.app.reader.take_focus(event.type == pygame.WINDOWFOCUSGAINED)
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
            return  # its key has opened what would take it
        if event.type == pygame.MOUSEBUTTONDOWN:
            self.app.focus.handle(event)
            self.app.focus.hide_tooltip(event.pos)
        if event.type in (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP) and event.button == 1:
            self._pressed = event.type == pygame.MOUSEBUTTONDOWN
        if self.app.help:
            self._take_in_help(event)
        elif not self.app.messages.handle(event):
            self._take_in_page(event)

    @property
    def _typed_into(self) -> tuple[object, ...]:
        """What keys go to: a dialog or menu, a line of the page, or the page."""
        dialog = self.app.dialog
        return (dialog if dialog is not None and dialog.open else None), self.app.focus.typed

    def _let_go(self) -> None:
        """Let go of what is dragged: the button may be let go where no event tells."""
        if self._pressed:
            self._take_input(pygame.Event(pygame.MOUSEBUTTONUP, pos=NOWHERE, button=1))

    def _take_in_help(self, event: pygame.Event) -> None:
        if event.type == pygame.MOUSEBUTTONDOWN:
            self.app.help = False
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
