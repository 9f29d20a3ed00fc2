"""Tests of the view with few controls and of the comparison with steel balls.

The tests also check the description and the explanation after a motion.
"""

import math
import re
from dataclasses import replace

import pygame
import pytest
from softcradle.physics import power_law
from softcradle.sandbox.session.contact_conversion import impact_energy
from softcradle.sandbox.session.history_slices import last_slice
from softcradle.sandbox.session.inputs import SetMass
from softcradle.sandbox.session.lane_setup import FRAME_RATE
from softcradle.sandbox.story.numbers import MINUS
from softcradle.sandbox.window.plots.kinds import PLOT_KINDS
from softcradle.sandbox.window.scene.editor import Pick

from softcradle import scenes
from tests.helpers.drawn_text import drawn_texts
from tests.helpers.windows import Driver

MOST_CONTROLS = 20


@pytest.fixture
def explorer() -> Driver:
    return Driver("one-on-four", lab=False)


def press(driver: Driver, text: str) -> None:
    driver.click(next(one for one in driver.page.explore.buttons if one.text == text).rect.center)


def laws(driver: Driver, lane: int = 0) -> list:
    return list(driver.session.lanes[lane].chain.contact)


def test_few_controls_are_shown_until_the_lab_is_opened(explorer: Driver) -> None:
    assert len(explorer.app.focus.controls()) <= MOST_CONTROLS
    places = explorer.page.view.places
    assert places.lanes[0].height > 0.45 * explorer.app.size[1]
    assert [len(row) for row in places.plots] == [1]
    assert not places.insets.height
    for level in ("good", "bad"):  # The verdict is shown as a sentence only if it is not "good".
        state = replace(explorer.session.health(0), level=level, sentence="beads are off")
        explorer.page.explore.health = lambda found=state: [found]
        assert ("beads are off" in explorer.said()) == (level == "bad")
    explorer.click(explorer.page.toolbar.buttons["level"].rect.center)
    assert explorer.page.cards.menus
    assert not explorer.page.explore.controls
    assert {"share", "plots_menu", "tools"} < explorer.page.toolbar.buttons.keys()
    explorer.close()
    explorer.app = Driver("one-on-four", lab=False).app
    assert explorer.page.cards.menus
    explorer.key(pygame.K_F3)
    assert explorer.page.explore.controls
    explorer.key(pygame.K_F7)  # The view with few controls has a key for this menu, but not a button.
    assert explorer.app.dialog.names[0] in PLOT_KINDS


def test_alpha_is_set_for_the_row_or_a_selected_contact(explorer: Driver) -> None:
    lane = explorer.session.lanes[0]
    before = impact_energy(lane.chain, 1, lane.setup.speed)
    explorer.run(60)
    explorer.enter("alpha", "1")
    assert explorer.session.playing  # After the edit, the motion starts again.
    assert explorer.session.frame < 60
    assert [law.exponent for law in laws(explorer)] == [1.0] * 4
    lane = explorer.session.lanes[0]
    assert impact_energy(lane.chain, 1, lane.setup.speed) == pytest.approx(before)
    explorer.key(pygame.K_z, pygame.KMOD_CTRL)
    assert laws(explorer) == [power_law(1.0, 0.1)] * 4
    explorer.click(explorer.page.view.lanes[0].handles()[1])
    assert explorer.page.editor.selection == Pick(0, "contact", 1)
    explorer.enter("alpha", "0.5")
    assert [law.exponent for law in laws(explorer)] == [0.1, 0.5, 0.1, 0.1]
    explorer.key(pygame.K_ESCAPE)
    explorer.frames(2)
    assert explorer.page.explore.controls["alpha"].entry.get_text() == "", "contacts differ"
    before = laws(explorer)
    for alpha in ("1000", "1e-9"):
        explorer.enter("alpha", alpha)
        sentence = f"contact exponent must be from 1e-06 to 10, not {float(alpha)}"
        assert any(text.startswith(sentence) for text in explorer.messages)
        assert laws(explorer) == before


