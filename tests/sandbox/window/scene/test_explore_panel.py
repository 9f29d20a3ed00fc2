"""The first level of the window: few controls, alpha of the whole row, and the same blow among steel balls."""

from dataclasses import replace

import pygame
import pytest
from softcradle.physics import power_law
from softcradle.sandbox.session.contact_conversion import impact_energy
from softcradle.sandbox.session.inputs import SetVelocity
from softcradle.sandbox.window.scene.editor import Pick

from tests.helpers.drawn_text import drawn_texts
from tests.helpers.windows import Driver

MOST_CONTROLS = 16


@pytest.fixture
def explorer() -> Driver:
    return Driver("one-on-four", lab=False)


def typed(driver: Driver, key: str, text: str) -> None:
    entry = driver.page.explore.controls[key].entry
    driver.click(entry.rect.center)
    entry.set_text("")
    driver.type(text)
    driver.key(pygame.K_RETURN)


def laws(driver: Driver, lane: int = 0) -> list:
    return list(driver.session.lanes[lane].chain.contact)


def test_a_newcomer_sees_few_controls_and_beads_in_the_upper_half(explorer: Driver) -> None:
    assert len(explorer.app.focus.controls()) <= MOST_CONTROLS
    places = explorer.page.view.places
    assert places.lanes[0].height > 0.45 * explorer.app.size[1]
    assert [len(row) for row in places.plots] == [1]
    assert not places.insets.height
    for level in ("good", "bad"):  # the badge speaks where all is not well
        state = replace(explorer.session.health(0), level=level, sentence="beads are off")
        explorer.page.explore.health = lambda found=state: [found]
        assert ("beads are off" in [one.text for one in explorer.texts()]) == (level == "bad")


def test_one_switch_leads_to_the_lab_and_is_remembered(explorer: Driver) -> None:
    explorer.click(explorer.page.toolbar.buttons["level"].rect.center)
    assert explorer.page.cards.menus
    assert not explorer.page.explore.controls
    assert {"share", "plots_menu", "tools"} < explorer.page.toolbar.buttons.keys()
    explorer.close()
    explorer.app = Driver("one-on-four", lab=False).app
    assert explorer.page.cards.menus
    explorer.key(pygame.K_F3)
    assert explorer.page.explore.controls


def test_alpha_is_that_of_the_whole_row_and_the_blow_goes_as_deep(explorer: Driver) -> None:
    lane = explorer.session.lanes[0]
    before = impact_energy(lane.chain, 1, lane.setup.speed)
    explorer.run(60)
    typed(explorer, "alpha", "1")
    assert explorer.session.frame == 0  # begun anew
    assert [law.exponent for law in laws(explorer)] == [1.0] * 4
    lane = explorer.session.lanes[0]
    assert impact_energy(lane.chain, 1, lane.setup.speed) == pytest.approx(before)
    explorer.key(pygame.K_z, pygame.KMOD_CTRL)
    assert laws(explorer) == [power_law(1.0, 0.1)] * 4


def test_one_slider_changes_the_row_unless_one_contact_is_selected(explorer: Driver) -> None:
    explorer.click(explorer.page.view.lanes[0].handles()[1])
    assert explorer.page.editor.selection == Pick(0, "contact", 1)
    typed(explorer, "alpha", "0.5")
    assert [law.exponent for law in laws(explorer)] == [0.1, 0.5, 0.1, 0.1]


def test_speed_and_number_of_beads(explorer: Driver) -> None:
    typed(explorer, "speed", "2")
    assert explorer.session.lanes[0].velocity.tolist() == [2.0, 0.0, 0.0, 0.0, 0.0]
    for button, count in (("+", 6), ("\N{MINUS SIGN}", 5)):
        found = next(one for one in explorer.page.explore.buttons if one.text == button)
        explorer.click(found.rect.center)
        assert len(explorer.session.lanes[0].chain.mass) == count


def test_the_text_of_a_scene_is_not_said_of_another(explorer: Driver) -> None:
    explorer.page.lessons.answered = True  # its question comes first
    assert "nearly as one" in " ".join(one.text for one in explorer.texts())
    typed(explorer, "alpha", "1")
    explorer.frames(2)
    said = " ".join(one.text for one in explorer.texts())
    assert "nearly as one" not in said
    assert "You have changed this scene" in said


def test_the_same_blow_among_steel_balls_plays_below(explorer: Driver) -> None:
    button = next(one for one in explorer.page.explore.buttons if "steel" in one.text)
    explorer.click(button.rect.center)
    assert [law.exponent for law in laws(explorer, 1)] == [1.5] * 4
    # the slider leaves the steel balls as they are
    assert "alpha of the upper row" in [one.text for one in explorer.texts()]
    assert explorer.session.playing
    assert len(explorer.app.focus.controls()) <= MOST_CONTROLS
    explorer.frames(330)
    soft, steel = explorer.session.lanes
    assert steel.velocity[4] > 0.9
    assert soft.velocity[4] < 0.6


