"""What a scene shows beside its beads: the mark of unsaved edits, arrows to beads outside, labels, plots that are scrolled to."""

import itertools
import math
import re

import pygame
import pytest
from softcradle.sandbox.draw.number_format import MINUS
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.window.plots.kinds import PLOT_KINDS
from softcradle.sandbox.window.scene.editor import Pick

from tests.helpers.drawn_text import colliding
from tests.helpers.windows import Driver


def has_colour(driver: Driver, points, colour) -> bool:
    return all(driver.app.surface.get_at((round(x), round(y)))[:3] == tuple(colour) for x, y in points)


def test_the_title_marks_unsaved_edits(driver: Driver) -> None:
    def title() -> str:
        return next(one.text for one in driver.texts() if "One bead on four" in one.text)

    assert title() == "One bead on four"
    driver.click(driver.bead(1))
    driver.key(pygame.K_a)
    assert title() == "• One bead on four"
    driver.page.dialogs.save("save_scene", "mine")
    assert title() == "One bead on four"


def test_arrows_count_the_beads_outside(driver: Driver) -> None:
    rect = driver.page.view.lanes[0].drawing.rect
    driver.pull((rect.left + 40, rect.top + 40), (rect.left + 40 - 3 * rect.width, rect.top + 40))
    driver.frames(2)
    ground = driver.page.view.lanes[0].drawing.ground
    found = [one for one in driver.texts() if one.text == "5" and abs(one.rect.centery - (ground - 14)) < 4]
    assert len(found) == 1
    assert found[0].rect.left < rect.left + 30
    driver.key(pygame.K_f)
    assert not [one for one in driver.texts() if one.text == "5" and one.rect.left < rect.left + 30]


def test_marks_of_rigid_clusters_are_of_the_beads_that_there_are(driver: Driver) -> None:
    driver.play(240)
    assert len(driver.page.view.lanes[0].drawing.ends) == 4
    driver.page.editor.selection = Pick(0, "bead", 4)
    driver.key(pygame.K_DELETE)
    driver.frames(2)
    assert driver.page.view.lanes[0].drawing.ends == (True, False, False)  # of three beads that are pushed, Eq. (5)


@pytest.mark.parametrize("name", ["train-shunting", "train-braking", "train-cut"])
def test_force_labels_of_a_train_have_prefixes_and_room(name: str) -> None:
    driver, seen = Driver(name), 0
    for _ in range(12):
        driver.session.step_frames(40)
        driver.frames(2)
        lane = driver.page.view.lanes[0]
        texts = [one for one in driver.texts() if lane.drawing.rect.collidepoint(one.rect.center)]
        forces = [one for one in texts if re.fullmatch(rf"{MINUS}?[\d.]+ [kM]", one.text)]
        seen = max(seen, len(forces))
        assert not [pair for pair in colliding(texts) if {*pair} & {one.text for one in forces}]
    assert seen > 2


@pytest.mark.parametrize("lab", [False, True], ids=["explore", "lab"])
def test_every_force_of_a_row_is_written_at_every_scale(lab: bool) -> None:
    driver = Driver("one-on-four", lab=lab)
    driver.session.step_frames(600)
    driver.page.outcome.show_forces()
    driver.key(pygame.K_ESCAPE)
    for driver.app.scale in (1.0, 1.5, 2.0):
        driver.app.rebuild()
        driver.frames(2)
        assert {"0.92", "0.71", "0.47", "0.24"} <= {one.text for one in driver.texts()}


@pytest.mark.parametrize(("lab", "code"), [(False, "de"), (True, "en")], ids=str)
def test_two_lanes_have_room_at_every_size_and_scale(lab: bool, code: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LANGUAGE", code)
    driver = Driver("steel-and-soft", lab=lab)
    driver.session.step_frames(60)
    for size, scale, ended in itertools.product(
        ((1024, 600), (1280, 800), (1920, 1080)), (1.0, 1.5, 2.0), (False, True)
    ):
        driver.resize(size)
        driver.app.scale = scale
        driver.app.rebuild()
        if ended:
            driver.page.outcome.show_outcome()
        driver.frames(2)
        view, unit = driver.page.view, driver.app.unit
        assert min(lane.height for lane in view.places.lanes) >= 120 * unit - 1
        assert all(rect.height >= 85 * unit for row in view.places.plots for rect in row)
        assert all(lane.drawing.bar_room > 10 * unit for lane in view.lanes)
        if driver.app.dialog is None or not driver.app.dialog.open:
            assert not colliding(driver.texts())
        assert ended <= bool(driver.page.outcome.text or driver.app.dialog)
        driver.key(pygame.K_ESCAPE) if driver.app.dialog else driver.page.outcome.hide()
        driver.app.dialog = None


def test_seven_plots_of_two_lanes_are_wide_and_scrolled_to() -> None:
    driver = Driver("beads-against-gear")
    board, view = driver.page.board, driver.page.view
    for name in PLOT_KINDS:
        if name not in board.shown:
            driver.app.act(name)
    driver.frames(2)
    assert len(board.shown) >= 7
    assert min(plot.area.width for plot in board.plots) > 100
    assert min(plot.area.height for plot in board.plots) > 20
    driver.app.scale = 1.5
    driver.app.rebuild()
    driver.frames(2)
    assert len(view.rows) < view.row_count
    seen = set(board.keys)
    for _ in range(view.row_count):
        driver.wheel(view.plots_area().center, -1)
        seen |= set(board.keys)
    assert seen == {(name, lane) for name in board.shown for lane in (0, 1)}


def test_a_selection_has_the_shape_of_its_body() -> None:
    driver = Driver("draft-gear-one-on-three")
    driver.select("bead", 1)
    lane, gap = driver.page.view.lanes[0], 4
    rect, corner = lane.drawing.body_shape(1, float(lane.edges[1]))
    assert 2 * corner < rect.width
    frame = rect.inflate(2 * gap, 2 * gap)
    assert has_colour(driver, [(frame.centerx, frame.top), (frame.left, frame.centery)], tones.foreground)
    driver.app.act("law_all")  # power laws are drawn as round beads
    driver.frames(2)
    lane = driver.page.view.lanes[0]
    rect, corner = lane.drawing.body_shape(1, float(lane.edges[1]))
    assert 2 * corner == pytest.approx(rect.width, abs=1)
    radius = corner + gap - 1
    turns = [pygame.Vector2(radius, 0).rotate_rad(turn) for turn in (-0.8, -1.6, -2.4)]
    assert has_colour(driver, [rect.center + turn for turn in turns], tones.foreground)


def test_a_wall_is_made_of_any_bead_and_freed_again(driver: Driver) -> None:
    driver.click(driver.bead(4))
    for text, mass in (("make it a wall", math.inf), ("free it", 1.0)):
        driver.click(next(one for one in driver.page.inspector.buttons if one.text == text).rect.center)
        assert driver.session.lanes[0].chain.mass[4] == mass


def test_the_control_in_focus_has_a_ring(driver: Driver) -> None:
    driver.move((700, 300))
    for _ in range(4):
        driver.key(pygame.K_TAB)
        rect = driver.app.focus.control.rect.inflate(6, 6)
        edges = (rect.centerx, rect.top), (rect.left, rect.centery), (rect.centerx, rect.bottom - 1)
        assert has_colour(driver, edges, tones.foreground)
