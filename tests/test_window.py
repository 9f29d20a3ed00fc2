"""The real application, driven by posted events: open, play, drag, scrub, edit, switch method, save, reload, quit."""

from __future__ import annotations

import math
import time
import weakref
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pygame
import pytest

from sandbox.draw.palette import bead_colours
from sandbox.session.inputs import SetStep
from sandbox.window.cards import RED
from sandbox.window.gallery import Gallery
from sandbox.window.plot_kinds import StackPlot
from sandbox.window.records import at_frame
from sandbox.window.stage_view import Pick
from tests.windows import Driver

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SOFTCRADLE_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def driver() -> Iterator[Driver]:
    made = Driver("one-on-four")
    yield made
    made.close()


@pytest.fixture
def gallery() -> Iterator[Driver]:
    made = Driver()
    yield made
    made.close()


def test_gallery_draws_and_keeps_thumbnails_and_opens_the_scene_that_is_clicked(
    gallery: Driver, tmp_path: Path
) -> None:
    page = gallery.app.page
    assert isinstance(page, Gallery)
    patience = time.monotonic() + 90.0
    while len(page.pictures) < len(page.names) and time.monotonic() < patience:
        gallery.frames()
        pygame.time.wait(5)
    assert len(page.pictures) == len(page.names)
    assert len(list((tmp_path / "cache").glob("*.png"))) == len(page.scenes)
    chosen = page.names.index("one-on-four")
    page.selected = chosen
    page.step(0)
    gallery.click(page.place(chosen).center)
    gallery.frames(2)
    assert gallery.session.scene.title == "One bead on four"
    gallery.key(pygame.K_ESCAPE)
    again = gallery.app.page
    assert isinstance(again, Gallery)
    assert len(again.pictures) == len(again.names)  # read back from disk, at once


def test_gallery_is_used_by_keys_alone(gallery: Driver) -> None:
    page = gallery.app.page
    assert isinstance(page, Gallery)
    gallery.key(pygame.K_RIGHT)
    gallery.key(pygame.K_DOWN)
    assert page.selected == 1 + page.columns
    gallery.key(pygame.K_RETURN)
    assert gallery.session.scene == page.scenes[page.selected]


def test_a_press_that_ends_on_another_card_opens_nothing(gallery: Driver) -> None:
    page = gallery.app.page
    assert isinstance(page, Gallery)
    gallery.drag(page.place(0).center, page.place(1).center)
    gallery.release(page.place(1).center)
    gallery.click((page.place(0).centerx, 8))  # the header
    assert gallery.app.page is page
    page.scroll_to(page.pitch)
    gallery.click((page.place(0).centerx, round(90 * page.host.unit)))  # a card that is scrolled below the header
    assert gallery.app.page is page


def test_pages_and_widgets_that_are_left_do_not_stay_in_memory(gallery: Driver) -> None:
    """They go in circles, and hold their surfaces: an hour of use would keep some 100 MB of them."""
    page = gallery.app.page
    assert isinstance(page, Gallery)
    old_gallery, place = weakref.ref(page), page.place(0).center
    del page
    gallery.click(place)
    gallery.frames()
    assert old_gallery() is None
    old_page = weakref.ref(gallery.play)
    for action in ("larger", "smaller"):
        old_widget = weakref.ref(next(iter(gallery.play.transport.buttons.values())))
        gallery.app.act(action)
        gallery.frames()
        assert old_widget() is None
    gallery.key(pygame.K_ESCAPE)
    gallery.frames()
    assert isinstance(gallery.app.page, Gallery)
    assert old_page() is None


