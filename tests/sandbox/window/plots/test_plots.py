"""Tests of the live plots: the curves, the cursor, energies, kymographs, and plots of two rows of beads.

The tests also check plots of selected quantities, and measured data that is drawn over a plot.
"""

from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pygame
import pytest
from softcradle.sandbox.draw.axes import linear_axis
from softcradle.sandbox.draw.palette import bead_colours
from softcradle.sandbox.languages import LANGUAGES, scene_words, use_language
from softcradle.sandbox.session.history_slices import slice_at
from softcradle.sandbox.session.inputs import AddBead, RemoveBead
from softcradle.sandbox.window.plots import kinds
from softcradle.sandbox.window.plots.board import paint_readout
from softcradle.sandbox.window.plots.curves import ScrollingSurface, TimeSpan
from softcradle.sandbox.window.plots.data_overlay import PictureOverlay, edges_of
from softcradle.sandbox.window.plots.kinds import PLOT_KINDS, PlotSetting, Signal, pair_of, signal_of
from softcradle.sandbox.window.plots.scales import LiveScales, estimated_scales
from softcradle.sandbox.window.plots.shapes import StackedPlot, StripPlot

from softcradle import scenes
from tests.helpers.drawn_text import drawn_texts
from tests.helpers.sessions import opened
from tests.helpers.windows import Driver


def test_plots_show_frames_with_more_beads_than_now() -> None:
    """Check that plots show earlier frames that have more beads than the current frame.

    Earlier frames contain more values than the plot has names. A plot that is opened later also draws the removed
    beads.
    """
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


def test_plots_are_hidden_and_shown(driver: Driver) -> None:
    assert driver.page.board.plots[2].axis.logarithmic
    driver.key(pygame.K_o)
    assert not driver.page.board.plots[2].axis.logarithmic
    driver.run(100)
    plot = driver.page.board.plots[0]
    assert plot.values_at(driver.session.frame) == pytest.approx(driver.session.lanes[0].velocity)
    drawn = pygame.mask.from_threshold(plot.curves.surface, plot.content.colours[0], (60, 60, 60, 255))
    assert drawn.count() > 20
    shown = set(driver.page.board.shown)
    for name in ("velocities", "forces", "overlaps", "energy", "space-time", "kymograph"):
        driver.key(PLOT_KINDS[name].key)
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
    length = session.scene.view.length
    overlap = slice_at(session.history, 0, frame).overlap[0]
    # The distance between two neighbouring beads is the length of a bead minus the overlap.
    assert np.diff(values) == pytest.approx(length - overlap, abs=1e-9)
    x = round(plot.span.x(session.history.snapshot(frame).time))
    column = pygame.surfarray.array3d(plot.curves.surface)[x].sum(axis=1)
    for place in plot.y(values):
        # The position of each bead has a dark marker.
        assert column[max(round(place) - 1, 0) : round(place) + 2].min() < 250
    band = plot.y(values + 0.25 * length).round().astype(int)
    assert all(300 < column[row] < 740 for row in band)  # The area next to a marker has the pale colour of the bead.


def test_two_lanes_show_their_difference() -> None:
    driver = Driver("steel-and-soft")
    driver.run(120)
    first, second = driver.session.lanes
    assert first.state.time == second.state.time
    board = driver.page.board
    difference = board.plots[board.keys.index(("difference", 0))]
    assert np.allclose(difference.values_at(driver.session.frame), second.velocity - first.velocity)
    assert difference.span is board.plots[0].span
    driver.session.apply(RemoveBead(1, 0))
    assert "difference" not in board.shown  # After a bead is removed, the two rows of beads cannot be compared.
    driver.session.undo()
    assert "difference" in board.shown
    driver.key(PLOT_KINDS["difference"].key)
    assert "difference" not in board.shown
    assert not driver.messages


def numbered(first: int, last: int) -> pygame.Surface:
    """Return a surface on which the colour of each column is its number."""
    return pygame.surfarray.make_surface(np.array([[(x % 256, 1, 0)] * 4 for x in range(first, last)]))


def pixels(surface):
    return [tuple(surface.surface.get_at((x, 0)))[:2] for x in range(surface.width)]


