"""The text and the source of a scene, in the panel where nothing is selected."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import wrapped, write
from softcradle.sandbox.languages import N_, _, scene_words
from softcradle.scenes import Scene

TIPS = N_("Click a bead or a contact to change it. Drag a bead and throw it. Space plays and pauses.")


def paint_about(surface: pygame.Surface, rect: pygame.Rect, unit: float, scene: Scene) -> None:
    """Write as much into `rect` as there is room for."""
    y = float(rect.top + 4 * unit)
    write(surface, _("About this scene"), (rect.left, y), 16 * unit, tones.foreground, bold=True)
    y += 27 * unit
    for line in wrapped(scene_words(scene.text), 13 * unit, rect.width):
        if y > rect.bottom - 80 * unit:
            break
        write(surface, line, (rect.left, y), 13 * unit, tones.foreground)
        y += 18.5 * unit
    y += 6 * unit
    for line in wrapped(scene_words(scene.source), 12 * unit, rect.width)[:2]:
        write(surface, line, (rect.left, y), 12 * unit, tones.muted)
        y += 17 * unit
    y = max(y + 12 * unit, rect.bottom - 66 * unit)
    for line in wrapped(_(TIPS), 12.5 * unit, rect.width):
        write(surface, line, (rect.left, y), 12.5 * unit, tones.muted)
        y += 18 * unit
