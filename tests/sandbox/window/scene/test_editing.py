"""Tests of editing a scene with the pointer, keys, the inspector, and the dialogs for parameter sweeps and rows of
beads.

The tests also check that axes, magnified contacts, the verdict and the predicted motion are right after an edit.
"""

from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pygame
import pytest
from softcradle.physics import one_on, power_law, simulate
from softcradle.sandbox.draw.palette import mix, tones
from softcradle.sandbox.session.editable_numbers import variant_of
from softcradle.sandbox.session.inputs import AddBead, RemoveBead, SetContact, SetMass, SetMethod, SetStep, SetVelocity
from softcradle.sandbox.session.lane_setup import setup_of
from softcradle.sandbox.session.live_lane import BlownUpError
from softcradle.sandbox.session.snapshots import NOTHING_HELD
from softcradle.sandbox.user_error import GaveUpError
from softcradle.sandbox.window.plots.scales import MOST_AT_ONCE, motions_ahead
from softcradle.sandbox.window.scene.editor import Pick
from softcradle.sandbox.window.scene.inspector import COUNT, SweepBoard
from softcradle.sandbox.window.scene.lane_cards import SUMMARIES

from softcradle import scenes
from tests.helpers.sessions import opened
from tests.helpers.windows import FRAME, Driver, pressed

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


def test_a_bead_is_placed_pulled_and_thrown(driver: Driver) -> None:
    x, y = driver.bead(0)
    before = driver.session.lanes[0].position.copy()
    driver.pull((x, y), (x - 60, y))
    after = driver.session.lanes[0].position
    assert after[0] - before[0] == pytest.approx(driver.page.view.lanes[0].metres(-60), rel=0.05)
    assert after[1:] == pytest.approx(before[1:], abs=1e-15)
    driver.run(5)
    x, y = driver.bead(4)
    driver.drag((x, y), (x + 120, y), steps=25)
    assert driver.session.lanes[0].velocity[4] > 0.2
    driver.release((x + 120, y))
    assert driver.session.held == NOTHING_HELD


def test_keys_edit_the_selection_or_all_contacts(driver: Driver) -> None:
    before = driver.session.setup
    for key in (pygame.K_a, pygame.K_m, pygame.K_g, pygame.K_l):
        driver.key(key)
    assert driver.session.setup is before
    for wanted in ("select a bead", "select a contact"):
        assert any(wanted in text for text in driver.messages)
    driver.key(pygame.K_RIGHT, times=2)
    assert driver.page.editor.selection == Pick(0, "contact", 0)
    driver.key(pygame.K_g)
    assert [law.preload > 0.0 for law in driver.session.lanes[0].chain.contact] == [True, False, False, False]
    driver.key(pygame.K_g, SHIFT)
    soft = driver.session.lanes[0].chain.contact
    assert all(law.preload > 0.0 for law in soft)
    for modifiers, locked in ((0, [True, False, False, False]), (SHIFT, [True] * 4)):
        driver.key(pygame.K_l, modifiers)
        assert [law != old for law, old in zip(driver.session.lanes[0].chain.contact, soft, strict=True)] == locked


def test_rejected_numbers_do_not_stay_in_their_box(driver: Driver) -> None:
    driver.click(driver.bead(2))
    entry = driver.page.inspector.controls["mass"].entry
    driver.click(entry.rect.center)
    driver.key(pygame.K_RETURN)
    assert not driver.page.unsaved  # The box was left without typing, so nothing is unsaved.
    driver.click(entry.rect.center)
    driver.type("r a")
    assert driver.session.lanes[0].chain.contacts == 4
    assert not driver.session.playing
    driver.key(pygame.K_ESCAPE)
    for typed in ("-1", "1e999", "inf", "nan", "x", "", "1/0", "1/", "--1"):
        driver.enter("mass", typed)
        assert entry.get_text() == "1"
        assert driver.session.lanes[0].chain.mass[2] == 1.0
        assert not driver.page.typing
    driver.click(entry.rect.center)
    entry.set_text("5")
    driver.click(driver.bead(3))  # A typed number is accepted when the user clicks outside its box.
    assert driver.session.lanes[0].chain.mass[2] == 5.0
    for typed, mass in (("0,5", 0.5), ("1/14", 1 / 14), (" 7 ", 7.0)):
        driver.enter("mass", typed)
        assert driver.session.lanes[0].chain.mass[3] == mass
    driver.enter("velocity", "\N{MINUS SIGN}2e-3")
    assert driver.session.lanes[0].velocity[3] == -2e-3
    driver.key(pygame.K_SPACE)
    assert driver.session.playing