def test_an_action_on_two_rows_is_one_undo_step() -> None:
    driver = Driver("locked-pistons", lab=False)
    undo = driver.session.undo
    before = [lane.velocity.tolist() for lane in driver.session.lanes]
    for speed in ("0", "-1", "0.5"):  # The last value, 0.5, is the original speed of the scene.
        driver.enter("speed", speed)
    assert [lane.velocity.tolist() for lane in driver.session.lanes] == before
    for _ in range(3):
        assert undo()
    driver.session.step_frames(20)
    press(driver, "+")
    driver.session.step_frames(20)
    driver.session.scrub_frame(10)
    driver.page.editor.lock_all()
    driver.session.step_frames(20)
    driver.session.scrub_frame(5)  # Frame 5 is earlier than the frame at which the contacts were locked.
    driver.enter("speed", "2")
    assert all(lane.setup.locked[0] for lane in driver.session.lanes)
    for contacts, locked in ((4, True), (4, True), (4, False), (3, False)):
        lanes = driver.session.history.newest_setup.lanes
        assert [lane.chain.contacts for lane in lanes] == [contacts] * 2
        assert [lane.locked[0] is not None for lane in lanes] == [locked] * 2
        undo()
    assert not undo()


def test_beads_come_and_go_before_a_wall_at_the_end(explorer: Driver) -> None:
    explorer.session.apply(SetMass(0, 4, math.inf))
    for text, walls in (("+", [False] * 5 + [True]), (MINUS, [False] * 4 + [True])):
        press(explorer, text)
        assert [math.isinf(mass) for mass in explorer.session.lanes[0].chain.mass] == walls


def test_a_row_is_compared_with_steel_balls(explorer: Driver) -> None:
    before = explorer.session.scene
    press(explorer, "Compare with steel balls")
    assert [law.exponent for law in laws(explorer, 1)] == [1.5] * 4
    # The slider changes only the softness of the upper row, not the steel balls.
    assert "softness, upper row" in explorer.said()
    assert explorer.session.playing
    assert len(explorer.app.focus.controls()) <= MOST_CONTROLS
    explorer.play_to_the_end()
    soft, steel = explorer.session.lanes
    assert steel.velocity[4] > 0.9
    assert soft.velocity[4] < 0.6
    soft, steel = explorer.page.outcome.text.split("\n")
    assert "Beads 2 to 4 move right together at 0.46\N{NO-BREAK SPACE}m/s." in soft
    assert steel.startswith("Beads 0 to 2 are almost at rest.")
    explorer.enter("speed", "2")
    press(explorer, "Back to one row")
    scene = explorer.session.scene
    # The description of the scene is empty because it does not apply to the changed speed.
    assert (scene.title, scene.text, scene.question) == (before.title, "", before.question)
    assert [lane.velocity.tolist() for lane in explorer.session.lanes] == [[2.0, 0.0, 0.0, 0.0, 0.0]]
    assert not explorer.page.unsaved, "another speed is a trial, no work to be lost"
    explorer.app.act("compare_balls")
    assert len(explorer.session.lanes) == 2


def test_a_text_without_room_is_read_whole_below_the_pointer(explorer: Driver) -> None:
    explorer.page.lessons.answered = True
    for scale, cut in ((0, False), (4, True)):
        explorer.key(pygame.K_PLUS, pygame.KMOD_CTRL, times=scale)
        explorer.page.view.backdrop.forget()
        explorer.frames(2)
        assert bool(explorer.page.explore._whole[1]) == cut
        explorer.move(explorer.page.explore._about.center)
        with drawn_texts(explorer.app.size) as texts:
            explorer.app.paint()
        # The list contains only texts that are drawn over the stored background.
        shown = " ".join(one.text for one in texts)
        assert ("not quite rigid" in shown) == cut


SLOW_ROWS = [pytest.param(lab, not lab, marks=pytest.mark.slow) for lab in (False, True)]
SLOW_SIZE = pytest.param((1280, 720), 1.0, marks=pytest.mark.slow)