def test_the_time_axis_scrolls_only_if_needed():
    span = TimeSpan(8.0, 400)
    span.follow(7.0)
    assert span.left == 0
    span.follow(9.0)
    assert span.x(9.0) == pytest.approx(0.92 * 400, abs=1.0)
    assert span.time(span.x(9.0)) == pytest.approx(9.0)
    span.follow(0.0)
    assert span.left == 0
    surface = ScrollingSurface(pygame.Surface((50, 4), 0, 32), numbered)
    for left, first, last in ((0, 0.0, 20.5), (0, 0.0, 49.9), (30, 0.0, 70.0), (10, 5.0, 70.0), (200, 150.0, 240.0)):
        surface.scroll(left)
        for _ in range(20):
            surface.update(first, last, True, 10)
        columns = range(left, left + surface.width)
        assert pixels(surface) == [(x % 256, 1) if int(first) <= x <= int(last) else (0, 0) for x in columns]


def test_an_update_of_plots_stays_within_its_budget():
    draw = Mock(side_effect=numbered)
    surface = ScrollingSurface(pygame.Surface((50, 4), 0, 32), draw)
    surface.update(0.0, 49.0, True, 10)
    assert sum(last - first for (first, last), _ in draw.call_args_list) <= 12
    for _ in range(10):
        surface.update(0.0, 49.0, False, 10)
    draw.reset_mock()
    surface.update(0.0, 49.0, False, 10)
    draw.assert_not_called()
    surface.invalidate_from(20)
    surface.update(0.0, 21.0, True, 10)
    assert pixels(surface)[22:] == [(0, 0)] * 28


def test_the_choice_of_plots_is_remembered() -> None:
    for name in ("energy", "forces"):
        driver = Driver("one-on-four")
        driver.key(PLOT_KINDS[name].key)
        driver.close()
    # The plot of differences needs two rows of beads.
    for scene, more in (("one-on-four", []), ("beads-against-gear", ["difference"])):
        driver = Driver(scene)
        assert sorted(driver.page.board.shown) == sorted(["velocities", "overlaps", "energy", *more])


@pytest.mark.parametrize("code", LANGUAGES)
def test_titles_without_room_still_name_their_lanes(code: str) -> None:
    driver = Driver("beads-against-gear")
    use_language(code)
    for shown in (3, 4):
        driver.app.rebuild()
        titles = [one.text.split(" · ") for one in driver.texts() if " · " in one.text]
        starts = [scene_words(lane.label)[:2] for lane in driver.session.scene.lanes]
        assert [title[1][:2] for title in titles] == [start for start in starts for _ in range(shown)], titles
        driver.key(PLOT_KINDS["kymograph"].key)


def test_no_difference_of_two_lanes_is_cut_by_its_axis():
    scales = estimated_scales(scenes.load("beads-against-gear"), opened("beads-against-gear"))
    for lane, (low, high) in enumerate((scales.velocity, (scales.pull, scales.force))):
        axis = PLOT_KINDS["difference"].content(PlotSetting(scales, lane, 4, 1.0, True)).axis
        assert axis.low <= low - high
        assert axis.high >= high - low


def test_the_energy_bar_has_room_for_what_was_absorbed():
    session = opened("experiment-one-on-three")
    scales = LiveScales(session)
    scales.take(estimated_scales(session.scene, session))
    absorbed = 10.0 * scales.scales.energy
    scales.fit([replace(session.lanes[0].motion, absorbed=np.array([absorbed]))])
    assert scales.scales.energy > absorbed


def test_space_time_has_a_scale_of_its_shades(driver):
    driver.key(pygame.K_5)
    plot = next(plot for plot in driver.page.board.plots if isinstance(plot, StripPlot))
    x = plot.area.right + round(6 * plot.unit) + 3
    column = [sum(driver.app.surface.get_at((x, y))[:3]) for y in range(plot.area.top + 2, plot.area.bottom - 2)]
    assert column[0] < 200  # The largest force has the darkest shade.
    assert column[-1] > 700
    assert min(np.diff(column)) >= -3


@pytest.fixture
def played(driver: Driver) -> Driver:
    driver.session.step_frames(300)  # After 300 frames, the beads collide.
    driver.frames(3)
    return driver


