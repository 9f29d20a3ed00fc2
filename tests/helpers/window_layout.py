"""What is wrong with the layout of the window's widgets: one leaves the window, lies on another, or clips its text."""

import itertools

import pygame
from pygame_gui.core import UIElement
from pygame_gui.elements import UIButton, UIDropDownMenu, UITextEntryLine, UITooltip
from softcradle.sandbox.window.widgets import Slider

from tests.helpers.windows import Driver


def widgets(driver: Driver) -> list[UIElement]:
    """The widgets of the page, or of the dialog where there is one."""
    dialog = driver.app.dialog
    if dialog is not None and dialog.open:
        found = dialog.manager.get_root_container().elements
        return [one for one in found if one.visible and isinstance(one, UIButton | UITextEntryLine)]
    shown = [one for one in driver.app.manager.get_root_container().elements if one.visible]
    own = [one.button_container for one in shown if isinstance(one, Slider)]
    return [one for one in shown if one not in own and one not in floating(shown)]


def floating(shown: list[UIElement]) -> list[UIElement]:
    """What lies on other widgets on purpose: tooltips, and the lists of menus that are unfolded."""
    tips = [one for one in shown if isinstance(one, UITooltip)]
    menus = [one.menu_states["expanded"] for one in shown if isinstance(one, UIDropDownMenu)]
    lists = [menu.options_selection_list for menu in menus if menu.options_selection_list is not None]
    inside = [one.item_list_container for one in lists]
    return [*tips, *(tip.text_block for tip in tips), *lists, *inside]


def faults(driver: Driver) -> list[str]:
    """What is wrong with the page that is shown."""
    window = pygame.Rect((0, 0), driver.app.size)
    found = []
    shown = widgets(driver)
    for one in shown:
        if not window.contains(one.rect):
            found.append(f"{widget_name(one)} leaves the window: {one.rect}")
        if isinstance(one, UIButton) and one.text and one.tool_tip_text is None and _clipped(one):
            found.append(f"the text of {widget_name(one)} is clipped")
    for one, other in itertools.combinations(shown, 2):
        if one.rect.colliderect(other.rect):
            found.append(f"{widget_name(one)} {one.rect} overlaps {widget_name(other)} {other.rect}")
    return found


def widget_name(one: UIElement) -> str:
    """Its class and its text."""
    return f"{type(one).__name__} {getattr(one, 'text', '')!r}"


def _clipped(button: UIButton) -> bool:
    return button.font.get_rect(button.text).width > button.rect.width
