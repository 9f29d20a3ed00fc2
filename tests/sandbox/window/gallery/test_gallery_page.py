"""The gallery, driven by mouse and keys, and the memory of pages that were left."""

import weakref
from unittest.mock import Mock

import numpy as np
import pygame
import pytest
from softcradle.sandbox.draw.palette import THEMES, use_theme
from softcradle.sandbox.languages import LANGUAGES, use_language
from softcradle.sandbox.window.gallery import thumbnails
from softcradle.sandbox.window.gallery.page import SECTIONS
from softcradle.sandbox.window.plots.scales import MOST_AT_ONCE, motions_ahead

from softcradle import scenes
from tests.helpers.windows import Driver


@pytest.fixture
def gallery() -> Driver:
    return Driver()


def test_the_card_on_which_a_click_begins_and_ends_is_opened_and_what_is_left_is_freed(gallery, monkeypatch) -> None:
    """They refer to each other in cycles and hold their surfaces: some 100 MB in an hour of use."""
    page = gallery.app.page
    gallery.pull(page.grid.place(0).center, page.grid.place(1).center)
    gallery.click((page.grid.place(0).centerx, 8))  # the header
    assert gallery.app.page is page
    page.grid.scroll_by(page.grid.place(4).top - page.grid.place(0).top)
    gallery.click((page.grid.place(0).centerx, round(90 * page.host.unit)))  # a card that is scrolled below the header
    assert gallery.app.page is page
    page.grid.scroll = 0.0
    gallery.click(page.grid.place(1).center)
    assert gallery.page.title == page.scenes[page.names[1]].title
    old_page = weakref.ref(gallery.page)
    # systems that cannot trim the heap say so in different ways
    for action, refusal in (("larger", AttributeError), ("smaller", TypeError), ("larger", OSError)):
        monkeypatch.setattr("ctypes.CDLL", Mock(side_effect=refusal))
        old_widget = weakref.ref(next(iter(gallery.page.time_controls.buttons.values())))
        gallery.app.act(action)
        gallery.frames()
        assert old_widget() is None
    gallery.key(pygame.K_ESCAPE)
    assert gallery.app.page is page
    assert old_page() is None


def test_every_scene_has_a_picture_at_once_a_section_and_whole_words_in_every_language(gallery: Driver) -> None:
    """What is ours of a scene stands at the end of its source, of which no list is cut: "launch speed and loss ours"."""
    page = gallery.app.page
    assert not page.moving
    listed = [name for section in SECTIONS for name in section.names]
    assert sorted(listed) == sorted(page.names) == sorted(page.captions)
    for code in LANGUAGES:
        use_language(code)
        gallery.app.rebuild()
        for scroll in range(0, 1800, 400):
            page.grid.scroll = 0.0
            page.grid.scroll_by(scroll)
            texts = gallery.texts()
            for k, name in enumerate(page.names):
                place = page.grid.place(k)
                if place.top < 120 or place.bottom > 720:
                    continue
                *words, shown = [one.text for one in texts if place.collidepoint(one.rect.center)]
                title, text, source = page.captions[name]
                assert " ".join(words).startswith(title), (code, title)
                said = " ".join(words).removeprefix(title).strip()
                ends = (".",) if code == "en" and k < 4 else (".", "?", "…")  # of some scenes one sentence is too long
                assert said.endswith(ends), (code, said)
                assert text.startswith(said.removesuffix("…")), (code, text, said)
                assert source.startswith(shown), (code, source, shown)
                rest = source.removeprefix(shown).lstrip("\xa0 ")
                assert rest == "" or rest[0] == ";" or ";" not in shown.removesuffix(";"), (code, source, shown)


def test_shipped_pictures_are_those_that_are_drawn_now_of_motions_that_hold_no_window_up() -> None:
    for name in scenes.names():
        scene = scenes.load(name)
        motions = motions_ahead(scene, MOST_AT_ONCE)
        for theme in reversed(THEMES):
            use_theme(theme)
            drawn, shipped = thumbnails.paint(scene, motions), thumbnails.shipped(name, theme)
            one, other = (pygame.surfarray.array3d(picture).astype(float) for picture in (drawn, shipped))
            assert np.abs(one - other).mean() < 1.0, (name, theme)  # of 255


def searched(gallery: Driver, words: str) -> tuple[str, ...]:
    gallery.key(pygame.K_f, pygame.KMOD_CTRL)
    gallery.type(words)
    return gallery.app.page.names


def test_a_search_finds_scenes_by_words_and_enter_opens_the_first(gallery: Driver) -> None:
    page = gallery.app.page
    count = len(page.names)
    trains = {f"train-{kind}" for kind in ("braking", "cut", "shunting", "solid", "starting")}
    assert set(searched(gallery, "wagon")) == trains
    gallery.key(pygame.K_ESCAPE)
    assert len(page.names) == count
    assert searched(gallery, "qqq") == ()
    for key in (pygame.K_RETURN, pygame.K_RETURN, pygame.K_DOWN):
        gallery.key(key)
    assert gallery.app.page is page
    gallery.key(pygame.K_ESCAPE)
    assert len(page.names) == count
    assert searched(gallery, "qqq") == ()
    gallery.key(pygame.K_RETURN)
    assert searched(gallery, "newton")[:3] == ("hertz-cradle", "steel-and-soft", "hanging-cradle")  # in its place
    gallery.key(pygame.K_RETURN)
    assert gallery.page.title == "Newton's cradle: steel balls"


