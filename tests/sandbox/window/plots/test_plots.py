"""The live plots: curves, cursor, stacked energies, the kymograph, two lanes; an entry of the table is all that one needs."""

from itertools import pairwise

import numpy as np
import pygame
import pytest
from softcradle.sandbox.draw.axes import linear_axis
from softcradle.sandbox.draw.palette import bead_colours
from softcradle.sandbox.session.history_slices import slice_at
from softcradle.sandbox.session.inputs import AddBead, RemoveBead
from softcradle.sandbox.window.plots.curves import PlotContent, ScrollingSurface, TimeSpan
from softcradle.sandbox.window.plots.kinds import PLOT_KINDS, PlotKind, PlotSetting, Signal
from softcradle.sandbox.window.plots.scales import estimated_scales
from softcradle.sandbox.window.plots.shapes import StackedPlot, StripPlot

from softcradle import scenes
from tests.helpers.sessions import opened
from tests.helpers.windows import Driver


def test_plots_and_their_cursor_show_frames_from_before_beads_were_removed() -> None:
    """There are then more values than names, and more than are listed; a plot that opens later has layers of these beads."""
    driver = Driver("one-on-ten")
    board = driver.page.board
    board.pair = Signal("v", 13), Signal("t")
    driver.key(pygame.K_8)
    for _ in range(3):
        driver.session.apply(AddBead(0, 1))
    driver.session.step_frames(90)
    for _ in range(4):
        driver.session.apply(RemoveBead(0, 1))
    driver.key(pygame.K_4)
    driver.session.step_frames(5)
    driver.frames(30)
    assert ("x-y", 0) in board.keys
    for plot in board.plots:
        for x in range(plot.area.left, plot.area.right, 7):
            board.paint_reading(driver.app.surface, (x, plot.area.centery))
    energy = next(plot for plot in board.plots if isinstance(plot, StackedPlot))
    assert energy.complete
    column = pygame.surfarray.array3d(energy.draw_columns(5, 6))[0]
    assert {bead_colours(14)[0]} <= {tuple(colour) for colour in column.tolist()}


def test_every_plot_can_be_hidden_and_shown_and_overlaps_on_a_linear_axis(driver: Driver) -> None:
    assert driver.page.board.plots[2].axis.logarithmic
    driver.key(pygame.K_o)
    assert not driver.page.board.plots[2].axis.logarithmic
    driver.run(100)
    shown = set(driver.page.board.shown)
    for name in ("velocities", "forces", "overlaps", "energy", "space-time", "kymograph"):
        driver.key(PLOT_KINDS[name].key)
        driver.frames(2)
        shown ^= {name}
        assert set(driver.page.board.shown) == shown
    assert shown == {"energy", "space-time", "kymograph"}
    driver.key(PLOT_KINDS["difference"].key)
    assert any("needs two lanes" in text for text in driver.messages)
    driver.key(pygame.K_b)
    assert driver.page.board.plots == []
    driver.key(pygame.K_b)
    assert len(driver.page.board.plots) == 3


def test_the_kymograph_shows_where_the_beads_were(driver: Driver) -> None:
    driver.key(pygame.K_7)
    driver.play(150)
    driver.frames(60)
    plot = next(plot for plot in driver.page.board.plots if plot.content.title.startswith("markers"))
    session = driver.session
    frame = session.frame - 20
    values = plot.values_at(frame)
    time = session.history.snapshot(frame).time
    length = session.scene.view.length
    overlap = slice_at(session.history, 0, frame).overlap[0]
    assert np.diff(values) == pytest.approx(length - overlap, abs=1e-9)  # the distance of neighbours
    x = round(plot.span.x(time))
    column = pygame.surfarray.array3d(plot.curves.surface)[x].sum(axis=1)
    for place in plot.y(values):
        assert column[max(round(place) - 1, 0) : round(place) + 2].min() < 250  # a marker
    band = plot.y(values + 0.25 * length).round().astype(int)
    assert all(300 < column[row] < 740 for row in band)  # the pale colour of a bead


def test_two_lanes_share_the_clock_and_show_their_difference() -> None:
    driver = Driver("beads-against-gear")
    driver.run(120)
    first, second = driver.session.lanes
    assert first.state.time == second.state.time
    board = driver.page.board
    difference = board.plots[board.keys.index(("difference", 0))]
    assert np.allclose(difference.values_at(driver.session.frame), second.velocity - first.velocity)
    assert difference.span is board.plots[0].span
    driver.key(PLOT_KINDS["difference"].key)
    assert "difference" not in board.shown
    assert not driver.messages


def test_each_plot_of_two_lanes_says_whose_it_is() -> None:
    titles = [one.text for one in Driver("steel-and-soft").texts() if "(m" in one.text or "(N)" in one.text]
    assert sum(title.split(" · ")[-1].startswith("steel") for title in titles) == 3
    assert sum(title.split(" · ")[-1].startswith("soft") for title in titles) == 3


