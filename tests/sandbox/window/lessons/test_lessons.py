"""The lessons: predicted, run, and answered by what was measured."""

from __future__ import annotations

import numpy as np
import pygame
import pytest
from softcradle.physics import power_law, simulate
from softcradle.sandbox.session.inputs import SetContact
from softcradle.sandbox.window.lessons.lesson_list import MEASURES, lessons

from softcradle import scenes
from tests.helpers.windows import Driver

pytestmark = pytest.mark.usefixtures("own_folder")
ANSWERS = (1, 1, 0, 1, 0)


def test_there_are_five_and_all_measures_are_used():
    assert len(lessons()) >= 5
    assert {lesson.measure for lesson in lessons()} == set(MEASURES)


@pytest.mark.parametrize(
    ("lesson", "answer"), list(zip(lessons(), ANSWERS, strict=True)), ids=lambda one: str(one)[:40]
)
def test_the_answer_is_that_of_an_accurate_run(lesson, answer):
    scene = scenes.load(lesson.scene)
    found = [simulate(lane.chain(), lane.velocity, scene.duration) for lane in scene.lanes]
    velocities = [(np.array(lane.velocity), run.final_velocity) for lane, run in zip(scene.lanes, found, strict=True)]
    assert lesson.answer(velocities) == answer


def test_a_lesson_is_predicted_run_and_answered(driver: Driver) -> None:
    for title in ("Not as you predicted", "As you predicted"):
        driver.key(pygame.K_q)
        driver.key(pygame.K_DOWN if title.startswith("As") else pygame.K_HOME)
        driver.key(pygame.K_RETURN)
        assert driver.session.playing
        for _ in range(900):
            driver.frames()
            if driver.app.dialog.open:
                break
        assert driver.app.dialog.title == title
        assert "Measured:" in driver.app.dialog.note
        driver.key(pygame.K_ESCAPE)


def test_a_scene_without_lessons_names_those_that_have_some() -> None:
    driver = Driver("mixed")
    driver.key(pygame.K_q)
    assert any("One bead on four" in text for text in driver.messages)
    driver.close()


def test_every_choice_has_a_reason_of_its_own():
    for lesson in lessons():
        assert len(set(lesson.why)) == len(lesson.choices)


def answered(driver: Driver) -> str:
    driver.key(pygame.K_q)
    driver.key(pygame.K_RETURN)
    for _ in range(1500):
        driver.frames()
        if driver.app.dialog.open:
            break
    return driver.app.dialog.note


def test_the_reason_is_of_what_was_measured_and_an_edited_scene_has_none(driver: Driver) -> None:
    assert "half the force" in answered(driver)
    driver.key(pygame.K_ESCAPE)
    driver.page.lessons._next = 0
    driver.page.editor.apply(SetContact(0, None, power_law(100.0, 1.0)))
    note = answered(driver)
    assert note == "Measured: the last bead alone."
