"""The gallery, driven by mouse and keys, and the memory of pages that were left."""

from __future__ import annotations

import time
import weakref
from collections.abc import Iterator
from pathlib import Path

import pygame
import pytest
from softcradle.sandbox.window.gallery.gallery_page import GalleryPage

from tests.helpers.windows import Driver

pytestmark = pytest.mark.usefixtures("own_folder")


@pytest.fixture
def gallery() -> Iterator[Driver]:
    made = Driver()
    yield made
    made.close()


def test_the_gallery_draws_and_saves_thumbnails_and_opens_the_scene_that_is_clicked(
    gallery: Driver, tmp_path: Path
) -> None:
    page = gallery.app.page
    assert isinstance(page, GalleryPage)
    deadline = time.monotonic() + 90.0
    while len(page.pictures) < len(page.names) and time.monotonic() < deadline:
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
    assert isinstance(again, GalleryPage)
    assert len(again.pictures) == len(again.names)  # loaded from disk


def test_the_gallery_is_used_by_keys_alone(gallery: Driver) -> None:
    page = gallery.app.page
    assert isinstance(page, GalleryPage)
    gallery.key(pygame.K_RIGHT)
    gallery.key(pygame.K_DOWN)
    assert page.selected == 1 + page.columns
    gallery.key(pygame.K_RETURN)
    assert gallery.session.scene == page.scenes[page.selected]


def test_a_press_that_ends_on_another_card_opens_nothing(gallery: Driver) -> None:
    page = gallery.app.page
    assert isinstance(page, GalleryPage)
    gallery.drag(page.place(0).center, page.place(1).center)
    gallery.release(page.place(1).center)
    gallery.click((page.place(0).centerx, 8))  # the header
    assert gallery.app.page is page
    page.scroll_to(page.pitch)
    gallery.click((page.place(0).centerx, round(90 * page.host.unit)))  # a card that is scrolled below the header
    assert gallery.app.page is page


def test_pages_and_widgets_that_are_left_are_freed(gallery: Driver) -> None:
    """They refer to each other in cycles and hold their surfaces: some 100 MB in an hour of use."""
    page = gallery.app.page
    assert isinstance(page, GalleryPage)
    old_gallery, place = weakref.ref(page), page.place(0).center
    del page
    gallery.click(place)
    gallery.frames()
    assert old_gallery() is None
    old_page = weakref.ref(gallery.page)
    for action in ("larger", "smaller"):
        old_widget = weakref.ref(next(iter(gallery.page.time_controls.buttons.values())))
        gallery.app.act(action)
        gallery.frames()
        assert old_widget() is None
    gallery.key(pygame.K_ESCAPE)
    gallery.frames()
    assert isinstance(gallery.app.page, GalleryPage)
    assert old_page() is None
