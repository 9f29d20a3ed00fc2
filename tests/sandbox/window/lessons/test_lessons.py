"""Tests of the lessons. The user predicts the outcome of a collision, runs it, and compares the prediction with
measured values.
"""

import pygame
import pytest
from softcradle.physics import power_law, simulate
from softcradle.sandbox.session.inputs import SetContact, SetVelocity
from softcradle.sandbox.session.summary_text import outcome_text
from softcradle.sandbox.story.lane_story import story_of
from softcradle.sandbox.window.lessons.runner import lessons
from softcradle.sandbox.window.plots.scales import motions_ahead

from softcradle import scenes
from tests.helpers.drawn_text import film_texts
from tests.helpers.windows import Driver

ANSWERS = (1, 1, 0, 1, 0)


@pytest.mark.parametrize(("lesson", "answer"), [*zip(lessons(), ANSWERS, strict=True)], ids=lambda one: str(one)[:40])
def test_the_answer_is_that_of_an_accurate_run(lesson, answer):
    scene = scenes.load(lesson.scene)
    found = [simulate(lane.chain(), lane.velocity, scene.duration) for lane in scene.lanes]
    assert lesson.answer([story_of(run).outcome for run in found]) == answer


def answered(driver: Driver, *choices: int) -> str:
    """Click the given answers in the panel of the lesson and return the verdict that is shown after the run."""
    driver.key(pygame.K_q)
    for choice in choices:
        panel = driver.page.explore if driver.app.explore else driver.page.inspector
        driver.click(panel.choices[choice].center)
    assert driver.page.clock.activity() != "paused"
    driver.until(lambda: driver.page.outcome.text, 1500)
    said = driver.page.outcome.text
    driver.key(pygame.K_ESCAPE)
    return said


@pytest.mark.parametrize("lab", [False, True], ids=["explore", "lab"])
def test_both_questions_are_asked_next_to_the_beads_before_the_run(lab: bool) -> None:
    driver = Driver("one-on-four", lab=lab)
    panel = driver.page.inspector if lab else driver.page.explore
    assert "What do you predict? 1/2" in driver.said()
    driver.click(panel.choices[0].center)
    assert "what does the bead that hit the row do" in driver.said()
    assert (driver.session.frame, driver.page.clock.activity()) == (0, "paused")
    driver.click(panel.choices[1].center)
    assert driver.page.clock.activity() == "playing"
    driver.until(lambda: driver.page.outcome.text, 1500)
    said = driver.page.outcome.text
    assert said.startswith(
        "You predicted: the last bead alone. What happened: most of them, nearly together. As you predicted"
    )
    assert outcome_text(driver.session) in said
    assert driver.app.dialog is None, "nothing covers the beads"
    assert "3/5 of its speed" in " ".join(driver.page.lessons.explanations)


def test_the_choices_are_clicked_without_a_key(driver: Driver) -> None:
    driver.play_to_the_end()
    assert not driver.page.inspector.choices
    driver.app.act("lesson")  # The menu of the window contains the action "lesson".
    driver.frames(2)
    assert driver.session.frame == 0
    assert len(driver.page.inspector.choices) == 3


def test_a_lesson_is_predicted_run_and_answered(driver: Driver) -> None:
    said = answered(driver, 1, 2)
    assert said.startswith(
        "As you predicted: most of them, nearly together. You predicted: it goes on slowly. What happened:"
    )
    driver.page.editor.apply(SetContact(0, None, power_law(100.0, 1.0)))
    said = answered(driver, 0, 1)
    assert said.startswith("You predicted: the last bead alone. You predicted: it bounces back.")
    assert said.endswith(outcome_text(driver.session))


def test_questions_are_asked_in_dialogs_if_the_panel_has_no_space() -> None:
    driver = Driver("one-on-four", lab=False)
    driver.key(pygame.K_i)  # The key I hides the panel.
    driver.key(pygame.K_q)
    for choice in (1, 2):
        assert driver.app.dialog.focus == -1  # The dialog opens without a marked answer.
        driver.key(pygame.K_RETURN)
        assert driver.app.dialog.open
        driver.key(pygame.K_DOWN, times=choice)
        driver.key(pygame.K_RETURN)
    assert driver.page.clock.activity() == "playing"


def test_a_lesson_whose_choices_are_all_wrong_is_answered_in_words() -> None:
    driver = Driver("locked-pistons")
    driver.select("contact", 1)
    # After the edit, the beads do not leave together in either of the two rows.
    driver.key(pygame.K_l, pygame.KMOD_SHIFT)
    driver.key(pygame.K_ESCAPE)
    assert answered(driver, 2).startswith("You predicted: in both.")


@pytest.mark.parametrize("whole", [True, False], ids=["asked while it runs", "asked at its end"])
def test_a_question_over_a_replay_is_answered_by_it(driver: Driver, tmp_path, whole: bool) -> None:
    driver.key(pygame.K_SPACE)
    driver.until(lambda: driver.page.outcome.text if whole else driver.session.lanes[0].over, 900)
    driver.session.pause()
    driver.page.dialogs.save("save_session", "played")
    driver.drop_file(tmp_path / "played.npz")
    driver.until(lambda: driver.session.frame > 20 if whole else driver.page.replay.done, 900)
    assert answered(driver, 0, 1).startswith("You predicted: the last bead alone. What happened: most of them")
    driver.until(lambda: driver.page.replay.done, 900)
    assert "agrees" in driver.page.replay.sentence


