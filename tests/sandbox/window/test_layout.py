"""Tests of the layout of all pages at six window sizes and five scales.

No widget and no text may be clipped, overlap another one or leave the window.
"""

from types import SimpleNamespace

import pygame
import pytest
from softcradle.sandbox.draw.text import width
from softcradle.sandbox.session.editable_numbers import parameters
from softcradle.sandbox.window.app import page_of
from softcradle.sandbox.window.gallery.page import GalleryPage
from softcradle.sandbox.window.page_geometry import LEAST_LANE
from softcradle.sandbox.window.scene.editor import Pick

from tests.helpers.drawn_text import colliding
from tests.helpers.windows import Driver, faults, widget_name, widgets

pytestmark = pytest.mark.slow

SIZES = ((800, 600), (1000, 600), (1280, 720), (1366, 768), (1920, 1080), (2560, 1440))
# Number of frames after which the contacts are pressed in every scene of this file. Forces and curves are then visible.
AMID = 60
SCALES = (0.8, 1.0, 1.3, 1.5, 2.0)
# Window size, language, and True for the view with all controls. German has the longest words. The smallest size and
# the default size leave the least space.
CASES = [
    *((size, "en", True) for size in SIZES),
    *((size, code, True) for code in ("de", "fr") for size in (SIZES[0], SIZES[2])),
    # Cases of the view with few controls. Such window sizes occur on screens with a scale of 200 %.
    *((size, code, False) for code in ("de", "fr") for size in ((1024, 600), (1280, 800))),
]


def _select(driver: Driver, pick: Pick | None, plots: bool = False, values: bool = False) -> None:
    if driver.session.frame == 0:
        driver.session.step_frames(AMID)
    driver.page.editor.selection = pick
    if driver.page.view.plots_covered != values:
        driver.app.act("values")
    driver.page.board.chosen = driver.page.board.available() if plots else ["velocities", "forces", "overlaps"]
    driver.app.rebuild()


def _film(driver: Driver) -> None:
    """Pretend that a film of one hour is being recorded. Nothing is written."""
    _select(driver, None)
    film = driver.page.film
    film.film, film.seconds = SimpleNamespace(free_surface=lambda: pygame.Surface((2, 2)), add=lambda frame: None), 3599
    driver.app.rebuild()


def _end(driver: Driver) -> None:
    _select(driver, None)
    driver.page.outcome.show_outcome()


PAGES = {  # For each page: the name of its scene, and the actions that prepare the page.
    "gallery": (None, lambda driver: None),
    "scene": ("one-on-four", lambda driver: _select(driver, None)),
    "a bead": ("one-on-four", lambda driver: _select(driver, Pick(0, "bead", 1), plots=True)),
    "a contact": ("one-on-four", lambda driver: _select(driver, Pick(0, "contact", 1))),
    "friction and drive": ("driven-cluster", lambda driver: _select(driver, Pick(0, "bead", 1))),
    "two lanes": ("beads-against-gear", lambda driver: _select(driver, None, plots=True)),
    "a contact of two lanes": ("beads-against-gear", lambda driver: _select(driver, Pick(1, "contact", 0), plots=True)),
    "a train": ("train-braking", lambda driver: _select(driver, Pick(0, "contact", 1))),
    "values": ("one-on-ten", lambda driver: _select(driver, Pick(0, "bead", 9), plots=True, values=True)),
    "values of two lanes": ("beads-against-gear", lambda driver: _select(driver, Pick(1, "contact", 2), True, True)),
    "values of a train": ("train-braking", lambda driver: _select(driver, Pick(0, "bead", 1), plots=True, values=True)),
    "film": ("three-on-five", _film),
    "the end": ("two-on-two", _end),
    "the end of two": ("steel-and-soft", _end),
    "cradle": ("cradle", lambda driver: None),
    "question": ("one-on-four", lambda driver: driver.app.choose("Keep?", "A note. " * 30, dict.fromkeys("abc", list))),
    "menu": ("one-on-four", lambda driver: driver.app.act("tools")),
    "path": ("one-on-four", lambda driver: driver.page.dialogs.ask("export")),
    "words": ("steel-and-soft", lambda driver: driver.page.ask_words()),
}