def test_the_slider_goes_where_its_number_is(driver: Driver) -> None:
    driver.click(driver.bead(0))
    driver.enter("velocity", "-8")
    driver.frames(20)
    control = driver.page.inspector.controls["velocity"]
    assert control.parameter.value == -8.0
    assert control.slider.current_value == pytest.approx(control.parameter.share(), abs=0.01)
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    driver.play(300)
    driver.frames(20)
    control = driver.page.inspector.controls["velocity"]
    assert control.parameter.value < 0.5
    assert control.slider.current_value == pytest.approx(control.parameter.share(), abs=0.01)


def test_the_kind_of_a_contact_says_what_its_law_is() -> None:
    """Check which kind of contact is marked in the inspector.

    A spring of 1 N/m does not count as a hard contact. For couplers of wagons, the inspector does not offer the three
    kinds of contacts.
    """
    for scene, law, expected in (("one-on-four", power_law(1.0, 1.0), ["alpha ≥ 1"]), ("train-starting", None, [])):
        driver = Driver(scene)
        if law:
            driver.session.apply(SetContact(0, 1, law))
        driver.select("contact", 1)
        buttons = driver.page.inspector.buttons
        assert [button.text for button in buttons if button.is_selected] == expected
        # The five buttons are three kinds of contacts, "lock" and "all alike".
        assert len(buttons) == (5 if law else 0)


def test_the_method_menu_follows_keys_undo_and_redo(driver: Driver) -> None:
    menu = driver.page.cards.menus[0]
    driver.key(pygame.K_SPACE)
    driver.click(menu.rect.center)
    options = menu.menu_states["expanded"].options_selection_list
    item = next(one for one in options.item_list_container.elements if one.text == "euler")
    driver.click(item.rect.center)
    driver.frames(5)
    assert driver.session.lanes[0].setup.method == "euler"
    undo, redo = (pygame.K_z, CTRL), (pygame.K_z, CTRL | SHIFT)
    for key, name in (((pygame.K_m, SHIFT), "verlet"), (undo, "euler"), (undo, "auto"), (redo, "euler")):
        driver.key(*key)
        assert driver.page.cards.menus[0].selected_option[0] == name


def test_the_badge_is_red_beyond_the_limit_of_the_method() -> None:
    driver = Driver("draft-gear-one-on-three")
    for edit in (SetMethod(None, "euler"), SetStep(None, 0.01)):
        driver.session.apply(edit)
    driver.key(pygame.K_PLUS, times=3)
    driver.run(60)
    assert driver.page.cards.health[0].level == "bad"
    card = driver.page.cards.rects[0]
    assert driver.app.surface.get_at((card.centerx, card.top))[:3] == mix(tones.background, tones.bad, 0.12)
    driver.frames(300)
    button = driver.page.cards.verdicts[0]
    assert "euler lost energy" in button.text
    driver.click(button.rect.center)
    assert driver.session.scrubbed
    assert driver.session.frame == driver.session.findings(0)[0].first


def test_a_verdict_on_stored_frames_names_their_beginning() -> None:
    driver = Driver("one-on-four")
    driver.session.history.bound = 0
    said = [driver.page.cards.verdicts[0].text]
    for _ in range(2):
        driver.session.step_frames(600)
        driver.frames(20)
        said.append(driver.page.cards.verdicts[0].text)
    assert said[:2] == ["whole run OK"] * 2
    assert said[2] == f"no problem since {driver.session.span[0]:.2f} s"


def test_no_badge_advises_the_method_that_failed() -> None:
    for method, advice in (("conserving", "use slower motion"), ("euler", "use conserving or a smaller step")):
        assert setup_of(scenes.load("one-on-four")).lanes[0].with_method(method).remedy == advice
    session = opened("one-on-four", SetMethod(None, "conserving"), SetMass(0, 1, 1e-30))
    session.step_frames(400)
    assert "use conserving" not in session.health(0).sentence