@pytest.mark.parametrize(("lab", "compared"), [(False, True), (True, False), *SLOW_ROWS])
@pytest.mark.parametrize(("size", "scale"), [((1024, 600), 1.0), SLOW_SIZE, ((1366, 768), 1.0)], ids=str)
def test_words_at_the_end_are_above_the_beads_and_move_nothing(size, scale, lab, compared) -> None:
    driver = Driver("one-on-four", size=size, lab=lab)
    driver.app.scale = scale
    if compared:
        driver.app.act("compare_balls")
    driver.frames(2)
    before = driver.page.view.places
    driver.play_to_the_end()
    places, card = driver.page.view.places, driver.page.outcome
    assert places == before, "plots and beads keep their places"
    assert len(card._shown) == 1 + compared
    for (rect, _size, _lines), lane in zip(card._shown, driver.page.view.lanes, strict=True):
        assert lane.drawing.rect.contains(rect)
        assert rect.bottom <= lane.drawing.bar_base
        assert rect.top >= max(heading.bottom for heading in lane.drawing.heading[:1])


def test_words_without_space_are_shown_in_a_dialog(explorer: Driver) -> None:
    explorer.resize((1280, 720))
    explorer.app.act("compare_balls")
    explorer.app.scale = 2.0
    explorer.until(lambda: explorer.app.dialog, most=900)
    assert "Beads 2 to 4 move right together" in explorer.app.dialog.note
    assert not explorer.page.outcome.text


def test_the_clock_pauses_once_at_the_end_of_the_motion(driver) -> None:
    driver.play_to_the_end()
    overlap, page = driver.session.lanes[0].state.overlap, driver.page
    assert overlap.max() < 0.0
    assert overlap.min() <= -2.0 * driver.session.scene.view.length
    assert "Beads 2 to 4 move right together" in page.outcome.text
    assert not driver.messages
    driver.until(lambda: page.cards.health[0].velocity_error is not None)
    assert page.cards.health[0].velocity_error < 1e-3
    stopped, seconds = driver.session.time, page.board.span.seconds
    # The plot shows the whole motion that was played.
    assert 0.0 <= page.board.span.x(0.0) < page.board.span.x(stopped) <= page.board.span.width
    driver.run(100)
    assert driver.session.playing
    assert driver.session.time > stopped
    assert not page.outcome.text
    assert page.board.span.seconds < seconds


def test_the_largest_force_of_a_train_that_starts_is_a_pull() -> None:
    driver = Driver("train-starting", lab=False)
    driver.session.step_frames(200)
    driver.app.act("why")
    driver.frames(2)
    force = last_slice(driver.session.history, 0, driver.session.history.last).force
    assert driver.session.lanes[0].state.force.min() == force.min() < -1e5
    assert re.search(r"When the pull is strongest, the contacts carry .*\d … kN\.", driver.page.why.words)


def test_without_a_collision_there_is_nothing_to_explain(explorer: Driver) -> None:
    explorer.session.step_frames(5)
    explorer.frames(2)
    assert not explorer.page.time_controls.why.is_enabled
    explorer.app.act("why")
    assert not explorer.page.why.rows
    assert explorer.messages == ["Press Play first. The explanation needs a collision."]


SAID = (
    "Squeezed by 45 cm, 3 cm, 0.6 mm and 0.6 µm, the contacts still push with 1, 3/4, 1/2 and 1/4 of the force. "
    "So the push reaches the last bead at once, without a wave: an evanescent mode."
)


