"""The text and the source of a scene, in the panel where nothing is selected."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.languages import N_, _, scene_words
from softcradle.sandbox.session.session import Session

TIPS = N_("Click a bead or a contact to change it. Drag a bead and throw it. Space plays and pauses.")
CHANGED = N_("You have changed this scene: its text was written for other numbers. Play it and see.")


def paint_about(surface: pygame.Surface, rect: pygame.Rect, unit: float, session: Session) -> None:
    """Write as many lines into `rect` as there is room for; of a scene that was edited what it says is not shown."""
    scene, low = session.scene, float(rect.bottom)
    tips = wrapped(_(TIPS), 12.5 * unit, rect.width)
    if rect.height > 150 * unit:
        low -= (18 * len(tips) + 10) * unit
        for k, line in enumerate(tips):
            write(surface, line, (rect.left, low + (10 + 18 * k) * unit), 12.5 * unit, tones.muted)
    y = float(rect.top + 4 * unit)
    write(surface, _("About this scene"), (rect.left, y), 16 * unit, tones.foreground, bold=True)
    y += 27 * unit
    changed = session.edited
    lines = wrapped(_(CHANGED) if changed else scene_words(scene.text), 13 * unit, rect.width)
    room = max(0, int((low - y) // (18.5 * unit)))
    for k, line in enumerate(lines[:room]):
        more = k == room - 1 < len(lines) - 1
        text = shortened(f"{line} …", 13 * unit, rect.width) if more else line
        write(surface, text, (rect.left, y), 13 * unit, tones.foreground)
        y += 18.5 * unit
    for line in () if changed else wrapped(scene_words(scene.source), 12 * unit, rect.width)[:2]:
        if y + 23 * unit < low:
            write(surface, line, (rect.left, y + 6 * unit), 12 * unit, tones.muted)
            y += 17 * unit
