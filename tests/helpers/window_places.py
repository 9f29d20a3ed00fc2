"""Places in the window that a pointer goes to, as values that Hypothesis draws and shrinks."""

from typing import NamedTuple

from hypothesis import strategies as st
from softcradle.sandbox.window.scene.page import ScenePage

from tests.helpers.window_layout import widgets
from tests.helpers.windows import Driver

KINDS = ("bead", "contact", "widget", "plot", "bar", "window")


class Place(NamedTuple):
    """Somewhere in the window.

    Attributes:
        kind: one of KINDS; "window" where the page has nothing of the kind.
        number: of the bead, contact, widget or plot, modulo how many there are.
        across, down: shares of the rectangle of the plot, of the bar or of the window.
    """

    kind: str
    number: int
    across: float
    down: float


_SHARES = st.sampled_from((0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0))
PLACES = st.builds(Place, st.sampled_from(KINDS), st.integers(0, 60), _SHARES, _SHARES)


def point_of(place: Place, driver: Driver) -> tuple[int, int]:
    """The pixel of `place` in the window as it is now."""
    page, kind, number = driver.app.page, place.kind, place.number
    if kind == "widget":
        found = widgets(driver)
        if found:
            return tuple(found[number % len(found)].rect.center)
    if isinstance(page, ScenePage) and kind in ("bead", "contact"):
        view = page.view.lanes[number % len(page.view.lanes)]
        number //= len(page.view.lanes)
        x, y = view.centre(number % len(view.edges))
        return _inside(driver, (view.contacts[number % len(view.contacts)] if kind == "contact" else x, y))
    if isinstance(page, ScenePage) and kind == "plot" and page.board.plots:
        return _share(driver, place, page.board.plots[number % len(page.board.plots)].area)
    if isinstance(page, ScenePage) and kind == "bar":
        return _share(driver, place, page.timeline.rect)
    return _share(driver, place, (0, 0, *driver.app.size))


def _share(driver: Driver, place: Place, rect: tuple[int, int, int, int]) -> tuple[int, int]:
    left, top, width, height = rect
    return _inside(driver, (left + place.across * (width - 1), top + place.down * (height - 1)))


def _inside(driver: Driver, point: tuple[float, float]) -> tuple[int, int]:
    """The pixel of the window nearest to `point`: a pointer does not leave it."""
    width, height = driver.app.size
    return min(max(round(point[0]), 0), width - 1), min(max(round(point[1]), 0), height - 1)
