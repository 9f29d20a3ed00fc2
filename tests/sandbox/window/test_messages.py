"""Messages are for people: full folders, plain numbers, no name of Python."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pygame
from softcradle.sandbox.session.inputs import (
    Drag,
    Place,
    SetDrive,
    SetFriction,
    SetGap,
    SetMass,
    SetSlow,
    SetStep,
    SetVelocity,
)

from tests.helpers.windows import Driver

NAN, FAR, NEGATIVE = np.float64("nan"), np.float64(1e13), np.float64(-1.0)
REFUSED = (
    SetMass(0, 1, NEGATIVE),
    SetMass(0, 1, NAN),
    SetVelocity(0, 1, FAR),
    SetVelocity(0, 99, FAR),
    SetGap(0, 0, FAR),
    SetGap(0, 0, NEGATIVE),
    SetDrive(0, 0, NAN),
    SetFriction(0, NEGATIVE),
    SetStep(0, NEGATIVE),
    SetSlow(NEGATIVE),
    Place(0, 1, NAN),
    Drag(0, 99, FAR),
)
PYTHON = re.compile(r"float64|np\.|\w+\(|[a-z]_[a-z]|\w+Error|Traceback|<|None|\bself\b")


def test_a_refusal_is_one_sentence_without_names_of_python(driver: Driver) -> None:
    for item in REFUSED:
        assert not driver.page.editor.apply(item), item
        text = driver.messages[-1]
        assert not PYTHON.search(text), text
        assert "\n" not in text
        driver.app.messages.visible.clear()


def test_text_that_is_dropped_opens_as_a_scene(driver: Driver, tmp_path: Path) -> None:
    from softcradle.sandbox.session.export import shared_text

    driver.session.apply(SetMass(0, 1, 2.5))
    text = shared_text(driver.session.to_scene())
    driver.session.undo()
    pygame.event.post(pygame.Event(pygame.DROPTEXT, text=text))
    driver.frames(2)
    assert driver.session.lanes[0].chain.mass[1] == 2.5