def test_a_table_that_is_dropped_lies_over_the_velocities(played: Driver, tmp_path) -> None:
    """Check that a dropped table of measured data is drawn over the plot of the velocities.

    The data are values of the session between two frames, with an added error of 0.25 m/s. The data cross the border
    between two blocks of the history.
    """
    played.session.step_frames(300)
    played.frames(3)
    motion = played.session.trajectory(0)
    rows = np.column_stack([motion.time, motion.velocity + 0.25])
    table = 0.5 * (rows[1:] + rows[:-1])[11::20]  # One value of the table lies between the samples 512 and 513.
    np.savetxt(tmp_path / "track.csv", table, delimiter=",", header="t,v0,v1,v2,v3,v4", comments="")
    plot = played.page.board.plots[0]
    played.move(plot.area.center)
    played.drop_file(tmp_path / "track.csv")
    assert "differ by 0.25 (root mean square)" in played.messages[-1]
    overlay = played.page.board.overlays["velocities", 0][0]
    assert overlay.differences(plot) == pytest.approx(np.full(30 * 5, 0.25))
    x = round(plot.area.left + plot.span.x(float(overlay.time[3])))
    y = round(plot.area.top + float(plot.y(overlay.values[3, 1])))
    ring = pygame.surfarray.array3d(played.app.surface)[x - 5 : x + 6, y - 5 : y + 6].astype(int)
    assert (np.ptp(ring, axis=2) > 40).any()  # The ring around a measured value has the colour of the bead.
    played.key(pygame.K_x)
    assert not played.page.board.overlays
    played.key(pygame.K_5)
    strip = played.page.board.plots[-1]  # In a plot that shows values as shades, the height has another meaning.
    played.move(strip.area.center)
    played.drop_file(tmp_path / "track.csv")
    assert [kind for kind, _ in played.page.board.overlays] == ["velocities"]
    played.key(pygame.K_x)
    (tmp_path / "many.csv").write_text("t,v0,v1,v2,v3,v4,v5\n0,1,1,1,1,1,1\n1,1,1,1,1,1,1\n")
    played.drop_file(tmp_path / "many.csv")
    assert "has 6 columns of this quantity, and the plot has 5 curves" in played.messages[-1]
    assert not played.page.board.overlays


def test_positions_are_not_laid_over_velocities(played: Driver, tmp_path) -> None:
    (tmp_path / "track.txt").write_text("mass_A\nt\tx\ty\n0,0\t10\t1\n0,5\t11\t1\n")
    played.move(played.page.board.plots[0].area.center)
    played.drop_file(tmp_path / "track.txt")
    assert [kind for kind, _ in played.page.board.overlays] == ["kymograph"]
    assert "columns without a unit are taken to be in SI units" in played.messages[-1]
    played.key(pygame.K_x)
    (tmp_path / "phone.csv").write_text('"Time (s)","Acceleration x (m/s^2)"\n0,1\n1,2\n')
    played.drop_file(tmp_path / "phone.csv")
    assert "'Acceleration x': no velocity, position or force along the row" in played.messages[-1]
    assert not played.page.board.overlays


def test_a_picture_is_placed_on_the_kymograph(played: Driver, tmp_path) -> None:
    picture = pygame.Surface((40, 20))
    picture.fill((255, 0, 0))
    pygame.image.save(picture, str(tmp_path / "camera.png"))
    played.drop_file(tmp_path / "camera.png")
    played.answer("0.5 1.5 4 2")
    assert isinstance(played.page.board.overlays["kymograph", 0][0], PictureOverlay)
    plot = played.page.board.plots[played.page.board.keys.index(("kymograph", 0))]

    def redness(time: float, place: float) -> int:
        x, y = plot.area.left + plot.span.x(time), plot.area.top + float(plot.y(np.array(place)))
        red, green, _, _ = played.app.surface.get_at((round(x), round(y)))
        return red - green

    assert redness(1.0, 3.4) > 60
    assert redness(2.0, 3.0) < 60
    assert redness(1.0, 5.9) < 60


LARGE = [(pygame.K_d, pygame.KMOD_CTRL), *[(pygame.K_PLUS, pygame.KMOD_CTRL)] * 5]


@pytest.mark.parametrize("keys", [[(pygame.K_F3, 0)], LARGE])
def test_a_picture_finds_the_kymograph_that_is_not_on_screen(driver: Driver, tmp_path, keys) -> None:
    """Check that a dropped camera picture is drawn over the kymograph, even if the kymograph is not visible.

    The view with few controls shows only one plot. In the other view, the kymograph is in a row of plots outside the
    visible area.
    """
    pygame.image.save(pygame.Surface((4, 4)), str(tmp_path / "camera.png"))
    for code, modifiers in keys:
        driver.key(code, modifiers)
    driver.drop_file(tmp_path / "camera.png")
    driver.key(pygame.K_RETURN)
    assert driver.page.board.overlays["kymograph", 0]
    assert ("kymograph", 0) in driver.page.board.keys