def test_a_scene_without_lessons_names_those_that_have_some() -> None:
    driver = Driver("mixed")
    driver.key(pygame.K_q)
    assert any("One bead on four" in text for text in driver.messages)


@pytest.mark.parametrize("lab", [False, True], ids=["explore", "lab"])
def test_the_text_of_a_scene_appears_after_its_question(lab: bool) -> None:
    driver = Driver("one-on-four", lab=lab)
    assert "Which beads leave on the right?" in driver.said()
    assert "not quite rigid" not in driver.said()
    driver.key(pygame.K_SPACE)
    driver.until(lambda: driver.page.lessons.answered)
    assert "not quite rigid" in driver.said()
    driver.key(pygame.K_r)
    # The text that reveals the answer stays visible after a restart, because the question has been answered.
    assert "not quite rigid" in driver.said()
    before = driver.page.view.backdrop.version
    driver.page.editor.apply(SetVelocity(0, 0, 0.7))
    driver.frames(2)
    assert driver.page.view.backdrop.version == before + 1
    assert "not quite rigid" not in driver.said()
    assert "You changed this scene" in driver.said()


@pytest.mark.parametrize(
    ("last", "more"),
    [("duration = 0.5", "drive = [1.0, 0, 0]"), ('text = "They go."', "friction = 0.3")],
    ids=["goes on", "rests"],
)
def test_a_question_is_answered_if_the_beads_never_separate(tmp_path, last, more) -> None:
    lane = f'[[lanes]]\nvelocity = [1.0, 0, 0]\ncontact = {{law = "power_law", f0 = 9.0, alpha = 0.1}}\n{more}'
    file = tmp_path / "asked.toml"
    file.write_text(f'title = "T"\nquestion = "Who goes?"\n{last}\n{lane}')
    driver = Driver(str(file))
    driver.key(pygame.K_q)
    driver.type("all")
    driver.key(pygame.K_RETURN)
    driver.until(lambda: driver.page.outcome.text or driver.app.dialog.open, most=2000)
    said = driver.page.outcome.text or driver.app.dialog.note
    assert said.startswith("You predicted: all. ") or said.startswith("You predicted: all.\n")
    assert driver.session.playing == ("drive" in more)
    lane = driver.session.lanes[0]
    assert driver.session.time == pytest.approx(0.5, abs=0.02) if lane.chain.driven else not lane.velocity.any()


def test_texts_of_a_user_appear_in_all_outputs(driver, tmp_path) -> None:
    driver.click(driver.bead(1))
    driver.key(pygame.K_a)
    driver.session.step_frames(100)
    driver.key(pygame.K_F4)
    for text in ("Five at rest", "They all go.", "Who goes?", "my row"):
        driver.app.dialog.entry.set_text(text)
        driver.key(pygame.K_TAB)
    driver.key(pygame.K_RETURN)
    scene = driver.session.scene
    assert (scene.title, scene.text) == ("Five at rest", "They all go.")
    assert (scene.question, scene.lanes[0].label) == ("Who goes?", "my row")
    # Changing the texts keeps the edited beads and the current frame.
    assert (driver.session.lanes[0].chain.contacts, driver.session.frame) == (5, 100)
    assert driver.page.unsaved
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert (driver.session.scene.title, driver.session.frame) == ("One bead on four", 100)
    assert "Five at rest" not in driver.said()
    driver.key(pygame.K_y, pygame.KMOD_CTRL)
    assert driver.session.scene == scene
    driver.page.dialogs.save("save_scene", "mine")
    assert scenes.load(str(tmp_path / "mine.toml")) == scene
    driver.key(pygame.K_ESCAPE)  # Escape clears the selection, so the panel shows the question.
    assert "Who goes?" in driver.said()
    assert "They all go." not in driver.said()
    driver.page.dialogs.save("share_page", "mine")
    assert "Who goes?" in (tmp_path / "mine.html").read_text(encoding="utf-8")
    written = film_texts(scene, motions_ahead(scene), (1280, 720), [0])
    assert any("Who goes?" in one.text for texts in written for one in texts)
    driver.key(pygame.K_q)
    driver.type("all")
    driver.key(pygame.K_RETURN)
    driver.until(lambda: driver.page.outcome.text)
    assert driver.page.outcome.text.startswith("You predicted: all. ")
    driver.key(pygame.K_ESCAPE)
    assert "They all go." in driver.said()


def test_a_text_is_typed_in_several_lines_and_kept_as_one(driver: Driver) -> None:
    driver.key(pygame.K_F4)
    driver.key(pygame.K_RETURN)
    assert not driver.page.unsaved  # The dialog was closed without typing, so nothing is unsaved.
    assert not driver.page.toolbar.buttons["undo"].is_enabled
    driver.key(pygame.K_F4)
    box = driver.app.dialog.entries["text"]
    assert len(box.text_box_layout.layout_rows) > 2
    assert box.rect.height > 2 * driver.app.dialog.entries["title"].rect.height
    driver.key(pygame.K_TAB)
    driver.type(" All")
    box.set_text(f"{box.get_text()}\ngo.")
    before = driver.session.scene.text
    driver.key(pygame.K_RETURN)
    assert driver.session.scene.text == f"{before} All go."
    assert driver.page.toolbar.buttons["undo"].is_enabled