@pytest.mark.parametrize("lab", [False, True], ids=["explore", "lab"])
@pytest.mark.parametrize("size", [(1024, 600), pytest.param((1366, 768), marks=pytest.mark.slow)], ids=str)
def test_why_stops_at_the_largest_force_and_opens_magnifiers(size, lab) -> None:
    driver = Driver("one-on-four", size=size, lab=lab)
    driver.play_to_the_end()
    places = driver.page.view.places
    driver.click(driver.page.time_controls.why.rect.center)
    assert driver.page.why.words.replace("\N{NO-BREAK SPACE}", " ") == SAID
    assert driver.session.lanes[0].state.force.max() == pytest.approx(0.923, abs=2e-3)
    assert driver.page.view.places == places
    texts = [one.text.replace("\N{NO-BREAK SPACE}", " ") for one in driver.texts()]
    for caption in ("45 cm", "force 1", "3 cm", "force 3/4", "0.6 mm", "force 1/2", "0.6 µm", "force 1/4"):
        assert caption in texts
    assert SAID[:40] in " ".join(texts)
    driver.key(pygame.K_ESCAPE)  # Escape closes the explanation but not the page.
    assert not driver.page.why.rows
    assert driver.page.board.plots
    driver.app.act("why")
    driver.run(2)
    assert not driver.page.why.rows, "the clock runs"


def test_each_row_is_explained_at_its_own_largest_force(explorer: Driver) -> None:
    explorer.app.act("compare_balls")
    explorer.play_to_the_end()
    explorer.app.act("why")
    explorer.frames(2)
    soft, steel = explorer.page.why.rows
    assert soft.frame > steel.frame
    assert soft.words.replace("\N{NO-BREAK SPACE}", " ") == SAID
    assert "1, 1/9, 0 and 0 of the force" in steel.words
    assert "runs along the row as a wave" in steel.words
    for row, lane, shown in zip((soft, steel), (0, 1), explorer.page.view.lanes, strict=True):
        force = last_slice(explorer.session.history, lane, explorer.session.history.last).force
        assert row.motion.force.max() == force.max()
        # Each row of beads has its own scale of forces. The bar of the largest force fills the panel.
        assert shown.drawing.bar_base - shown.drawing._bar_top(float(force.max())) > 0.9 * shown.drawing.bar_room
    words = explorer.said()
    assert "45" in words
    assert "13" in words


def test_each_drag_of_a_slider_is_one_undo_step(
    explorer: Driver,
) -> None:
    for share in (0.2, 0.6, 0.9):
        slider = explorer.page.explore.controls["alpha"].slider
        explorer.pull(
            slider.sliding_button.rect.center, (slider.rect.left + share * slider.rect.width, slider.rect.centery)
        )
        explorer.play(20)
    assert len(explorer.session.undo_stack.done) == 3
    line = explorer.page.timeline
    explorer.drag((line.x(15), line.rect.centery), (line.x(5), line.rect.centery))
    explorer.key(pygame.K_w)  # The key W opens a dialog that covers the timeline.
    explorer.release(line.rect.center)
    assert not line.dragged


@pytest.mark.parametrize(("key", "compared"), [("alpha", False), ("speed", False), ("alpha", True)])
def test_a_slider_is_dragged_all_the_way_after_the_end_of_a_motion(explorer: Driver, key: str, compared: bool) -> None:
    if compared:
        explorer.app.act("compare_balls")
    explorer.play_to_the_end()
    control = explorer.page.explore.controls[key]
    before, (x, y) = control.parameter.value, control.slider.sliding_button.rect.center
    explorer.press((x, y))
    values = [before]
    # The card with the outcome closes at the first movement. The dragged slider must stay under the pointer.
    for moved in range(10, 101, 10):
        explorer.move((x + moved, y), (1, 0, 0))
        explorer.frames(1)
        assert explorer.page.explore.controls[key] is control
        assert control.slider.sliding_button.rect.centerx == x + moved
        values.append(control.parameter.value)
    explorer.release((x + 100, y))
    assert not explorer.page.outcome.text
    assert sorted(values) == values
    assert len(set(values)) > 6, "the value follows the mouse"
    assert len(explorer.session.undo_stack.done) == 1
    assert explorer.session.playing, "the scene plays again at once"
    assert explorer.session.time < 1.0


def test_a_slider_stays_in_the_hand_while_the_motion_ends(explorer: Driver) -> None:
    explorer.run(0)
    x, y = explorer.page.time_controls.slider.sliding_button.rect.center
    explorer.press((x, y))
    explorer.until(lambda: explorer.page.outcome.text, most=900)
    slow = explorer.page.time_controls.slow
    explorer.move((x + 40, y), (1, 0, 0))
    explorer.frames(1)
    assert explorer.page.time_controls.slow > slow
    explorer.release((x + 40, y))