def test_pictures_with_english_numbers_are_drawn_anew_in_another_language_and_kept(gallery: Driver) -> None:
    page = gallery.app.page
    page.scenes = {name: page.scenes[name] for name in ("one-on-four", "mixed")}
    gallery.app.act("language")
    gallery.frames(2)
    assert set(page.pictures) > {"one-on-four", "mixed"}, "they are shown until then"
    gallery.app.warmup.complete.set()
    gallery.until(lambda: not page.english and page.drawing is None)
    assert all(thumbnails.load(scene, "light") is not None for scene in page.scenes.values())
    use_language("en")
    assert thumbnails.load(page.scenes["mixed"], "light") is None


def test_scenes_of_ones_own_have_cards_below_the_first(gallery: Driver, tmp_path) -> None:
    (tmp_path / "mine.toml").write_text(scenes.load("mixed").model_copy(update={"title": "Mine"}).to_toml())
    gallery.app.settings.remember(tmp_path / "mine.toml")
    gallery.app.rebuild()
    titles = [title for title, _y in gallery.app.page.grid.titles()]
    assert titles[:2] == ["Start here", "My scenes"]
    assert gallery.app.page.names[4] == str(tmp_path / "mine.toml")
    assert "Mine" in [one.text for one in gallery.texts()]
    (tmp_path / "mine.toml").write_text(scenes.load("one-on-ten").model_copy(update={"title": "Again"}).to_toml())
    gallery.app.rebuild()  # while the first picture may still be drawn
    page = gallery.app.page
    gallery.until(lambda: not page.moving)
    assert "Again" in [one.text for one in gallery.texts()]
    assert thumbnails.load(page.scenes[page.names[4]], "light") is not None
    (tmp_path / "mine.toml").write_text(scenes.load("mixed").model_copy(update={"title": "Last"}).to_toml())
    gallery.app.rebuild()
    (tmp_path / "mine.toml").unlink()
    gallery.app.rebuild()
    gallery.app.warmup.submit(lambda _: done.append(True), lambda: None)  # after the picture that nobody waits for
    done: list[bool] = []
    gallery.until(lambda: done)
    assert set(page.pictures) == set(page.names)


def test_a_scene_whose_motion_cannot_be_had_is_shown_as_it_begins_and_the_page_rests(gallery: Driver, tmp_path) -> None:
    page, scene = gallery.app.page, scenes.load("mixed").model_copy(update={"method": "conserving", "step": 1e-9})
    (tmp_path / "mine.toml").write_text(scene.to_toml())
    gallery.app.settings.remember(tmp_path / "mine.toml")
    gallery.app.rebuild()
    gallery.until(lambda: not page.moving)
    assert str(tmp_path / "mine.toml") in page.pictures
    assert "drawing …" not in [one.text for one in gallery.texts()]
    assert thumbnails.load(scene, "light") is None, "it is no picture of the motion"


def test_keys_and_the_bar_scroll_to_every_card_and_it_stays_where_it_was(gallery: Driver) -> None:
    page = gallery.app.page
    gallery.key(pygame.K_END)
    last, scroll = len(page.names) - 1, page.grid.scroll
    assert page.grid.place(last).bottom <= gallery.app.size[1]
    gallery.key(pygame.K_RETURN)
    gallery.key(pygame.K_ESCAPE)
    assert (gallery.app.page.selected, gallery.app.page.grid.scroll) == (last, scroll)
    gallery.key(pygame.K_HOME)
    assert (page.selected, page.grid.scroll) == (0, 0.0)
    gallery.key(pygame.K_RIGHT)
    gallery.key(pygame.K_DOWN)
    assert page.selected == 1 + page.grid.columns
    gallery.key(pygame.K_HOME)
    gallery.key(pygame.K_PAGEDOWN)
    gallery.key(pygame.K_TAB)
    assert page.selected > page.grid.columns
    track, knob = page.grid._bar()
    gallery.pull(knob.center, (knob.centerx, track.bottom))
    assert page.grid.place(last).bottom <= gallery.app.size[1]


def test_thumbnails_of_others_have_other_files_and_a_cache_that_cannot_be_written_is_no_error(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("SOFTCRADLE_CACHE", str(tmp_path / "file" / "cache"))
    scene = scenes.load("one-on-four")
    other = scene.model_copy(update={"title": "Another"})
    assert thumbnails.cached_path(scene, "light") == thumbnails.cached_path(scenes.load("one-on-four"), "light")
    assert len({thumbnails.cached_path(*each) for each in ((scene, "light"), (other, "light"), (scene, "dark"))}) == 3
    thumbnails.save(scene, "light", pygame.Surface((4, 4)))
    assert thumbnails.load(scene, "light") is None