def test_the_time_axis_scrolls_only_when_it_must():
    span = TimeSpan(8.0, 400)
    span.follow(7.0)
    assert span.left == 0
    span.follow(9.0)
    assert span.x(9.0) == pytest.approx(0.92 * 400, abs=1.0)
    assert span.time(span.x(9.0)) == pytest.approx(9.0)
    span.follow(0.0)
    assert span.left == 0


class Columns:
    """Draws the number of each column into its pixels, and records which it drew."""

    def __init__(self):
        self.drawn = []

    def __call__(self, first, last):
        self.drawn += range(first, last)
        made = pygame.Surface((last - first, 4), 0, 32)
        for x in range(last - first):
            made.fill(((first + x) % 256, 1, 0), (x, 0, 1, 4))
        return made


def pixels(surface):
    return [tuple(surface.surface.get_at((x, 0)))[:2] for x in range(surface.width)]


def test_every_column_is_in_its_place_after_any_scrolling():
    surface = ScrollingSurface(pygame.Surface((50, 4), 0, 32), Columns())
    for left, first, last in ((0, 0.0, 20.5), (0, 0.0, 49.9), (30, 0.0, 70.0), (10, 5.0, 70.0), (200, 150.0, 240.0)):
        surface.scroll(left)
        for _ in range(20):
            surface.update(first, last, True, 10)
        for x, pixel in enumerate(pixels(surface)):
            column = left + x
            assert pixel == ((column % 256, 1) if int(first) <= column <= int(last) else (0, 0))


def test_an_update_stays_within_its_budget_draws_nothing_twice_and_clears_a_dropped_branch():
    columns = Columns()
    surface = ScrollingSurface(pygame.Surface((50, 4), 0, 32), columns)
    surface.update(0.0, 49.0, True, 10)
    assert len(columns.drawn) <= 12
    for _ in range(10):
        surface.update(0.0, 49.0, False, 10)
    columns.drawn.clear()
    surface.update(0.0, 49.0, False, 10)
    assert columns.drawn == []
    surface.invalidate_from(20)
    surface.update(0.0, 21.0, True, 10)
    assert pixels(surface)[22:] == [(0, 0)] * 28


def momentum(setting: PlotSetting) -> PlotContent:
    axis = linear_axis("", *setting.scales.momentum)
    return PlotContent("momentum (N s)", axis, setting.bead_names("p"), setting.colours, lambda motion: motion.momentum)


MOMENTUM = PlotKind("momentum", pygame.K_8, "momentum of each bead", momentum)


def test_a_plot_in_the_table_has_its_key_and_its_place_on_the_board(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(PLOT_KINDS, MOMENTUM.name, MOMENTUM)
    driver = Driver("one-on-four")
    board = driver.page.board
    assert "momentum" not in board.shown
    driver.key(pygame.K_8)
    driver.run(60)
    plot, lane = board.plots[board.keys.index(("momentum", 0))], driver.session.lanes[0]
    assert plot.values_at(driver.session.frame) == pytest.approx(np.array(lane.chain.mass) * lane.velocity)
    drawn = pygame.mask.from_threshold(plot.curves.surface, plot.content.colours[0], (60, 60, 60, 255))
    assert drawn.count() > 20
    driver.key(pygame.K_8)
    assert "momentum" not in board.shown


def test_the_choice_of_plots_is_remembered() -> None:
    for name in ("energy", "forces"):
        driver = Driver("one-on-four")
        driver.key(PLOT_KINDS[name].key)
        driver.close()
    for scene, more in (("one-on-four", []), ("beads-against-gear", ["difference"])):  # which one lane cannot show
        driver = Driver(scene)
        assert sorted(driver.page.board.shown) == sorted(["velocities", "overlaps", "energy", *more])
        driver.close()


def test_no_difference_of_two_lanes_is_cut_by_its_axis():
    scales = estimated_scales(scenes.load("beads-against-gear"), opened("beads-against-gear"))
    for lane, (low, high) in enumerate((scales.velocity, (scales.pull, scales.force))):
        axis = PLOT_KINDS["difference"].content(PlotSetting(scales, lane, 4, 1.0, True)).axis
        assert axis.low <= low - high
        assert axis.high >= high - low


def test_space_time_has_a_scale_of_its_shades(driver):
    driver.key(pygame.K_5)
    driver.frames(3)
    plot = next(plot for plot in driver.page.board.plots if isinstance(plot, StripPlot))
    x = plot.area.right + round(6 * plot.unit) + 3
    column = [sum(driver.app.surface.get_at((x, y))[:3]) for y in range(plot.area.top + 2, plot.area.bottom - 2)]
    assert column[0] < 200  # the greatest force is dark
    assert column[-1] > 700
    assert all(b >= a - 3 for a, b in pairwise(column))
