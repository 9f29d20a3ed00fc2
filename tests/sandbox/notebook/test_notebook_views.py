"""Tests of the notebook views of results and scenes.

The tests check short texts, figures, films, tables for other Python packages, and opening the window.
"""

import base64
import math
import re
import sys

import av
import numpy as np
import pandas as pd
import pytest
from softcradle.sandbox.notebook.views import play
from softcradle.sandbox.story.numbers import MINUS
from softcradle.sandbox.user_error import UserError

from softcradle import Chain, Coupler, Trajectory, draft_gear, hertz, one_on, power_law, scenes, simulate

CHAIN = one_on(4, power_law(1.0, 0.1))


@pytest.fixture(scope="module")
def found() -> Trajectory:
    return simulate(CHAIN, [1, 0, 0, 0, 0], method="conserving", step=1e-2)


def test_notebook_texts_are_short(found):
    assert repr(CHAIN).startswith("Chain(mass=5 x 1.0, contact=4 x Contact(")
    assert re.match(r"Trajectory of 5 beads, 0 to 2\.\d+ s in 201 samples, by conserving", repr(found))
    assert repr(scenes.load("galilean")) == "Scene('Who hits whom?', 5 beads and 5 beads)"
    mixed = repr(Chain([1, 2, math.inf], [hertz(1), draft_gear(5, 0.2)], gap=[0, 0.1], friction=0.1))
    assert "mass=[1.0, 2.0, inf]" in mixed
    assert "friction=0.1" in mixed
    assert len(repr(one_on(1000, hertz(1), np.linspace(1, 2, 1001)))) < 200
    assert "power_law(1, 0.1)" in CHAIN._repr_html_()
    assert "<td>wall, 2</td>" in Chain([np.inf, 2], hertz(1))._repr_html_()
    shown = scenes.load("one-on-four").model_copy(update={"title": "<b>"})._repr_html_()
    assert "&lt;b&gt;" in shown
    assert "alpha = 1/10" in shown


@pytest.mark.parametrize("n", [4, 200])
def test_a_trajectory_is_a_picture_and_two_tables(n):
    shown = simulate(one_on(n, hertz(1.0)), [1] + [0] * n, duration=1.0, method="verlet", step=1e-2)._repr_html_()
    beads, contacts = shown.split("<table>")[1:]
    assert max(beads.count("<tr>"), contacts.count("<tr>")) <= 13
    assert "final velocity [m/s]" in beads
    assert "largest force [N]" in contacts
    data = re.search(r'src="data:image/png;base64,([^"]+)"', shown)
    assert base64.b64decode(data[1]).startswith(b"\x89PNG")


def test_a_figure_is_shown_without_any_setting(found, tmp_path):
    figure = found.plot()
    assert figure._repr_png_().startswith(b"\x89PNG")
    assert len(figure.axes) == 2
    assert len(figure.axes[0].lines) == 6  # The six lines are the curves of five beads and the line at 0.
    np.testing.assert_array_equal(figure.axes[1].lines[0].get_ydata(), found.force[:, 0])
    figure.savefig(tmp_path / "figure.pdf")
    pulled = simulate(Chain([1, 1], Coupler(hertz(1), hertz(9))), [0, 1], 3.0)
    # The axes must show all forces, including negative forces and the larger forces of a second row of beads.
    for shown in (pulled, scenes.load("stiff-springs")):
        axes = shown.plot().axes
        for panel in axes[len(axes) // 2 :]:
            low, high = panel.get_ylim()
            assert all(low <= line.get_ydata().min() and line.get_ydata().max() <= high for line in panel.lines)
    assert len(axes) == 4


def test_a_film_is_shown_and_saved(found, tmp_path):
    film = found.film(slow=1.0, size=(320, 180))
    assert "data:video/mp4;base64," in film._repr_html_()
    assert repr(film).startswith("InlineFilm of 320x180 pixels, ")
    film.save(tmp_path / "film.mp4")
    with av.open(str(tmp_path / "film.mp4")) as container:
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    assert len(frames) == pytest.approx(30.0 * found.time[-1], abs=2)
    # The first frame and the last frame differ because the beads have moved.
    assert np.abs(frames[0].astype(int) - frames[-1]).max() > 50


def test_a_page_plays_the_samples(found, tmp_path):
    found.to_page(tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "5 beads, by conserving" in text
    assert "power_law(1, 0.1)" in text
    assert 'data-say="file"' in text
    # The limits of slow motion are the same as for films.
    with pytest.raises(UserError, match="slow motion must be from 1e-20"):
        found.to_page(tmp_path / "page.html", slow=0.0)
    # These samples begin at t = 1 s and do not include the start of the motion.
    late = simulate(CHAIN, [1, 0, 0, 0, 0], samples=np.linspace(1, 3, 51))
    late.to_page(tmp_path / "late.html")
    assert 'data-say="file"' not in (tmp_path / "late.html").read_text(encoding="utf-8")
    assert f"<td>0</td><td>1</td><td>-</td><td>{MINUS}0.56" in late._repr_html_()


def test_a_scene_lives_in_a_cell_and_in_a_file(tmp_path, monkeypatch):
    scene = scenes.load("one-on-four").model_copy(update={"title": "<b>'\""})
    monkeypatch.setitem(
        sys.modules, "anywidget", None
    )  # Without it the cell shows the page and does not report its state.
    monkeypatch.delitem(sys.modules, "softcradle.sandbox.notebook.live_widget", raising=False)
    cell = scene.live()
    shown = cell._repr_html_()
    assert shown.startswith("<iframe ")
    # The only tags are `<iframe>` and its end. The text of the page is escaped in an attribute.
    assert shown.count("<") == 2
    scene.to_page(tmp_path / "page.html")
    cell.save(tmp_path / "cell.html")
    assert (tmp_path / "cell.html").read_text() == (tmp_path / "page.html").read_text()


def test_exported_samples_have_units(found, tmp_path):
    data = found.to_xarray()
    assert dict(data.sizes) == {"time": 201, "bead": 5, "contact": 4}
    np.testing.assert_array_equal(data.force.sel(contact=2), found.force[:, 2])
    assert data.velocity.attrs["units"] == "m/s"
    assert data.kinetic_energy.dims == ("time",)
    assert data.attrs["method"] == "conserving"
    frame = found.to_pandas()
    found.to_csv(tmp_path / "x.csv")
    pd.testing.assert_frame_equal(frame, pd.read_csv(tmp_path / "x.csv", index_col="time [s]"))
    assert frame.attrs["status"] == "separated"


def test_the_window_returns_its_history(monkeypatch, own_folder):
    def run(app):
        for _ in range(30):
            app.frame(1 / 60, [])
        app.close()

    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.setattr("softcradle.sandbox.window.app.App.run", run)
    (history,) = play(scenes.load("one-on-four"), size=(960, 540))
    assert history.chain == scenes.load("one-on-four").lanes[0].chain()
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER", "SDL_VIDEO_DRIVER"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(UserError, match="there is no display"):
        play("one-on-four")
