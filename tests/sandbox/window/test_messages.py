"""Messages are for people: full folders, plain numbers, no name of Python."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pygame
import pytest
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


@pytest.mark.parametrize("start", ["one-on-four", "hanging-cradle"])
@pytest.mark.parametrize(("scale", "text"), [(1.0, "short"), (1.0, "word " * 60), (2.0, "word " * 12)])
def test_messages_lie_on_neither_plots_nor_beads_nor_controls(start: str, scale: float, text: str) -> None:
    driver = Driver(start)
    driver.app.scale = scale
    driver.app.rebuild()
    for number in range(3):
        driver.app.messages.show(f"{number} {text}")
    driver.frames(2)
    page = driver.app.page
    footer = page.view.places.footer if start == "one-on-four" else page.places.footer
    places = driver.app.messages._places
    assert "2 " in places[0][1].text
    for rect, _message in places[: 1 if len(text) > 100 else None]:
        assert footer.top - 60 * driver.app.unit * (len(text) > 100) <= rect.top
        assert rect.bottom <= footer.bottom
        assert not any(rect.colliderect(one.rect) for one in page.time_controls.buttons.values())