def faults_of_texts(driver: Driver) -> list[str]:
    app, window, texts = driver.app, pygame.Rect((0, 0), driver.app.size), driver.texts()
    assert texts
    if app.dialog is not None and app.dialog.open:
        box, lines = app.dialog.box, app.dialog._lines() if hasattr(app.dialog, "_lines") else ()
        words = {getattr(app.dialog, "title", ""), *lines}
        texts = [one for one in texts if one.rect.colliderect(box) and one.text in words]
        return [f"{one.text!r} leaves its box" for one in texts if not box.contains(one.rect)]
    found = [f"{one!r} lies on {other!r}" for one, other in colliding(texts)]
    places = app.page.view.places if hasattr(app.page, "view") else getattr(app.page, "places", None)
    # The gallery can be scrolled, so its cards may extend below the window.
    scrolled = isinstance(app.page, GalleryPage)
    for words, rect in texts:
        # Leave out the empty space that a font has above and below its letters.
        shown = rect.inflate(-2, -round(0.3 * rect.height))
        if shown.left < 0 or shown.right > window.right or not (scrolled or window.contains(shown)):
            found.append(f"{words!r} leaves the window: {rect}")
        panel = places.panel if places is not None else window
        if panel.top < shown.top < panel.bottom and shown.left < panel.left < shown.right:
            found.append(f"{words!r} lies across the edge of the panel: {rect}")
        under = [one for one in widgets(driver) if one.rect.colliderect(shown)]
        if under and not scrolled:
            found.append(f"{words!r} {rect} lies below {widget_name(under[0])} {under[0].rect}")
    return found


def faults_of_scene(driver: Driver) -> list[str]:
    page, unit, found = driver.page, driver.app.unit, []
    places, inspector, controls = page.view.places, page.inspector, page.time_controls
    if page.toolbar.title_room < 60 * unit and not page.film.recording:
        found.append(f"room of {page.toolbar.title_room / unit:.0f} for the title")
    if min(lane.height for lane in places.lanes) < LEAST_LANE * unit - 1:
        found.append(f"lanes of {[lane.height / unit for lane in places.lanes]}")
    rooms = [lane.drawing.bar_room for lane in page.view.lanes]
    found += [f"no room for forces: {room}" for room in rooms if room <= 10 * unit]
    found += [f"card {rect} leaves {places.panel}" for rect in page.cards.rects if not places.panel.contains(rect)]
    small = [plot for plot in page.board.plots if plot.area.width < 80 * unit or plot.area.height < 40 * unit]
    found += [f"{plot.content.title}: axes of {plot.area.size}" for plot in small]
    if controls.clock_left + width("t = 10000.00 ms", 16 * unit, bold=True) > places.footer.right:
        found.append("the clock leaves the window")
    pick = page.editor.selection
    if pick is None or driver.app.explore:
        return found
    wanted = {parameter.key for parameter in parameters(page.session, pick.lane, pick.kind, pick.index)}
    if set(inspector.controls) != wanted:
        found.append(f"no room for {wanted - set(inspector.controls)}")
    for control in inspector.controls.values():
        wide = width(control.parameter.name, 13 * unit) + 6 * unit + width(control.parameter.unit, 13 * unit)
        if inspector.rect.left + wide > control.entry.rect.left:
            found.append(f"the name of {control.parameter.key} is below its number")
    beyond = [button.text for button in inspector.buttons if not places.panel.contains(button.rect)]
    return [*found, *(f"{text} leaves the panel" for text in beyond)]


@pytest.mark.parametrize(("size", "code", "lab"), CASES, ids=str)
def test_nothing_overlaps_or_is_cut(size, code, lab, monkeypatch) -> None:
    monkeypatch.setenv("LANGUAGE", code)
    driver = Driver(lab=lab)
    starts = dict.fromkeys(start for start, _ in PAGES.values())
    pages = {start: driver.app.page if start is None else page_of(driver.app, start, list) for start in starts}
    driver.resize(size)
    found, looked_at = [], set()
    for scale in SCALES:
        driver.app.scale = scale
        driver.app.rebuild()
        if driver.app.unit in looked_at:
            # The window has limited the scale to the largest possible value, and this value was checked before.
            continue
        looked_at.add(driver.app.unit)
        for name, (start, prepare) in PAGES.items():
            driver.app.show(pages[start])
            prepare(driver)
            driver.frames(2)
            wrong = faults(driver) + faults_of_texts(driver)
            wrong += faults_of_scene(driver) if start else []
            found += [f"{name} at {scale}: {one}" for one in wrong]
    assert len(looked_at) > 2
    assert not found, "\n" + "\n".join(found[:40])
