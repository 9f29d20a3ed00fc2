"""The gallery of scenes, by mouse and by keys, and what it leaves behind."""

from __future__ import annotations

import time
import weakref
from collections.abc import Iterator
from pathlib import Path

import pygame
import pytest
from softcradle.sandbox.window.gallery.gallery_page import Gallery

from tests.helpers.windows import Driver

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT
pytestmark = pytest.mark.usefixtures("own_folder")


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
