"""The table of live plots: an entry is all that a plot needs."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pygame
import pytest
from softcradle.sandbox.draw.curve_panels import linear_axis
from softcradle.sandbox.window.plots.curves import Plot, PlotContent
from softcradle.sandbox.window.plots.kinds import PLOT_KINDS, PlotKind, PlotSetting
from softcradle.sandbox.window.plots.scales import estimated_scales
from softcradle.sandbox.window.plots.shapes import StripPlot

from softcradle import scenes
from tests.helpers.sessions import opened
from tests.helpers.windows import Driver


def momentum(setting: PlotSetting) -> PlotContent:
    axis = linear_axis("", *setting.scales.momentum)
    return PlotContent("momentum (N s)", axis, setting.bead_names("p"), setting.colours, lambda motion: motion.momentum)


MOMENTUM = PlotKind("momentum", pygame.K_8, "momentum of each bead", momentum)


def plots_of_momentum(driver: Driver) -> list[Plot]:
    return [plot for plot in driver.page.board.plots if plot.content.title == "momentum (N s)"]


def test_a_plot_in_the_table_has_its_key_and_its_place_on_the_board(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(PLOT_KINDS, MOMENTUM.name, MOMENTUM)
    driver = Driver("one-on-four")
    assert plots_of_momentum(driver) == []
    driver.key(pygame.K_8)
    driver.key(pygame.K_SPACE)
    driver.frames(60)
    (plot,) = plots_of_momentum(driver)
    lane = driver.session.lanes[0]
    assert plot.values_at(driver.session.frame) == pytest.approx(np.array(lane.chain.mass) * lane.velocity)
    drawn = pygame.mask.from_threshold(plot.curves.surface, plot.content.colours[0], (60, 60, 60, 255))
    assert drawn.count() > 20
    driver.key(pygame.K_8)
    assert plots_of_momentum(driver) == []


def test_a_page_opens_with_the_plots_that_the_table_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(PLOT_KINDS, MOMENTUM.name, replace(MOMENTUM, shown=True))
    driver = Driver("one-on-four")
    assert len(plots_of_momentum(driver)) == 1
    assert driver.page.board.shown == ["velocities", "forces", "overlaps", "momentum"]


def test_the_choice_of_plots_is_remembered() -> None:
    for name in ("energy", "forces"):
        driver = Driver("one-on-four")
        driver.key(PLOT_KINDS[name].key)
        driver.close()
    for scene, more in (("one-on-four", []), ("beads-against-gear", ["difference"])):  # which one lane cannot show
        driver = Driver(scene)
        assert sorted(driver.page.board.shown) == sorted(["velocities", "overlaps", "energy", *more])
        driver.close()


def test_a_plot_of_two_lanes_exists_only_beside_two() -> None:
    for scene, lanes in (("one-on-four", 1), ("beads-against-gear", 2)):
        driver = Driver(scene)
        assert ("difference" in driver.page.board.shown) == (lanes == 2)
        driver.key(PLOT_KINDS["difference"].key)
        assert any("needs two lanes" in text for text in driver.messages) == (lanes == 1)
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