def test_rows_struck_from_the_right_are_explained(tmp_path) -> None:
    scene = scenes.load("one-on-four")
    weak = scene.lanes[0].model_copy(update={"velocity": (0.0, 0.0, 0.0, 0.0, -0.1), "label": "weak"})
    strong = weak.model_copy(update={"velocity": (0.0, 0.0, 0.0, 0.0, -1.0), "label": "strong"})
    (tmp_path / "two.toml").write_text(scene.model_copy(update={"lanes": (weak, strong)}).to_toml(), encoding="utf-8")
    driver = Driver(str(tmp_path / "two.toml"), lab=False)
    driver.enter("speed", "0.2")
    assert [lane.velocity[-1] for lane in driver.session.lanes] == pytest.approx([-0.2, -2.0])
    driver.session.step_frames(600)
    driver.app.act("why")
    driver.frames(2)
    for row, lane in zip(driver.page.why.rows, (0, 1), strict=True):
        force = last_slice(driver.session.history, lane, driver.session.history.last).force
        assert row.motion.force.max() == force.max()
        assert row.push is not None
        assert row.push.contacts == (3, 2, 1, 0), "from the bead that struck on"
    assert driver.page.why.words.startswith("weak: Squeezed by ")


def test_a_clicked_bead_offers_its_mass_and_start_velocity(explorer: Driver) -> None:
    explorer.session.step_frames(200)
    explorer.frames(2)
    explorer.click(explorer.bead(2))
    assert "Bead 2" in explorer.said()
    assert set(explorer.page.explore.controls) == {"mass", "velocity"}
    assert explorer.page.explore.controls["velocity"].parameter.value == 0.0
    explorer.enter("mass", "3")
    assert explorer.session.time < 1.0
    explorer.session.pause()
    explorer.session.scrub_frame(0)
    assert explorer.session.lanes[0].chain.mass == (1.0, 1.0, 3.0, 1.0, 1.0)
    explorer.enter("velocity", "-0.5")
    explorer.session.pause()
    explorer.session.scrub_frame(0)
    assert explorer.session.lanes[0].velocity.tolist() == [1.0, 0.0, -0.5, 0.0, 0.0]
    explorer.key(pygame.K_ESCAPE)
    assert set(explorer.page.explore.controls) == {"alpha", "speed"}


def test_nine_values_are_tried_of_a_slider_that_is_shown(explorer: Driver) -> None:
    explorer.key(pygame.K_y)
    board = explorer.app.dialog
    assert board.parameter.key == "alpha"
    explorer.until(lambda: len(board.found) == len(board.values))
    explorer.click(board.places[-1].center)
    assert [law.exponent for law in laws(explorer)] == [1.5] * 4


def test_numbers_that_were_tried_are_left_without_a_question(explorer: Driver) -> None:
    explorer.enter("alpha", "0.5")
    press(explorer, "+")
    assert not explorer.page.unsaved
    explorer.key(pygame.K_ESCAPE)
    assert explorer.app.dialog is None
    assert explorer.app.page is explorer.app.gallery


def test_the_view_is_fitted_after_an_undo_or_restart(explorer: Driver) -> None:
    def settle(seen: object) -> None:
        explorer.until(lambda: explorer.page.view.scales.ahead is not seen)

    before, seen = explorer.page.view.lanes[0].drawing.bead, explorer.page.view.scales.ahead
    for _ in range(7):
        press(explorer, "+")
    settle(seen)
    assert explorer.page.view.lanes[0].drawing.bead < 0.7 * before
    seen = explorer.page.view.scales.ahead
    for _ in range(7):
        explorer.key(pygame.K_z, pygame.KMOD_CTRL)
    settle(seen)
    assert explorer.page.view.lanes[0].drawing.bead == pytest.approx(before, rel=0.02)
    seen = explorer.page.view.scales.ahead
    explorer.session.apply(SetMass(0, 4, math.inf))
    settle(seen)
    explorer.run(900)
    explorer.key(pygame.K_r)
    explorer.frames(5)
    edges = explorer.page.view.lanes[0].edges
    rect = explorer.page.view.places.lanes[0]
    assert edges[-1] - edges[0] > 0.3 * rect.width
    assert edges[0] > rect.left
    assert edges[-1] + explorer.page.view.lanes[0].drawing.bead < rect.right