def test_any_signal_is_plotted_against_any(played: Driver) -> None:
    played.key(pygame.K_8, pygame.KMOD_SHIFT)
    played.answer("p1 against s")
    board = played.page.board
    plot = board.plots[board.keys.index(("x-y", 0))]
    assert board.pair == (Signal("p", 1), Signal("s"))
    motion = played.session.lanes[0].motion
    assert plot.values_at(300).tolist() == pytest.approx([motion.momentum[0, 1], motion.stored[0]])
    assert len(plot.points()) > 200
    drawn = pygame.surfarray.array3d(played.app.surface.subsurface(plot.area)).astype(int)
    assert (np.ptp(drawn, axis=2) > 60).sum() > 50
    played.key(pygame.K_8, pygame.KMOD_SHIFT)
    played.answer("f9 against q")
    assert "the contacts of this lane are numbered 0 to 3" in played.messages[-1]


def test_signals_and_edges_are_parsed():
    assert [str(signal_of(str(signal_of(letter + "0", 3)), 3)) for letter in "xvpedrf"] == [f"{k}0" for k in "xvpedrf"]
    assert pair_of("f1-2, d1", 3) == (Signal("f", 1), Signal("d", 1))
    assert set(kinds.QUANTITIES) == set("txvpedrfs")
    unknown = "g0 against t", "v3 against t", "v against t", "f2-1 against t", "f0-2, t", "v0-1, t", "t, f-1"
    for text in ("f0", "f0 d0 e0", *unknown):
        with pytest.raises(ValueError, match=r"two signals|is unknown|numbered 0 to 2"):
            pair_of(text, 3)
    for text in ("", "1 2 3", "0 1 a b", "1 0 0 1", "0 1 2 2", "0 inf 0 1"):
        with pytest.raises(ValueError, match=r"four numbers|t right"):
            edges_of(text)


def test_curves_stay_visible_while_an_axis_changes(driver: Driver) -> None:
    """Check that curves do not disappear while a plot is drawn with a new axis.

    As on a slow computer, only 8 columns are drawn per frame. A plot of 300 columns then takes dozens of frames.
    """
    driver.play(200)
    board = driver.page.board
    plot, span, zero = board.plots[0], replace(board.span), driver.session.history
    assert plot.complete

    def left(one) -> int:
        """Return the number of pixels of a curve in the older half of the plot."""
        end = round(one.span.x(zero.last_time) / 2)
        part = one.curves.surface.subsurface((0, 0, end, one.area.height))
        return pygame.mask.from_threshold(part, one.content.colours[0], (60, 60, 60, 255)).count()

    high = 1.3 * plot.axis.high
    content = replace(plot.content, axis=linear_axis("", 1.3 * plot.axis.low, high))
    taller = type(plot)(plot.rect, plot.unit, content, plot.history, 0, board.span)
    taller.take_over(plot, span)
    taller.update(True, 8)
    assert not taller.complete
    assert left(taller) > 0.5 * left(plot)
    for _ in range(100):
        taller.update(False, 8)
    assert taller.complete
    fresh = type(plot)(plot.rect, plot.unit, content, plot.history, 0, board.span)
    for grown in (True, *[False] * 100):
        fresh.update(grown, 8)
    assert pygame.image.tobytes(taller.curves.surface, "RGB") == pygame.image.tobytes(fresh.curves.surface, "RGB")
    board.span.seconds *= 1.5
    taller.take_over(taller, span)
    taller.update(True, 8)
    assert not taller.complete
    assert left(taller) > 0


def test_a_reading_uses_the_unit_of_the_axis(driver: Driver) -> None:
    plot = driver.page.board.plots[0]
    with drawn_texts(driver.app.size) as texts:
        paint_readout(driver.app.surface, plot, plot.area.center, 0.0, np.array([1.0, 1.11e-16, 0.0, -1e-15, 0.25]))
    assert [one.text for one in texts][1:] == ["v₀ = 1.00", "v₁ = 0", "v₂ = 0", "v₃ = 0", "v₄ = 0.250"]