def test_a_text_without_room_is_read_whole_below_the_pointer() -> None:
    made = Driver("one-on-four", lab=False)
    made.page.lessons.answered = True
    for scale, cut in ((0, False), (4, True)):
        for _ in range(scale):
            made.key(pygame.K_PLUS, pygame.KMOD_CTRL)
        made.page.view.backdrop.forget()
        made.frames(2)
        assert bool(made.page.explore._whole[1]) == cut
        made.move(made.page.explore._about.center)
        with drawn_texts(made.app.size) as texts:
            made.app.paint()
        said = " ".join(one.text for one in texts)  # over the backdrop, which is drawn already
        assert ("rigid-like, not rigid" in said) == cut


@pytest.mark.parametrize("lab", [False, True], ids=["explore", "lab"])
@pytest.mark.parametrize(("size", "scale"), [((1280, 720), 1.0), ((1024, 600), 1.0), ((1280, 800), 1.5)], ids=str)
@pytest.mark.parametrize("compared", [False, True], ids=["one row", "two rows"])
def test_the_card_at_the_end_leaves_room_for_beads_and_forces(size, scale, lab, compared) -> None:
    driver = Driver("one-on-four", size=size, lab=lab)
    driver.app.scale = scale
    driver.app.rebuild()
    if compared:
        driver.app.act("compare_balls")
    driver.play_to_the_end()
    driver.page.outcome.show_forces()
    driver.frames(2)
    view, card, unit = driver.page.view, driver.page.outcome._rect, driver.app.unit
    assert card.height
    assert card.bottom <= view.places.footer.top
    assert not any(card.colliderect(rect) for row in view.places.plots for rect in row)
    for lane in view.lanes:
        drawing = lane.drawing
        assert drawing.rect.bottom <= card.top
        assert drawing.rect.height >= (120 if compared else 180) * unit
    drawing = view.lanes[0].drawing
    greatest = float(driver.session.lanes[0].state.force.max())
    if not compared:  # the rigid marks are at 3/4, 1/2, 1/4
        assert drawing.bar_base - drawing._bar_top(greatest) > 45 * unit


def test_what_happened_is_said_in_a_box_where_no_card_fits(explorer: Driver) -> None:
    explorer.resize((1280, 800))
    explorer.app.scale = 2.0
    explorer.app.rebuild()
    assert explorer.app.unit == 2.0
    explorer.run(0)
    explorer.until(lambda: explorer.app.dialog, most=900)
    assert "Beads 2 to 4 go together" in explorer.app.dialog.note
    explorer.click(explorer.app.dialog.buttons["Why? The forces"].rect.center)
    assert "one rigid body" in explorer.app.dialog.note
    assert explorer.session.lanes[0].state.force.max() > 0.9
    explorer.key(pygame.K_ESCAPE)
    explorer.key(pygame.K_2)
    assert explorer.messages == ["there is no room for plots: make the window larger, or the scale smaller"]


def test_at_the_end_plots_show_all_that_was_played(explorer: Driver) -> None:
    explorer.play_to_the_end()
    span, session = explorer.page.board.span, explorer.session
    assert span.x(0.0) >= 0.0
    assert span.x(session.time) <= span.width
    seconds = span.seconds
    explorer.key(pygame.K_SPACE)
    explorer.frames(2)
    assert explorer.page.board.span.seconds < seconds


def test_the_card_says_in_few_words_what_happened_in_each_row(explorer: Driver) -> None:
    explorer.app.act("compare_balls")
    explorer.frames(2)
    explorer.play_to_the_end()
    soft, steel = explorer.page.outcome.text.split("\n")
    assert "Beads 2 to 4 go together to the right at 0.46\N{NO-BREAK SPACE}m/s." in soft
    assert steel.startswith("steel balls: Beads 0 to 2 nearly stand still.")


def test_back_to_one_row_with_its_words_and_what_was_changed_meanwhile(explorer: Driver) -> None:
    before = explorer.session.scene
    explorer.app.act("compare_balls")
    explorer.frames(2)
    explorer.session.pause()
    typed(explorer, "speed", "2")
    button = next(one for one in explorer.page.explore.buttons if one.text == "Back to one row")
    explorer.click(button.rect.center)
    explorer.frames(2)
    scene = explorer.session.scene
    assert (scene.title, scene.text, scene.question) == (before.title, before.text, before.question)
    assert len(explorer.session.lanes) == 1
    assert explorer.session.lanes[0].velocity.tolist() == [2.0, 0.0, 0.0, 0.0, 0.0]
    assert explorer.page.unsaved
    explorer.app.act("compare_balls")
    explorer.frames(2)
    assert len(explorer.session.lanes) == 2


def test_the_text_of_a_scene_is_not_said_of_one_that_begins_otherwise(explorer: Driver) -> None:
    explorer.page.lessons.answered = True
    explorer.frames(2)
    before = explorer.page.view.backdrop.version
    explorer.page.editor.apply(SetVelocity(0, 0, 0.7))
    explorer.frames(2)
    assert explorer.session.edited
    assert explorer.page.view.backdrop.version == before + 1
