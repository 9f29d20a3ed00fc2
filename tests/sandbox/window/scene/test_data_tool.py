"""Data of one's own over the plots, and signals chosen for a plot."""

import numpy as np
import pygame
import pytest
from softcradle.sandbox.session.measured_data import MeasuredData
from softcradle.sandbox.window.plots.board import PlotBoard
from softcradle.sandbox.window.plots.data_overlay import NumbersOverlay, PictureOverlay, edges_of
from softcradle.sandbox.window.plots.kinds import QUANTITIES, Signal, pair_of, signal_of
from softcradle.sandbox.window.plots.scales import estimated_scales

from tests.helpers.sessions import opened
from tests.helpers.windows import Driver


@pytest.fixture
def played(driver: Driver) -> Driver:
    """A session in the middle of its collision."""
    driver.session.step_frames(300)
    driver.frames(3)
    return driver


def test_a_table_that_is_dropped_lies_over_the_velocities(played: Driver, tmp_path) -> None:
    """What the session itself did, as if it had been measured with an error of 0.25 m/s."""
    motion = played.session.trajectory(0)
    table = np.column_stack([motion.time, motion.velocity + 0.25])[::20]
    np.savetxt(tmp_path / "track.csv", table, delimiter=",", header="t,v0,v1,v2,v3,v4", comments="")
    plot = played.page.board.plots[0]
    before = pygame.surfarray.array3d(played.app.surface.subsurface(plot.area))
    played.move(plot.area.center)
    played.drop_file(tmp_path / "track.csv")
    assert "differ by 0.25 (root mean square)" in played.messages[-1]
    after = pygame.surfarray.array3d(played.app.surface.subsurface(plot.area))
    assert (before != after).any(axis=2).sum() > 200
    overlay = played.page.board.overlays["velocities", 0][0]
    assert overlay.differences(plot) == pytest.approx(0.25)
    x = round(plot.area.left + plot.span.x(float(overlay.data.time[3])))
    y = round(plot.area.top + float(plot.y(overlay.data.values[3, 1])))
    ring = pygame.surfarray.array3d(played.app.surface)[x - 5 : x + 6, y - 5 : y + 6].astype(int)
    assert (np.ptp(ring, axis=2) > 40).any()  # in the colour of the bead
    played.key(pygame.K_x)
    assert not played.page.board.overlays
    (tmp_path / "many.csv").write_text("t,a,b,c,d,e,f\n0,1,1,1,1,1,1\n1,1,1,1,1,1,1\n")
    played.drop_file(tmp_path / "many.csv")
    assert "has 6 columns after the time, and the plot has 5 curves" in played.messages[-1]
    assert not played.page.board.overlays


def test_numbers_are_compared_with_what_the_plot_shows_at_all_times_of_the_history() -> None:
    """Between two blocks of it too."""
    session = opened("steel-and-soft")
    session.step_frames(600)
    first, second = (session.trajectory(lane) for lane in (0, 1))
    middle = 0.5 * (first.time[1:] + first.time[:-1])
    exact = [np.interp(middle, first.time, column) for column in (second.velocity - first.velocity).T]
    overlay = NumbersOverlay(MeasuredData("exact.csv", ("v",) * len(exact), middle, np.column_stack(exact)))
    board, place = PlotBoard(session, lambda: 0.0), pygame.Rect(0, 0, 800, 600)
    board.build([[("difference", 0)]], [[place]], 1.0, estimated_scales(session.scene, session))
    found = overlay.differences(board.plots[0])
    assert found.shape == (600 * len(exact),)
    assert abs(found).max() < 1e-12


def test_a_picture_lies_over_the_kymograph_where_its_edges_are_said_to_be(played: Driver, tmp_path) -> None:
    picture = pygame.Surface((40, 20))
    picture.fill((255, 0, 0))
    pygame.image.save(picture, str(tmp_path / "camera.png"))
    played.drop_file(tmp_path / "camera.png")
    played.answer("0.5 1.5 4 2")
    played.frames(2)
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
    """At the first level, which shows one plot, and in a row that is scrolled to."""
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
    played.frames(3)
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


def test_signals_are_read_and_what_are_no_signals_or_edges_is_refused():
    assert [str(signal_of(str(signal_of(letter + "0", 3)), 3)) for letter in "xvpedrf"] == [f"{k}0" for k in "xvpedrf"]
    assert pair_of("f1-2, d1", 3) == (Signal("f", 1), Signal("d", 1))
    assert set(QUANTITIES) == set("txvpedrfs")
    for text in (
        "f0",
        "f0 d0 e0",
        "g0 against t",
        "v3 against t",
        "v against t",
        "f2-1 against t",
        "f0-2, t",
        "v0-1, t",
        "t, f-1",
    ):
        with pytest.raises(ValueError, match=r"two signals|is no signal|numbered 0 to 2"):
            pair_of(text, 3)
    for text in ("", "1 2 3", "0 1 a b", "1 0 0 1", "0 1 2 2", "0 inf 0 1"):
        with pytest.raises(ValueError, match=r"four numbers|t right"):
            edges_of(text)