def test_one_of_nine_values_is_chosen_by_key_or_click(driver: Driver) -> None:
    def swept() -> SweepBoard:
        board = driver.app.dialog
        assert isinstance(board, SweepBoard)
        driver.until(lambda: len(board.found) == COUNT)
        return board

    driver.key(pygame.K_y)
    assert "Select a bead or a contact" in driver.messages[-1]
    driver.select("bead", 0)
    driver.click(driver.page.inspector.controls["mass"].sweep.rect.center)
    board = swept()
    masses = [variant.value for variant in board.found]
    assert masses == sorted(masses)
    for variant in (board.found[4], board.found[7]):
        chain = one_on(4, power_law(1.0, 0.1), mass=[variant.value, 1.0, 1.0, 1.0, 1.0])
        exact = simulate(chain, [1.0, 0.0, 0.0, 0.0, 0.0])
        assert variant.motion.velocity[-1] == pytest.approx(exact.final_velocity, abs=5e-3)
    assert board.focus == 4  # Variant 4 has the current mass.
    # The name of the curve is drawn for each variant.
    assert [one.text for one in driver.texts()].count("v\N{SUBSCRIPT FOUR}") >= COUNT
    driver.key(pygame.K_DOWN)
    driver.key(pygame.K_RETURN)
    assert driver.session.lanes[0].chain.mass[0] == masses[7]
    driver.select("contact", 1)
    driver.click(driver.page.inspector.controls["preload"].slider.rect.center)
    driver.key(pygame.K_y)  # The key Y varies the parameter whose slider was used last.
    board = swept()
    assert board.parameter.key == "preload"
    driver.click(board.places[8].center)
    assert driver.session.lanes[0].chain.contact[1].preload == pytest.approx(board.found[8].value)
    assert not board.open
    driver.key(pygame.K_y)
    swept()
    driver.key(pygame.K_ESCAPE)
    assert not driver.app.dialog.open


@pytest.mark.parametrize(("kind", "key"), [("bead", "velocity"), ("contact", "gap"), ("bead", "mass")])
def test_choosing_one_of_nine_values_gives_the_motion_shown(driver: Driver, kind, key) -> None:
    driver.session.step_frames(300)
    before = driver.session.time, driver.session.setup
    driver.select(kind, 1)
    driver.page.inspector.sweep(key)
    board = driver.app.dialog
    driver.until(lambda: board.found)
    assert len(board.found) < COUNT  # Each variant is shown as soon as it has been computed, so some are still missing.
    driver.until(lambda: len(board.found) == COUNT)
    # The dialog shows the value that the parameter had at the start of this motion.
    assert board.parameter.value == {"velocity": 0.0, "gap": 0.0, "mass": 1.0}[key]
    driver.click(board.places[6].center)
    assert driver.session.frame == 0
    shown = board.found[6].motion
    driver.session.step_frames(400)
    velocity = [np.interp(driver.session.time, shown.time, one) for one in shown.velocity.T]
    assert driver.session.lanes[0].velocity == pytest.approx(velocity, abs=5e-3)
    driver.key(pygame.K_z, CTRL)
    assert (driver.session.time, driver.session.setup) == before


def test_a_value_whose_run_gives_up_shows_the_reason() -> None:
    gives_up = Mock(side_effect=GaveUpError("no end"))
    found = variant_of(scenes.load("one-on-four"), 0, 2.0, lambda mass: [SetMass(0, 0, mass)], gives_up)
    assert (found.value, found.motion) == (2.0, None)
    assert "the method gave up" in found.problem


def test_axes_and_loupes_follow_another_exponent(driver: Driver) -> None:
    before = driver.page.view.scales.scales
    law = driver.session.lanes[0].chain.contact[0]
    driver.session.apply(SetContact(0, None, replace(law, exponent=0.02)))
    driver.until(lambda: driver.page.view.scales.scales.decades != before.decades)
    after = driver.page.view.scales.scales
    assert after.decades[0] < before.decades[0] - 10
    assert after.deepest[0][3] < 1e-6 * before.deepest[0][3]
    assert driver.page.view.lanes[0].drawing.label == "alpha = 1/50"


def faster(driver: Driver) -> None:
    driver.play(300)
    driver.key(pygame.K_r)
    driver.page.editor.apply(SetVelocity(0, 0, -8.0))
    driver.frames(30)
    driver.until(lambda: not driver.page.view.follower.pending)
    assert driver.page.view.scales.scales.velocity[0] < -7.0


def thrown(driver: Driver) -> None:
    before = driver.page.view.scales.scales
    driver.run(240)
    centre = driver.bead(4)
    driver.drag(centre, (centre[0] - 400, centre[1]), steps=4)
    driver.frames(20)
    driver.release(centre)
    driver.frames(60)
    assert driver.page.view.scales.scales.energy > 2.0 * before.energy


def removed(driver: Driver) -> None:
    driver.select("bead", 4)
    driver.drag(driver.bead(4), (driver.bead(4)[0] - 120, driver.bead(4)[1]))
    driver.key(pygame.K_DELETE)
    assert driver.page.pointer.pressed is None
    driver.release(driver.bead(3))
    driver.select("bead", 3)
    driver.key(pygame.K_DELETE)
    driver.frames(40)


