"""Tests of the gallery of scenes with mouse and keys.

The tests also check that a page frees its memory when the user leaves it.
"""

import weakref
from unittest.mock import Mock

import numpy as np
import pygame
import pytest
from softcradle.sandbox.draw.palette import THEMES, use_theme
from softcradle.sandbox.languages import LANGUAGES, use_language
from softcradle.sandbox.window.gallery import thumbnails
from softcradle.sandbox.window.gallery.page import SECTIONS
from softcradle.sandbox.window.plots.scales import motions_ahead

from softcradle import scenes
from tests.helpers.windows import Driver


@pytest.fixture
def gallery() -> Driver:
    return Driver()


def test_a_clicked_card_opens_and_the_old_page_is_freed(gallery, monkeypatch) -> None:
    """Check that a click on a card opens its scene and that the memory of the old page is freed.

    Pages and widgets refer to each other in cycles and keep their pictures. Without garbage collection, an hour of use
    would take about 100 MB.
    """
    page = gallery.app.page
    gallery.pull(page.grid.place(0).center, page.grid.place(1).center)
    gallery.click((page.grid.place(0).centerx, 8))  # A click on the header above the cards must not open a scene.
    assert gallery.app.page is page
    page.grid.scroll_by(page.grid.place(4).top - page.grid.place(0).top)
    # A card that is scrolled behind the header must not react to a click.
    gallery.click((page.grid.place(0).centerx, round(90 * page.host.unit)))
    assert gallery.app.page is page
    page.grid.scroll = 0.0
    gallery.click(page.grid.place(1).center)
    assert gallery.page.title == page.scenes[page.names[1]].title
    old_page = weakref.ref(gallery.page)
    # An operating system that cannot free unused memory raises an AttributeError, a TypeError or an OSError.
    for action, refusal in (("larger", AttributeError), ("smaller", TypeError), ("larger", OSError)):
        monkeypatch.setattr("ctypes.CDLL", Mock(side_effect=refusal))
        old_widget = weakref.ref(next(iter(gallery.page.time_controls.buttons.values())))
        gallery.app.act(action)
        gallery.frames()
        assert old_widget() is None
    gallery.key(pygame.K_ESCAPE)
    assert gallery.app.page is page
    assert old_page() is None


def test_every_scene_has_a_complete_card_in_every_language(gallery: Driver) -> None:
    """Check that the card of each scene shows complete texts in every language.

    A list of sources is shortened only at a semicolon. The end of such a list names what this project added, for
    example "launch speed and loss ours".
    """
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
                # In some scenes, a single sentence is too long for the card and is cut.
                ends = (".",) if code == "en" and k < 4 else (".", "?", "…")
                assert said.endswith(ends), (code, said)
                assert text.startswith(said.removesuffix("…")), (code, text, said)
                assert source.startswith(shown), (code, source, shown)
                rest = source.removeprefix(shown).lstrip("\xa0 ")
                assert rest == "" or rest[0] == ";" or ";" not in shown.removesuffix(";"), (code, source, shown)


def test_shipped_thumbnails_are_up_to_date() -> None:
    for name in scenes.names():
        scene = scenes.load(name)
        motions = motions_ahead(scene)
        for theme in reversed(THEMES):
            use_theme(theme)
            drawn, shipped = thumbnails.paint(scene, motions), thumbnails.shipped(name, theme)
            one, other = (pygame.surfarray.array3d(picture).astype(float) for picture in (drawn, shipped))
            # Mean difference of colours, on a scale from 0 to 255.
            assert np.abs(one - other).mean() < 1.0, (name, theme)


def searched(gallery: Driver, words: str) -> tuple[str, ...]:
    gallery.key(pygame.K_f, pygame.KMOD_CTRL)
    gallery.type(words)
    return gallery.app.page.names


def test_the_gallery_search_finds_scenes(gallery: Driver) -> None:
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
    # A search keeps the order of the gallery.
    assert searched(gallery, "newton")[:3] == ("cradle", "steel-and-soft", "hertz-cradle")
    gallery.key(pygame.K_RETURN)
    assert gallery.page.title == "Newton's cradle on strings"


def test_thumbnails_with_numbers_are_drawn_for_each_language(gallery: Driver) -> None:
    page = gallery.app.page
    page.scenes = {name: page.scenes[name] for name in ("one-on-four", "mixed")}
    gallery.app.act("language")
    gallery.frames(2)
    assert set(page.pictures) == {"one-on-four", "mixed"}, "they are shown until then"
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
    gallery.app.rebuild()  # The first picture of the scene may still be in preparation.
    page = gallery.app.page
    gallery.until(lambda: not page.moving)
    assert "Again" in [one.text for one in gallery.texts()]
    assert thumbnails.load(page.scenes[page.names[4]], "light") is not None
    (tmp_path / "mine.toml").write_text(scenes.load("mixed").model_copy(update={"title": "Last"}).to_toml())
    gallery.app.rebuild()
    (tmp_path / "mine.toml").unlink()
    gallery.app.rebuild()
    # Jobs run one after another. The last job therefore starts after the picture that is no longer needed has been
    # drawn.
    gallery.app.warmup.submit(lambda _: done.append(True), lambda: None)
    done: list[bool] = []
    gallery.until(lambda: done)
    assert set(page.pictures) == set(page.names)


def test_a_scene_without_a_motion_is_shown_at_its_start(gallery: Driver, tmp_path) -> None:
    page, scene = gallery.app.page, scenes.load("mixed").model_copy(update={"method": "conserving", "step": 1e-9})
    (tmp_path / "mine.toml").write_text(scene.to_toml())
    gallery.app.settings.remember(tmp_path / "mine.toml")
    gallery.app.rebuild()
    gallery.until(lambda: not page.moving)
    assert str(tmp_path / "mine.toml") in page.pictures
    assert "drawing …" not in [one.text for one in gallery.texts()]
    assert thumbnails.load(scene, "light") is None, "it is no picture of the motion"


def test_keys_and_bar_scroll_to_every_card(gallery: Driver) -> None:
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


def test_each_scene_and_theme_has_its_own_thumbnail(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("SOFTCRADLE_CACHE", str(tmp_path / "file" / "cache"))
    scene = scenes.load("one-on-four")
    other = scene.model_copy(update={"title": "Another"})
    assert thumbnails.cached_path(scene, "light") == thumbnails.cached_path(scenes.load("one-on-four"), "light")
    assert len({thumbnails.cached_path(*each) for each in ((scene, "light"), (other, "light"), (scene, "dark"))}) == 3
    thumbnails.save(scene, "light", pygame.Surface((4, 4)))
    assert thumbnails.load(scene, "light") is None
