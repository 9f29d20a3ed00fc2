"""What a scene shows: its beads within sight of the camera, forces, marks, labels, and plots that are scrolled to."""

import math
import re

import pygame
import pytest
from softcradle.sandbox.draw.number_format import MINUS
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.session.inputs import AddBead, SetVelocity
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
    driver.session.apply(AddBead(0, 1))
    assert title() == "• One bead on four"
    driver.page.dialogs.save("save_scene", "mine")
    assert title() == "One bead on four"


def in_sight(driver: Driver) -> bool:
    lane = driver.page.view.lanes[0]
    rect = lane.drawing.rect
    return bool((lane.edges >= rect.left).all() and (lane.edges + lane.drawing.bead <= rect.right + 1).all())


def test_beads_stay_in_sight_by_themselves(driver: Driver) -> None:
    driver.page.clock.end.toggle()
    driver.session.apply(SetVelocity(0, 0, 4.0))
    driver.key(pygame.K_SPACE)
    for _ in range(20):
        driver.frames(30)
        assert in_sight(driver)
    assert driver.session.time > 4.0


def test_wheel_and_drag_take_the_view_an_arrow_counts_beads_outside_and_fit_gives_it_back(driver: Driver) -> None:
    def counted() -> list[pygame.Rect]:
        high = driver.page.view.lanes[0].drawing.ground - 14
        return [one.rect for one in driver.texts() if one.text == "5" and abs(one.rect.centery - high) < 4]

    rect, slow = driver.page.view.lanes[0].drawing.rect, driver.session.slow
    point = (rect.left + rect.width // 4, rect.top + 30)
    place = driver.page.view.metres_at(point)
    for turn in (-1, -1, -1, 1):
        driver.wheel(point, turn)
        assert driver.page.view.metres_at(point) == pytest.approx(place, abs=1e-6)
    assert driver.session.slow == slow
    before = float(driver.page.view.lanes[0].edges[0])
    driver.pull(point, (point[0] - 3 * rect.width, point[1]))
    assert driver.page.view.lanes[0].edges[0] == pytest.approx(before - 3 * rect.width, abs=3)
    assert not in_sight(driver)
    (arrow,) = counted()
    assert arrow.left < rect.left + 30
    driver.click(driver.page.time_controls.buttons["fit"].rect.center)
    assert in_sight(driver)
    assert not counted()


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