@pytest.mark.parametrize("size", [(1280, 720), (1024, 528)])
def test_nothing_disappears_at_the_largest_scale(size: tuple[int, int]) -> None:
    driver = Driver("one-on-four", size=size, lab=False)
    driver.key(pygame.K_PLUS, pygame.KMOD_CTRL, times=6)
    assert driver.app.unit > 1.7 * driver.app._usual_unit
    assert [len(row) for row in driver.page.view.places.plots] == [1]
    assert driver.page.view.lanes[0].drawing.bead > 30 * driver.app.unit
    press(driver, "Predict")
    assert "Which beads leave on the right?" in driver.app.dialog.note


def test_soft_beads_open_next_to_steel_balls_until_one_row_is_chosen() -> None:
    driver = Driver("one-on-four", lab=False, beside=True)
    assert [driver.session.label(lane) for lane in (0, 1)] == ["alpha = 1/10", "steel balls"]
    assert "Upper row: One bead runs into four" in driver.said()
    assert not driver.page.unsaved
    driver.app.open("train-starting")
    assert len(driver.session.lanes) == 1, "a comparison with balls makes no sense"
    driver.app.open("one-on-four")
    driver.frames(2)
    press(driver, "Back to one row")
    driver.app.open("one-on-four-softer")
    driver.frames(2)
    assert len(driver.session.lanes) == 1


def test_a_change_plays_again_and_keeps_the_previous_run_in_the_plot(explorer: Driver) -> None:
    explorer.enter("speed", "1.5")
    assert not explorer.session.playing, "nothing has been played yet"
    explorer.play_to_the_end()
    ended = explorer.session.time
    explorer.enter("alpha", "0.5")
    assert explorer.session.playing
    explorer.frames(20)
    ghosts = explorer.page.board.ghosts
    assert len(ghosts) == 1
    assert ghosts[0][-1].time[-1] == pytest.approx(ended, abs=0.05)
    assert [law.exponent for law in ghosts[0][0].chain.contact] == [0.1] * 4
    assert "faint: previous run" in explorer.said()
    # The previous curves are kept for comparison, because no collision has happened since the last edit.
    explorer.enter("alpha", "0.7")
    assert explorer.page.board.ghosts is ghosts


def test_the_wait_for_the_first_contact_is_short(explorer: Driver) -> None:
    explorer.run(0)
    frames = 0
    while not explorer.session.lanes[0].state.force.any():
        explorer.frames(1)
        frames += 1
    # The collision happens at t = 1 s, after 2 s of slow motion. The first 1.5 s of them are played four times faster.
    assert 45 < frames < 60
    assert explorer.session.time == pytest.approx(1.0, abs=0.02)
    before = explorer.session.frame
    explorer.frames(10)
    assert explorer.session.frame - before == 10 * FRAME_RATE // 60, "the clock runs as shown"


def test_sums_of_energy_and_momentum_are_on_the_first_screen(explorer: Driver) -> None:
    assert {"0.5 J", "1 N s"} <= {one.text for one in explorer.texts()}
    explorer.run(200)  # After 200 frames, a part of the energy is stored in the contacts.
    assert explorer.session.lanes[0].motion.stored[0] > 0.1
    assert {"0.5 J", "1 N s"} <= {one.text for one in explorer.texts()}
    explorer.app.act("compare_balls")
    explorer.frames(2)
    assert {"0.5 | 0.5 J", "1 | 1 N s"} <= {one.text for one in explorer.texts()}
