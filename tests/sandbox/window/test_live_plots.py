"""What the plots of the window show: curves, cursor, marks, two lanes, the kymograph."""

from __future__ import annotations

import numpy as np
import pygame
import pytest
from softcradle.sandbox.draw.palette import bead_colours
from softcradle.sandbox.session.history_slices import slice_at
from softcradle.sandbox.window.plots.plot_kinds import StackPlot

from tests.helpers.windows import Driver

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT
pytestmark = pytest.mark.usefixtures("own_folder")


def test_marks_stand_where_contacts_switch(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(200)
    driver.key(pygame.K_HOME)
    driver.key(pygame.K_PERIOD, SHIFT)
    before, after = driver.session.history.snapshot(driver.session.frame - 1), driver.session.lanes[0].state
    assert before.states[0].overlap[0] <= 0.0 < after.overlap[0]
    assert abs(after.time - 1.0) < 0.02  # the striker flies 1 m at 1 m/s


def test_the_energy_split_shows_beads_that_are_gone(driver: Driver) -> None:
    """What was drawn of five beads is drawn again when the plot opens beside four, all the piles in it."""
    driver.key(pygame.K_SPACE)
    driver.frames(90)
    driver.key(pygame.K_SPACE)
    for bead in (4, 3):
        driver.click(driver.bead(bead))
        driver.key(pygame.K_DELETE)
        driver.frames(3)
    assert driver.session.lanes[0].chain.contacts == 2
    board = driver.play.board
    if "energy" not in board.shown:
        driver.key(pygame.K_4)
    driver.frames(30)
    energy = next(plot for plot in board.plots if isinstance(plot, StackPlot))
    assert energy.complete
    first = round(driver.session.history.first_time / energy.span.column)
    pile = pygame.surfarray.array3d(energy.ink(first + 5, first + 6))[0]
    assert {bead_colours(5)[0]} <= {tuple(colour) for colour in pile.tolist()}


def test_every_plot_can_be_hidden_and_shown(driver: Driver) -> None:
    kinds = ("velocities", "forces", "overlaps", "energy", "strip", "kymograph")
    driver.key(pygame.K_SPACE)
    driver.frames(100)
    shown = set(driver.play.board.shown)
    keys = (pygame.K_1, pygame.K_2, pygame.K_3, pygame.K_4, pygame.K_5, pygame.K_7)
    for key, kind in zip(keys, kinds, strict=True):
        driver.key(key)
        driver.frames(2)
        shown ^= {kind}
        assert set(driver.play.board.shown) == shown
    assert shown == {"energy", "strip", "kymograph"}
    driver.key(pygame.K_b)
    assert driver.play.board.plots == []
    driver.key(pygame.K_b)
    assert len(driver.play.board.plots) == 3


def test_the_kymograph_shows_where_the_beads_were(driver: Driver) -> None:
    driver.key(pygame.K_7)
    driver.key(pygame.K_SPACE)
    driver.frames(150)
    driver.key(pygame.K_SPACE)
    driver.frames(60)
    plot = next(plot for plot in driver.play.board.plots if plot.title.startswith("markers"))
    session = driver.session
    frame = session.frame - 20
    values = plot.now(frame)
    moment = session.history.snapshot(frame)
    length = session.scene.view.length
    overlap = slice_at(session.history, 0, frame).overlap[0]
    assert np.diff(values) == pytest.approx(
        length - overlap, abs=1e-9
    )  # neighbours are a bead less their overlap apart
    x = round(plot.span.x(moment.time))
    column = pygame.surfarray.array3d(plot.sheet.surface)[x].sum(axis=1)
    for place in plot.y(values):
        assert column[max(round(place) - 1, 0) : round(place) + 2].min() < 250  # ink
    band = plot.y(values + 0.25 * length).round().astype(int)
    assert all(300 < column[row] < 740 for row in band)  # the body's pale colour, no ink and no paper


def test_plots_ink_the_curves_and_the_cursor_reads_them(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(150)
    plot = driver.play.board.plots[0]
    striker = pygame.mask.from_threshold(plot.sheet.surface, plot.colours[0], (60, 60, 60, 255))
    assert striker.count() > 60
    driver.move(plot.area.center)
    driver.frames(2)
    assert driver.play.board.at(plot.area.center) is plot
    frame = driver.session.history.frame_at(driver.play.board.span.time(plot.area.width / 2))
    assert plot.now(frame).shape == (5,)


def test_overlap_axis_is_logarithmic_or_plain(driver: Driver) -> None:
    assert driver.play.board.plots[2].axis.logarithmic
    driver.key(pygame.K_o)
    assert not driver.play.board.plots[2].axis.logarithmic


def test_two_lanes_share_the_clock_and_show_their_difference() -> None:
    driver = Driver("beads-against-gear")
    driver.key(pygame.K_SPACE)
    driver.frames(120)
    first, second = driver.session.lanes
    assert first.state.time == second.state.time
    apart = [plot for plot in driver.play.board.plots if plot.title.startswith("second less first")]
    assert np.allclose(apart[0].now(driver.session.frame), second.velocity - first.velocity)
    assert apart[0].span is driver.play.board.plots[0].span
    driver.close()