def test_space_plays_and_pauses_and_r_restarts(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(30)
    assert driver.session.playing
    assert driver.session.time > 0.1
    driver.key(pygame.K_SPACE)
    stopped = driver.session.time
    driver.frames(5)
    assert driver.session.time == stopped
    driver.key(pygame.K_r)
    assert driver.session.time == 0.0


def test_frames_forward_and_back(driver: Driver) -> None:
    for _ in range(3):
        driver.key(pygame.K_PERIOD)
    assert driver.session.frame == 3
    driver.key(pygame.K_COMMA)
    assert driver.session.frame == 2
    assert driver.session.history.last == 3


def test_timeline_scrubs_and_playing_on_starts_a_new_branch(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(200)
    last = driver.session.history.last
    line = driver.play.timeline
    y = line.rect.centery
    driver.drag((line.x(last), y), (line.x(last // 3), y))
    driver.release((line.x(last // 3), y))
    assert abs(driver.session.frame - last // 3) <= 2
    assert driver.session.scrubbed
    assert not driver.session.playing
    driver.key(pygame.K_SPACE)
    driver.frames(3)
    assert driver.session.history.last < last


def test_marks_stand_where_contacts_switch(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(200)
    driver.key(pygame.K_HOME)
    driver.key(pygame.K_PERIOD, SHIFT)
    before, after = driver.session.history.moment(driver.session.frame - 1), driver.session.lanes[0].state
    assert before.states[0].overlap[0] <= 0.0 < after.overlap[0]
    assert abs(after.time - 1.0) < 0.02  # the striker flies 1 m at 1 m/s


def test_slow_motion_by_keys_and_slider(driver: Driver) -> None:
    assert driver.session.slow == driver.session.scene.view.slow
    driver.key(pygame.K_MINUS)
    assert driver.session.slow == 5.0
    driver.key(pygame.K_EQUALS)
    assert driver.session.slow == 2.0
    slider = driver.play.transport.slider
    assert slider is not None
    driver.drag(slider.sliding_button.rect.center, (slider.rect.right - 5, slider.rect.centery))
    driver.release((slider.rect.right - 5, slider.rect.centery))
    assert driver.session.slow > 500.0


def test_looking_back_at_another_speed_drops_nothing(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(60)
    driver.key(pygame.K_HOME)
    last = driver.session.history.last
    driver.key(pygame.K_MINUS)
    assert driver.session.history.last == last
    driver.key(pygame.K_SPACE)
    assert driver.session.slow == 5.0


def test_a_bead_is_placed_while_paused(driver: Driver) -> None:
    x, y = driver.bead(0)
    before = driver.session.lanes[0].position.copy()
    driver.drag((x, y), (x - 60, y))
    driver.release((x - 60, y))
    after = driver.session.lanes[0].position
    assert after[0] < before[0]
    assert after[0] - before[0] == pytest.approx(driver.play.scenery.views[0].metres(-60), rel=0.05)
    assert np.array_equal(after[1:], before[1:])


def test_a_bead_is_pulled_and_thrown_while_running(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(5)
    x, y = driver.bead(4)
    driver.drag((x, y), (x + 120, y), steps=25)
    pulled = driver.session.lanes[0].velocity[4]
    assert pulled > 0.2
    driver.release((x + 120, y))
    thrown = driver.session.lanes[0].velocity[4]
    driver.frames(10)
    assert driver.session.lanes[0].velocity[4] == pytest.approx(thrown, rel=1e-6)
    assert driver.session.health(0).level == "good"  # the work of the hand is booked


def test_a_typed_mass_and_a_slider_are_felt_in_the_next_frame(driver: Driver) -> None:
    driver.click(driver.bead(2))
    control = driver.play.inspector.controls["mass"]
    driver.click(control.entry.rect.center)
    control.entry.set_text("")
    driver.type("2.5")
    driver.key(pygame.K_RETURN)
    assert driver.session.lanes[0].chain.mass[2] == 2.5
    slider = driver.play.inspector.controls["mass"].slider
    driver.press(slider.sliding_button.rect.center)
    driver.move((slider.rect.left + 30, slider.rect.centery), (1, 0, 0))
    driver.frames(2)
    assert driver.session.lanes[0].chain.mass[2] < 0.1
    driver.release((slider.rect.left + 30, slider.rect.centery))


def test_a_number_that_is_none_is_said(driver: Driver) -> None:
    driver.click(driver.bead(2))
    control = driver.play.inspector.controls["mass"]
    driver.click(control.entry.rect.center)
    control.entry.set_text("")
    driver.type("-1")
    driver.key(pygame.K_RETURN)
    assert driver.session.lanes[0].chain.mass[2] == 1.0
    assert any("mass must be > 0" in text for text in driver.said)


def test_keys_do_not_act_while_a_number_is_typed(driver: Driver) -> None:
    driver.click(driver.bead(2))
    driver.click(driver.play.inspector.controls["mass"].entry.rect.center)
    driver.type("r a")
    assert driver.session.lanes[0].chain.contacts == 4
    assert not driver.session.playing
    driver.key(pygame.K_ESCAPE)
    assert not driver.play.typing
    driver.key(pygame.K_a)
    assert driver.session.lanes[0].chain.contacts == 5


def test_beads_are_added_and_removed(driver: Driver) -> None:
    driver.click(driver.bead(4))
    driver.key(pygame.K_a)
    assert driver.session.lanes[0].chain.contacts == 5
    assert driver.play.pick == Pick(0, "bead", 5)
    driver.key(pygame.K_DELETE)
    driver.frames()
    assert driver.session.lanes[0].chain.contacts == 4
    assert driver.play.pick == Pick(0, "bead", 4)


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


def test_a_locked_piston_brings_the_usual_cradle_back(driver: Driver) -> None:
    driver.key(pygame.K_l)  # nothing selected: all of them
    driver.key(pygame.K_SPACE)
    driver.frames(330)
    velocity = driver.session.lanes[0].velocity
    assert velocity[4] > 0.9  # the last flies off
    assert abs(velocity[0]) < 0.15


def test_law_of_one_contact_and_of_all(driver: Driver) -> None:
    driver.key(pygame.K_RIGHT)
    driver.key(pygame.K_RIGHT)
    assert driver.play.pick == Pick(0, "contact", 0)
    driver.key(pygame.K_g)
    assert [law.preload > 0.0 for law in driver.session.lanes[0].chain.contact] == [True, False, False, False]
    driver.key(pygame.K_g, SHIFT)
    assert all(law.preload > 0.0 for law in driver.session.lanes[0].chain.contact)


def test_method_menu_switches_live_and_the_badge_turns_red(driver: Driver) -> None:
    menu = driver.play.cards.menus[0]
    driver.key(pygame.K_SPACE)
    driver.click(menu.rect.center)
    driver.frames(3)
    options = menu.menu_states["expanded"].options_selection_list
    item = next(one for one in options.item_list_container.elements if one.text == "euler")
    driver.click(item.rect.center)
    driver.frames(5)
    assert driver.session.lanes[0].setup.method == "euler"


def test_badge_turns_red_with_a_sentence_when_the_method_is_past_its_limit() -> None:
    driver = Driver("draft-gear-one-on-three")
    for key in (pygame.K_m, pygame.K_EQUALS, pygame.K_EQUALS, pygame.K_EQUALS):
        driver.key(key)
    driver.session.apply(SetStep(None, 0.01))
    driver.key(pygame.K_SPACE)
    driver.frames(60)
    health = driver.play.cards.health[0]
    assert driver.session.lanes[0].setup.method == "euler"
    assert health.level == "bad"
    card = driver.play.cards.rects[0]
    assert driver.app.surface.get_at((card.centerx, card.top))[:3] == RED
    driver.close()


def test_scene_is_saved_and_dropped_again(driver: Driver, tmp_path: Path) -> None:
    driver.click(driver.bead(1))
    driver.key(pygame.K_a)
    driver.key(pygame.K_s, CTRL)
    assert driver.app.prompt is not None
    driver.app.prompt.entry.set_text("mine.toml")
    driver.key(pygame.K_RETURN)
    assert driver.said == ["saved mine.toml"]
    masses = driver.session.lanes[0].chain.mass
    driver.key(pygame.K_ESCAPE)
    driver.key(pygame.K_ESCAPE)
    assert isinstance(driver.app.page, Gallery)
    driver.drop_file(tmp_path / "mine.toml")
    assert driver.session.lanes[0].chain.mass == masses


def test_session_is_saved_and_replays_to_the_last_digit(driver: Driver, tmp_path: Path) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(40)
    x, y = driver.bead(4)
    driver.drag((x, y), (x + 80, y), steps=20)
    driver.release((x + 80, y))
    driver.frames(20)
    state, last = driver.session.lanes[0].state.copy(), driver.session.history.last
    driver.play.keeping.save_session("played")
    driver.drop_file(tmp_path / "played.npz")
    replay = driver.play.replay
    assert replay is not None
    driver.frames(200)
    assert replay.done
    assert replay.diverged is None
    assert any("agrees" in text for text in driver.said)
    shown = driver.session.history.moment(last).states[0]
    assert np.array_equal(shown.overlap, state.overlap)


def test_history_is_exported(driver: Driver, tmp_path: Path) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(60)
    driver.key(pygame.K_e, CTRL)
    driver.app.prompt.entry.set_text("motion.csv")
    driver.key(pygame.K_RETURN)
    rows = (tmp_path / "motion.csv").read_text().splitlines()
    assert len(rows) > 60
    driver.play.keeping.export("motion.doc")
    assert any("motion.doc" in text for text in driver.said)


def test_screenshot_and_film_are_written(driver: Driver, tmp_path: Path) -> None:
    import av

    driver.key(pygame.K_p)
    picture = pygame.image.load(str(tmp_path / "one-bead-on-four.png"))
    assert picture.get_size() == (1280, 720)
    driver.key(pygame.K_SPACE)
    driver.key(pygame.K_r, CTRL)
    driver.frames(40)
    driver.key(pygame.K_r, CTRL)
    with av.open(str(tmp_path / "one-bead-on-four.mp4")) as film:
        frames = sum(1 for _ in film.decode(video=0))
    assert 15 <= frames <= 25  # every other one


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("bad.toml", "title = 3"),
        ("broken.toml", "title = ["),
        ("bad.npz", "nothing"),
        ("picture.jpg", "nothing"),
        ("missing.toml", None),
    ],
)
def test_a_bad_file_is_a_message_and_no_crash(driver: Driver, tmp_path: Path, name: str, content: str | None) -> None:
    if content is not None:
        (tmp_path / name).write_text(content)
    page = driver.app.page
    driver.drop_file(tmp_path / name)
    assert driver.app.page is page
    assert any(name in text for text in driver.said)
    assert driver.app.messages.shown[-1].trouble


def test_help_covers_the_page_and_is_closed_by_a_key(driver: Driver) -> None:
    driver.key(pygame.K_F1)
    assert driver.app.help
    driver.key(pygame.K_SPACE)
    assert not driver.session.playing
    driver.key(pygame.K_ESCAPE)
    assert not driver.app.help


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
    moment = session.history.moment(frame)
    length = session.scene.view.length
    overlap = at_frame(session.history, 0, frame).overlap[0]
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


def test_window_is_resized_scaled_and_its_panel_hidden(driver: Driver) -> None:
    for size in ((1000, 600), (1920, 1080), (800, 480), (1280, 720)):
        pygame.display.set_mode(size, pygame.RESIZABLE)
        pygame.event.post(pygame.Event(pygame.VIDEORESIZE, size=size, w=size[0], h=size[1]))
        driver.frames(3)
        assert driver.app.size == size
    for key in (pygame.K_EQUALS, pygame.K_EQUALS, pygame.K_MINUS, pygame.K_0):
        driver.key(key, CTRL)
    assert driver.app.scale == 1.0
    wide = driver.play.places.stages[0].width
    driver.key(pygame.K_i)
    assert driver.play.places.stages[0].width > wide


def test_sound_is_off_until_asked_for(driver: Driver) -> None:
    assert driver.play.keeping.clicks is None
    assert pygame.mixer.get_init() is None
    driver.key(pygame.K_n)
    if driver.play.keeping.clicks is None:
        assert any("no sound" in text for text in driver.said)
        return
    driver.key(pygame.K_SPACE)
    driver.frames(150)
    driver.key(pygame.K_n)
    assert pygame.mixer.get_init() is None


def test_quitting_ends_the_loop(driver: Driver) -> None:
    pygame.event.post(pygame.Event(pygame.QUIT))
    driver.app.run()
    assert not driver.app.running


def test_late_physics_slows_the_clock_and_says_so(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.session.pace.budget = 0.0
    driver.frames(60)
    assert driver.session.pace.clock_ratio < 0.95
    assert math.isfinite(driver.session.time)


RUBBING = """
title = "Rubbing"
[[lanes]]
beads = [1, 2]
contact = {law = "draft_gear", stiffness = 100.0, precompression = 0.1, loss = 0.5}
velocity = 1.0
friction = 0.1
drive = [0.5, 0.0, 0.0]
"""


def test_bed_drive_and_loss_have_their_sliders_where_the_scene_has_them(tmp_path: Path) -> None:
    (tmp_path / "rubbing.toml").write_text(RUBBING.replace("[[lanes]]", "duration = 5.0\n[[lanes]]"))
    driver = Driver(str(tmp_path / "rubbing.toml"))
    driver.click(driver.bead(0))
    controls = driver.play.inspector.controls
    for key, value in (("friction", 0.25), ("drive", 0.75)):
        driver.click(controls[key].entry.rect.center)
        controls[key].entry.set_text(f"{value}")
        driver.key(pygame.K_RETURN)
    chain = driver.session.lanes[0].chain
    assert (chain.friction, chain.drive) == (0.25, (0.75, 0.0, 0.0))
    driver.key(pygame.K_ESCAPE)  # out of the entry
    driver.key(pygame.K_RIGHT)
    assert driver.play.pick == Pick(0, "contact", 0)
    slider = driver.play.inspector.controls["loss"].slider.sliding_button.rect
    driver.drag(slider.center, (slider.centerx + 400, slider.centery))
    driver.release((slider.centerx + 400, slider.centery))
    driver.frames(2)
    assert driver.session.lanes[0].chain.contact[0].loss == 0.95
    driver.key(pygame.K_SPACE)
    driver.frames(120)
    assert driver.session.health(0).energy_error < 1e-9
    driver.close()


def test_an_ordinary_bead_has_no_bed_and_no_drive(driver: Driver) -> None:
    driver.click(driver.bead(0))
    assert set(driver.play.inspector.controls) == {"mass", "velocity"}