@pytest.mark.parametrize("change", [faster, thrown, removed])
def test_scales_of_what_is_undone_go_with_it(driver: Driver, change) -> None:
    before = driver.page.view.scales.scales
    change(driver)
    while driver.session.undo_stack.done:
        driver.key(pygame.K_z, CTRL)
    driver.key(pygame.K_r)
    driver.until(lambda: driver.page.view.scales.scales == before)


EDITS = {"remove": (pygame.K_DELETE, 0), "undo": (pygame.K_z, pygame.KMOD_CTRL), "redo": (pygame.K_y, pygame.KMOD_CTRL)}


def test_an_edit_is_undone_in_the_frame_of_a_rebuild(driver) -> None:
    """Check that an edit can be undone in the same frame in which the page is built again.

    In an earlier version, the page was built from beads that no longer existed.
    """
    driver.click(driver.bead(2))
    driver.session.step_frames(200)
    driver.frames(2)
    driver.app.frame(FRAME, [*pressed(pygame.K_DELETE), *pressed(pygame.K_i), *pressed(*EDITS["undo"])])
    driver.frames()
    assert driver.session.lanes[0].chain.contacts == 4
    assert [len(depths) for depths in driver.page.view.scales.scales.deepest] == [4]
    assert driver.page.view.lanes[0].drawing.chain == driver.session.lanes[0].chain


@pytest.mark.parametrize("edit", EDITS)
def test_a_click_uses_the_chain_after_an_edit_of_the_same_frame(driver, edit: str) -> None:
    driver.session.apply(AddBead(0, 5, 1.0))
    if edit == "redo":
        driver.session.apply(RemoveBead(0, 5))
        driver.session.undo()
    driver.select("bead", 5)
    turns, place = (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP), driver.bead(5)
    clicked = [pygame.Event(kind, pos=place, button=1) for kind in turns]
    driver.app.frame(FRAME, [*pressed(*EDITS[edit]), *clicked])
    assert driver.session.lanes[0].chain.contacts == 4
    assert driver.page.editor.selection is None


def test_the_look_ahead_does_not_touch_the_warning_filters(monkeypatch):
    """Check that predicting the motion in a thread does not change the warning filters, which all threads share."""
    scene = scenes.load("one-on-four").model_copy(update={"method": "euler", "step": 1e-3})
    for name in ("catch_warnings", "simplefilter", "filterwarnings", "warn"):
        monkeypatch.setattr(f"warnings.{name}", Mock(side_effect=AssertionError("a thread used the warnings")))
    assert motions_ahead(scene)


@pytest.mark.parametrize("method", ["pymunk", "scipy", "euler"])
def test_a_run_ahead_is_none_of_a_method_in_python(method):
    """Check that the motion is predicted with a fast compiled method.

    In an earlier version, a comparison with pymunk blocked the window for more than ten minutes.
    """
    motions = motions_ahead(scenes.load("one-on-four").model_copy(update={"method": method}), MOST_AT_ONCE)
    assert motions[0].method.split(",")[0] == ("conserving" if method in ("pymunk", "scipy") else method)


def test_a_run_ahead_that_takes_long_does_not_hold_up_the_window(driver):
    """Check that a slow prediction of the motion does not block the window.

    The scales of the plots are estimated until a thread has computed them. If the time step is far too small, the
    thread gives up.
    """
    scene = scenes.load("one-on-four").model_copy(update={"method": "conserving", "step": 1e-9})
    driver.page.show_scene(scene)
    assert driver.page.view.follower.pending
    driver.page.show_scene(scene.model_copy(update={"step": 2e-6}))
    assert driver.page.view.follower.pending
    driver.until(lambda: not driver.page.view.follower.pending)


def test_methods_that_reject_the_chain_are_not_offered() -> None:
    driver, walked = Driver("experiment-one-on-three"), []  # In this scene, the beads slide with friction.
    for _ in range(len(SUMMARIES)):
        driver.key(pygame.K_m, SHIFT)
        walked.append(driver.page.cards.method(0))
    assert walked == [name for name in SUMMARIES if name != "yoshida4"] + ["auto"]
    driver.choose(driver.page.cards.menus[0], "yoshida4")
    driver.frames(3)
    assert driver.page.cards.menus[0].selected_option[0] == "auto"


def test_a_method_that_blows_up_says_so(driver: Driver, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver.session.lanes[0], "advance", Mock(side_effect=BlownUpError("euler has blown up")))
    for key in (pygame.K_PERIOD, pygame.K_SPACE):
        driver.app.messages.leave_page()
        driver.key(key)
        assert "euler has blown up" in driver.messages
