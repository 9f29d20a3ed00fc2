"""Tests of the rectangles of the scene page, computed without opening a window.

Beads, plots and magnified contacts must be visible at every window size and scale.
"""

import pytest
from softcradle.sandbox.draw.lane_drawing import LaneDrawing
from softcradle.sandbox.draw.magnified_insets import MagnifiedInsets
from softcradle.sandbox.draw.shared_scales import scales_of
from softcradle.sandbox.film.scene_motion import scene_motions
from softcradle.sandbox.window.app import DESIGN, LEAST, LEAST_EXPLORED
from softcradle.sandbox.window.page_geometry import LEAST_LANE, fitting, geometry, least_height
from softcradle.sandbox.window.settings import SCALES

from softcradle import scenes

SIZES = ((1024, 528), (1024, 600), (1280, 800), (1366, 696), (1366, 768), (1920, 1080))


def unit_of(size: tuple[int, int], scale: float, explore: bool, lanes: int) -> float:
    """Return the number of pixels per design pixel that the window would choose."""
    usual = min(max(min(size[0] / DESIGN[0], size[1] / DESIGN[1]), 0.75), 2.5)
    wide, high = LEAST_EXPLORED if explore else LEAST
    return min(scale * usual, size[0] / wide, size[1] / max(high, least_height(lanes)))


@pytest.mark.parametrize("lanes", [1, 2])
@pytest.mark.parametrize("explore", [True, False], ids=["explore", "lab"])
def test_beads_and_a_plot_stay_at_every_scale(explore: bool, lanes: int) -> None:
    for size in SIZES:
        for scale in SCALES:
            unit = unit_of(size, scale, explore, lanes)
            assert fitting(size, unit, lanes, explore) >= 1, (size, scale)
            places = geometry(size, unit, lanes, [lanes], True, explore)
            assert min(lane.height for lane in places.lanes) >= LEAST_LANE * unit - 2, (size, scale)
            assert places.plots[0][0].height > 80 * unit, (size, scale)
            assert places.plots[-1][0].bottom <= places.footer.top


@pytest.mark.parametrize("name", ["one-on-four", "one-on-ten"])
def test_the_last_magnifier_stays_in_the_lab_at_every_scale(name: str) -> None:
    scene = scenes.load(name)
    motions = scene_motions(scene, 20.0 * scene.view.slow)
    scales = scales_of(scene, motions)
    for size in SIZES:
        for scale in SCALES:
            unit = unit_of(size, scale, False, 1)
            for rows in range(1, fitting(size, unit, 1, False) + 1):
                places = geometry(size, unit, 1, [3] * rows, True)
                drawing = LaneDrawing(places.lanes[0], unit, scene, 0, scales)
                insets = MagnifiedInsets(places.insets, unit, drawing, scales.deepest[0])
                assert insets.shown[-1] == drawing.chain.contacts - 1, (size, scale, rows)
