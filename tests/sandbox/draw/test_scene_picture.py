"""Tests of the pictures of scenes.

The tests check that a picture shows the motion to scale and depends only on the sample. The tests also check that texts
fit, numbers are correct and colours are distinct.
"""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pygame
import pytest
from hypothesis import given
from hypothesis import strategies as st
from softcradle.sandbox.draw.axes import LINE, linear_axis
from softcradle.sandbox.draw.bodies import cluster_ends, has_marks, mass_labels, rigid_forces, visible_marks
from softcradle.sandbox.draw.lane_drawing import LaneDrawing
from softcradle.sandbox.draw.magnified_insets import MagnifiedInsets
from softcradle.sandbox.draw.palette import BEAD_COLOURS, bead_colours, tones
from softcradle.sandbox.draw.scene_picture import Picture, speed_text
from softcradle.sandbox.draw.shared_scales import FORCE_MARGIN, left_edges, scales_of
from softcradle.sandbox.draw.surfaces import cached_surfaces, clear_cached_surfaces
from softcradle.sandbox.draw.text import shortened, width, wrapped
from softcradle.sandbox.film.formats import pixels_of
from softcradle.sandbox.film.scene_motion import scene_motions, strongest_row
from softcradle.sandbox.story import numbers
from softcradle.sandbox.story.numbers import (
    MINUS,
    TIMES,
    beside,
    factor,
    fixed,
    number_text,
    scientific,
    spread,
    ticks,
)
from softcradle.scenes import Lane, Scene
from softcradle.scenes.catalogue import parse

from softcradle import hertz, one_on
from tests.helpers.drawn_text import drawn_texts, film_texts

SIZE = (960, 540)

SOFT_ROW = '{label = "soft", beads = [1, 3], velocity = 1.0, contact = {law = "power_law", f0 = 1.0, alpha = 0.25}}'
HARD_ROW = '{label = "hard", beads = [1, 3], velocity = 1.0, contact = {law = "hertz", stiffness = 30.0}}'
SOFT = f'title = "Soft and hard"\ntext = "Some words."\nsource = "Fig. 0"\nlanes = [{SOFT_ROW}]'
TWO = SOFT.replace(SOFT_ROW, f"{SOFT_ROW}, {HARD_ROW}")
GEAR = """
title = "Gear"
view = {slow = 60.0, length = 0.12}
lanes = [{beads = 2, velocity = [0.5, 0], mass = 0.4, contact = {law = "draft_gear", stiffness = 770, precompression = 0.0177}}]
"""
WALL = """
title = "Wall"
[[lanes]]
mass = [1.0, 2.0, 0.5, inf]
velocity = [1.0, 0.0, 0.0, 0.0]
contact = [{law = "step_force", f0 = 1.0}, {law = "draft_gear", stiffness = 5.0, precompression = 0.1},
           {law = "hooke", stiffness = 10.0}]
gap = 0.3
"""
MANY = 'title = "Many"\nlanes = [{beads = [1, 40], velocity = 1.0, contact = {law = "hertz", stiffness = 100.0}}]'


def hertz_row(duration, **lane):
    return Scene(title="x", duration=duration, lanes=[Lane(contact={"law": "hertz", "stiffness": 30.0}, **lane)])


@lru_cache(4)
def pictured(scene, rows_per_second=40.0, size=SIZE):
    scene = parse(scene) if isinstance(scene, str) else scene
    motions = scene_motions(scene, rows_per_second * scene.view.slow)
    return scene, motions, Picture(scene, motions, size)


def painted(picture, row, **options):
    surface = pygame.Surface(picture.size, 0, 32)
    picture.paint(surface, row, **options)
    return pixels_of(surface)[..., 2::-1].astype(int).copy()


def near(pixels, colour, tolerance=6):
    return (np.abs(pixels - np.array(colour)) <= tolerance).all(axis=-1)


def test_drawing_depends_only_on_the_sample():
    scene, motions, _ = pictured(TWO)
    for motion in motions:
        for values in (motion.time, motion.position, motion.overlap, motion.force):
            values.setflags(write=False)
    picture = Picture(scene, motions, SIZE)
    middle, row = len(motions[0].time) // 2, len(motions[0].time) // 3
    first = painted(picture, middle)
    surface = pygame.Surface(SIZE, 0, 32)
    Picture(scene, motions, SIZE).paint(surface, middle)
    assert (pixels_of(surface)[..., 2::-1] == first).all()
    other, text = painted(picture, row, text_opacity=0.5), painted(picture, middle, text_opacity=1.0)
    assert (painted(picture, middle) == first).all()
    assert (other != first).any()
    faded = painted(picture, middle, text_opacity=0.5)
    assert 0 < np.abs(faded - first).sum() < np.abs(text - first).sum()


def test_beads_overlaps_and_bars_are_drawn_to_scale():
    _, motions, picture = pictured(SOFT)
    drawing, row = picture.lanes[0].drawing, strongest_row(motions)
    pixels = painted(picture, row)
    state = motions[0].position[row], motions[0].overlap[row]
    edges = drawing.left() + drawing.scale * left_edges(*state, drawing.length, picture.scales.magnify)
    y = round(drawing.ground - drawing.bead / 2 - 0.3 * drawing.bead)
    for i, edge in enumerate(edges[2:], 2):
        assert near(pixels[y, round(edge + drawing.bead / 2)], drawing.colours[i], 45), i
    lens = pixels[round(drawing.ground - drawing.bead / 2), round((edges[0] + drawing.bead + edges[1]) / 2)]
    assert lens.sum() < pixels[y, round(edges[1] + drawing.bead * 0.6)].sum() - 20
    above = pixels[drawing.rect.top : math.floor(drawing.bar_base), drawing.rect.left : drawing.rect.right]
    heights = [near(above, colour).sum(axis=0).max() for colour in drawing.contact_colours]
    expected = drawing.bar_room * motions[0].force[row] / (picture.scales.force / FORCE_MARGIN)
    lines_across = 3  # Tolerance of the height [pixels]: one line for the rigid cluster, and two partly covered pixels.
    assert heights == pytest.approx(expected, abs=lines_across)
    assert min(expected) > 10


@pytest.mark.parametrize("height", [60, 70, 150])
def test_a_lane_without_room_for_bars_is_drawn(height):
    scene, motions, _ = pictured(SOFT)
    surface = pygame.Surface((564, height), 0, 32)
    drawing = LaneDrawing(surface.get_rect(), 0.75, scene, 0, scales_of(scene, motions))
    assert (drawing.bar_room > 0.0) == (height > 70)
    drawing.backdrop(surface)
    drawing.paint(surface, motions[0], strongest_row(motions), drawing.left())
    above = pixels_of(surface)[: math.floor(drawing.bar_base), :, 2::-1]
    bars = [near(above, colour).sum() for colour in drawing.contact_colours]
    assert (max(bars) > 0) == (drawing.bar_room > 0.0)


def test_a_wall_has_no_piston():
    contact = '{law = "draft_gear", stiffness = 1.0, precompression = 0.2}'
    lane = f"mass = [inf, 1.0]\nvelocity = [0.0, -1.0]\ngap = 0.5\ncontact = {contact}"
    _, motions, picture = pictured(f'title = "Wall"\nduration = 2.0\nview = {{magnify = 1.0}}\n[[lanes]]\n{lane}')
    row, drawing = strongest_row(motions), picture.lanes[0].drawing
    assert motions[0].overlap[row, 0] > 0.6  # The overlap must exceed 0.6 of the length of a bead.
    beside = painted(picture, row)[: round(drawing.ground) - 5, : round(drawing.left() - 3)]
    assert (beside[round(drawing.bar_base) + 5 :, drawing.rect.left :] == tones.lane_background).all()


def test_piston_moves_in_by_the_magnified_overlap():
    _, motions, picture = pictured(GEAR)
    drawing = picture.lanes[0].drawing
    rows = [int(np.argmin(np.abs(motions[0].time))), strongest_row(motions)]
    y = round(drawing.ground - 0.33 * drawing.bead)
    across = [painted(picture, row)[y, drawing.rect.left : drawing.rect.right] for row in rows]
    rods = [near(pixels, tones.steel, 3).sum() for pixels in across]
    moved = picture.scales.magnify * drawing.scale * motions[0].overlap[rows[1], 0]
    assert moved > 8
    assert rods[0] - rods[1] == pytest.approx(moved, abs=3)


def test_lanes_share_times_axes_and_scale():
    scene, motions, picture = pictured(TWO)
    first, second = picture.lanes
    assert first.drawing.scale == second.drawing.scale
    for a, b in zip(first.panels, second.panels, strict=True):
        assert (a.area.left, a.area.width, a.time, a.axis) == (b.area.left, b.area.width, b.time, b.axis)
    assert not first.drawing.rect.colliderect(second.drawing.rect)
    scales = scales_of(scene, motions)
    for motion in motions:
        edges = left_edges(motion.position, motion.overlap, scene.view.length, scales.magnify)
        assert scales.window[0] < edges.min()
        assert scales.window[1] > edges.max() + scene.view.length
        assert scales.velocity[0] <= motion.velocity.min()
        assert scales.velocity[1] >= motion.velocity.max()
        assert scales.force > motion.force.max()


@pytest.mark.parametrize(
    "lane",
    [
        {"drive": [1, 0, 0], "friction": 0.05, "velocity": [0, 0, 0]},
        {"mass": 0.01, "velocity": [0, -0.1]},
        {"velocity": [0, 0]},
    ],
)
def test_bars_and_times_hold_all_that_they_show(lane):
    """Check that the energy bar includes the energy dissipated by ground friction.

    Also check that the bar of the momentum has room for a small momentum to the left.
    """
    scene = hertz_row(20.0, **lane)
    (motion,) = motions = scene_motions(scene, 30.0)
    scales, total = scales_of(scene, motions), motion.energy + (motion.absorbed if motion.absorbed.size else 0.0)
    assert scales.energy == (total.max() or 1.0)
    assert np.ptp(scales.momentum) == pytest.approx(np.abs(motion.momentum.sum(axis=1)).max() or 1.0)
    moment = {name: getattr(motion, name)[:1] for name in ("time", "overlap", "rate", "anchor", "force")}
    assert np.ptp(scales_of(scene, [replace(motion, **moment)]).time) > 0.0


def test_magnified_overlaps_move_beads_about_their_mean():
    position, overlap = np.array([0.0, -0.1, 0.4]), np.array([0.1, -0.5])
    edges = left_edges(position, overlap, 1.0, 3.0)
    assert np.diff(edges) == pytest.approx([1.0 - 3.0 * 0.1, 1.5])
    assert (edges - left_edges(position, overlap, 1.0, 1.0)).mean() == pytest.approx(0.0)


def test_overlap_labels_are_at_the_largest_overlaps():
    scene, motions, _ = pictured(SOFT)
    assert (motions[0].overlap.min(axis=0) < -motions[0].overlap.max(axis=0)).any()
    with drawn_texts(SIZE) as texts:
        picture = Picture(scene, motions, SIZE)
    panel = picture.lanes[0].panels[2]
    places = panel.area.top + panel.y(panel.axis.on(motions[0].overlap.max(axis=0)))
    written = {text.text: text.rect.centery for text in texts}
    heights = [written[name] for name in panel.names]
    assert heights == sorted(heights)
    assert np.abs(heights - places).max() <= 2 * LINE * panel.unit


AT_REST = hertz_row(1.0, velocity=[0, 0])
CHAINS = {"wall": (WALL, SIZE), "many": (MANY, SIZE), "gear": (GEAR, SIZE), "rest": (AT_REST, SIZE)}
SIZES = {str(size): (TWO, size) for size in ((160, 90), (320, 180), (540, 960))}
LARGE = pytest.param(TWO, (3840, 2160), id="large", marks=pytest.mark.slow)


@pytest.mark.parametrize(
    ("text", "size"), [*(pytest.param(*given, id=name) for name, given in (CHAINS | SIZES).items()), LARGE]
)
def test_any_chain_and_any_size(text, size):
    _, motions, picture = pictured(text, 20.0, size)
    frames = [painted(picture, row) for row in (0, len(motions[0].time) // 2, len(motions[0].time) - 1)]
    for frame in frames:
        assert 0.02 < (~near(frame, tones.background)).mean() < 0.9
        assert near(frame[0, 0], tones.background)
    assert (frames[0] != frames[-1]).any()
    # The bars that show forces start above the tallest bead or wagon.
    for drawing in (lane.drawing for lane in picture.lanes):
        assert (
            min(drawing.body_shape(bead, 0.0)[0].top for bead in range(len(drawing.chain.mass))) >= drawing.bar_base - 1
        )


def test_camera_moves_the_beads_and_nothing_else():
    _, _, picture = pictured(SOFT)
    drawing = picture.lanes[0].drawing
    still, moved = painted(picture, 5), painted(picture, 5, centre=sum(picture.scales.window) / 2 + 0.5)
    changed = np.argwhere((still != moved).any(axis=-1))
    assert changed[:, 0].min() >= drawing.rect.top
    assert changed[:, 0].max() <= picture.lanes[0].insets.rect.bottom


def test_the_drawing_cache_drops_the_oldest_first():
    drawn = []

    @cached_surfaces(megabytes=1.0)
    def square(side):
        drawn.append(side)
        return pygame.Surface((side, side), 0, 32)

    def drawn_anew(*sides):
        drawn.clear()
        assert all(square(side).get_size() == (side, side) for side in sides)
        return drawn

    sides = [256, 255, 254]  # Each square needs a quarter of a megabyte.
    assert drawn_anew(*sides, *sides) == sides
    # The square with side 400 needs 0.61 MB, so two older squares are dropped. Drawing 255 again drops the square with
    # side 400.
    assert drawn_anew(400, 254, 255, 254) == [400, 255]
    # The square with side 2000 is larger than the cache. Such a large square is kept only until the next drawing.
    assert drawn_anew(2000, 2000) == [2000]
    clear_cached_surfaces()
    # The cache again has room for three squares, because dropped squares do not count.
    assert drawn_anew(*sides, *sides) == sides


@given(st.lists(st.floats(-50, 250, allow_nan=False), min_size=1, max_size=12), st.floats(1, 16), st.floats(100, 300))
def test_names_beside_curves_keep_order_and_distance(places, gap, high):
    moved = spread(places, gap, 0.0, high)
    order = sorted(range(len(places)), key=lambda k: places[k])
    steps = np.diff([moved[k] for k in order])
    assert (steps >= min(gap, high / max(1, len(places) - 1)) - 1e-6).all()
    assert min(moved) >= -1e-6
    assert max(moved) <= high + 1e-6
    # Names of curves stay in place if they have enough room.
    assert spread([10.0, 50.0, 90.0], 12.0, 0.0, 100.0) == [10.0, 50.0, 90.0]
    assert spread([50.0, 50.0], 12.0, 0.0, 100.0) == [44.0, 56.0]


CLOSED = [0.0] * 4
# Each case contains the overlaps and velocities before the collision, and the overlaps and forces during the collision.
# The last list contains the forces that a rigid cluster would have by Eq. (5).
CLUSTERS = [
    ([-1, 0, 0, 0], [1, 0, 0, 0, 0], CLOSED, [0.8, 0.5, 0.3, 0.1], [0, 0.6, 0.4, 0.2]),
    # A gap ends the cluster: beads beyond the gap feel no force.
    ([-1, 0, 0, -1], [1, 0, 0, 0, 0], [0, 0, 0, -1], [1, 1, 1, 0], [0, 2 / 3, 1 / 3, 0]),
    ([-1, -1, 0, 0], [1, 0, 0, 0, 0], [0, -1, 0, 0], [1, 0, 1, 1], [0, 0, 0, 0]),
    ([-1, 0, -1, 0], [1, 0, 0, 0, 0], [0, 0, -1, 0], [1, 1, 0, 1], [0, 0.5, 0, 0]),
    # A bead hits the cluster from the right.
    ([0, -0.5, 0, -1], [0, 0, 0, 0, -1], [0, -0.5, 0, 0.1], [0, 0, 0.7, 1.0], [0, 0, 0.5, 0]),
    # Three beads are hit from the left with a force of 3 N. A fourth bead pushes back with 1 N.
    ([-1, 0, 0, -1e-3], [1, 0, 0, 0, 0], [0.1] * 4, [3, 2, 2, 1], [0, 3 * 2 / 3 + 1 / 3, 3 / 3 + 2 / 3, 0]),
]


@pytest.mark.parametrize(("before", "velocity", "now", "force", "expected"), CLUSTERS)
def test_rigid_forces_follow_equation_5(before, velocity, now, force, expected):
    ends = cluster_ends(before, velocity, 1.0)
    assert rigid_forces([1.0] * 5, ends, now, force, 1.0) == pytest.approx(expected)


def test_where_clusters_end_and_which_have_marks():
    """Check which beads form a cluster and which clusters have marks.

    Neighbouring beads that touch form a cluster unless their velocities differ. No mark is drawn at a wall, without a
    collision or for a single bead.
    """
    assert cluster_ends(CLOSED, [1, 0, 0, 0, 0], 1.0) == (True, False, False, False)
    assert cluster_ends([0.0, -1e-17, 1e-30, 0.0], [0, 0, 0, 0, 1e-9], 1.0) == (False, False, False, True)
    two = cluster_ends([0.0, -1.0, 0.0], [1, 1, 0, 0], 1.0)
    assert rigid_forces([1.0, 3.0, 2.0, 2.0], two, [0.0] * 3, [9, 1.0, 9], 1.0) == pytest.approx([0.25, 0, 0.5])
    assert rigid_forces([1.0, 1.0, math.inf], (True, False), [0.1, 0.1], [1.0, 1.0], 1.0) == [0.0, 0.0]
    assert [has_marks(ends) for ends in ((False, False), (True,), (True, True), (True, False))] == [False] * 3 + [True]


def test_only_loaded_contacts_have_marks_with_a_legend():
    row = [1.0] * 5, (True, False, False, False), [0.1] * 4
    assert visible_marks(*row, [4.0, 0.0, 0.0, 0.0], 1.0, 0.1) == [0.0] * 4, "steel: a wave that has not come yet"
    assert visible_marks(*row, [4.0, 3.0, 0.0, 0.0], 1.0, 0.1) == [0.0, 3.0, 0.0, 0.0]
    scene, motions, *_ = pictured(SOFT)
    picture = Picture(scene, motions, SIZE)
    free, pushed = 0, strongest_row(motions)
    assert not motions[0].force[free].any()
    for row, told in ((free, False), (pushed, True)):
        with drawn_texts(SIZE) as texts:
            picture.paint(pygame.Surface(SIZE, 0, 32), row)
        assert ("if the row were one solid block" in [one.text for one in texts]) == told


def test_the_last_contact_has_an_inset_however_many_fit():
    scene, motions, *_ = pictured(SOFT)
    scales = scales_of(scene, motions)
    drawing = LaneDrawing(pygame.Rect(0, 0, 600, 200), 1.0, scene, 0, scales)
    deepest = tuple(10.0**-k for k in range(9))
    for wide in (300, 500, 800):
        insets = MagnifiedInsets(pygame.Rect(0, 0, wide, 84), 1.0, drawing, deepest)
        assert insets.shown[0] == 0
        assert insets.shown[-1] == 8
        assert insets.pitch * len(insets.shown) <= wide
    small = MagnifiedInsets(pygame.Rect(0, 0, 573, 84), 1.0, drawing, deepest[:4])
    assert list(small.shown) == [0, 1, 2, 3], "they shrink before one is left out"


def test_the_title_of_an_axis_names_the_unit_of_its_large_numbers():
    axis = linear_axis("contact force (N)", -3e5, 2.6e5)
    assert axis.title == "contact force (kN)"
    assert [text for _place, text in axis.ticks] == [f"{MINUS}200", "0", "200"]
    assert axis.ticks[0][0] == -2e5
    assert linear_axis("energy (J): beads, contacts grey", 0.0, 2e6).title == "energy (MJ): beads, contacts grey"
    assert linear_axis("contact force (N)", 0.0, 900.0).title == "contact force (N)"
    assert [beside(force, 2.6e5) for force in (-2.53e5, 0.0)] == [f"{MINUS}253", "0"]


def test_errors_are_those_of_the_motion():
    (motion,) = pictured(SOFT)[1]
    assert motion.energy_error[-1] == pytest.approx(np.abs(motion.energy / motion.energy[0] - 1.0).max())
    assert motion.momentum_error[-1] < 1e-12
    lost = replace(motion, balance=motion.balance * np.linspace(1.0, 0.9, len(motion.time))[:, None])
    assert lost.energy_error[-1] == pytest.approx(0.1)
    # The error is relative to the sum of the absolute momenta. The striker bounces back, so the sum is larger than the
    # total momentum.
    assert 0.05 < lost.momentum_error[-1] < 0.1


@pytest.mark.parametrize("friction", [0.0, 0.01])
def test_the_work_of_a_wall_is_not_an_energy_error(friction):
    pushed = {"mass": [1, 1, math.inf], "velocity": [0.5, 0, -0.3], "drive": [0, 0, 5], "friction": friction}
    _, (motion,), picture = pictured(hertz_row(duration=1.5, gap=[0.1, 0], **pushed))
    assert np.ptp(motion.energy) > 0.1
    with drawn_texts(SIZE) as texts:
        painted(picture, -1)
    said = [item.text for item in texts if item.text.startswith("energy error")]
    assert np.isnan(motion.energy_error).all() == (friction > 0.0)
    assert (motion.energy_error[-1] < 1e-6) == (friction == 0.0)
    assert len(said) == (friction == 0.0)


@pytest.mark.parametrize(
    ("friction", "keys"), [(0.0, {"contacts": "steel"}), (0.1, {"contacts": "steel", "absorbed": "muted"})]
)
def test_the_energy_bar_names_the_absorbed_energy(friction, keys):
    scene, motions, _ = pictured(hertz_row(duration=1.5, beads=[1, 2], velocity=1.0, friction=friction))
    (texts,) = film_texts(scene, motions, (1280, 720), [-1])
    pixels = painted(Picture(scene, motions, (1280, 720)), -1)
    named = {item.text.split()[-1]: item.rect for item in texts}
    assert named.keys() & {"contacts", "absorbed"} == keys.keys()
    for word, colour in keys.items():
        assert near(pixels[named[word].centery, named[word].right + 8], getattr(tones, colour))


def test_text_fits_its_room():
    assert width(shortened("a rather long title", 20, 100), 20) <= 100
    assert shortened("short", 20, 1000) == "short"
    assert all(width(line, 15) <= 200 for line in wrapped("a b c " * 40, 15, 200))
    assert " ".join(wrapped("one two three", 15, 60)) == "one two three"


@given(st.floats(1e-9, 1e9), st.integers(1, 8))
def test_steps_are_round(span, most):
    step = numbers.round_step(span, most)
    assert span / step <= most * (1 + 1e-6)
    assert float(f"{step:.0e}"[:-4]) in {1.0, 2.0, 5.0}
    assert numbers.round_down(step) == pytest.approx(step)
    assert len(ticks(0.0, span, most)) <= most + 1


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (scientific(0.41), "0.41"), (scientific(7.8e-4), "7.8·10⁻⁴"), (scientific(-1.25e7), "\N{MINUS SIGN}1.2·10⁷"),
        (scientific(0.0), "0"), (factor(20000.0), "\N{MULTIPLICATION SIGN}20\N{NARROW NO-BREAK SPACE}000"),
        (factor(1.5), "\N{MULTIPLICATION SIGN}1.5"), (factor(2e6), "\N{MULTIPLICATION SIGN}2·10⁶"), (fixed(-0.001, 2), "0.00"),
        ([number_text(value) for value in (None, 0.0, 1e-15, -0.25)], ["-", "0", "0", f"{MINUS}0.2500"]),
        ([number_text(value) for value in (2e-5, 1234.4, 123456.0)], ["2.00·10⁻⁵", "1234", "1.23·10⁵"]),
        ([number_text(value) for value in (0, 1, 493)], ["0", "1", "493"]), (numbers.subscript(1, 2), "₁₂"),
        (numbers.subscript(9, 10), "₉₋₁₀"),
        (numbers.decades(-6, 0, 3), [(0.0, "10⁰"), (-2.0, "10⁻²"), (-4.0, "10⁻⁴"), (-6.0, "10⁻⁶")]),
        (ticks(-0.2, 1.0, 4), [(0.0, "0.0"), (0.5, "0.5"), (1.0, "1.0")]),
        ([text for _, text in ticks(0.0, 1.4e6, 3)], ["0", "500 k", "1 M"]),
        ([text for _, text in ticks(0.0, 1e15, 2)], ["0", "5.00·10¹⁴", "1.00·10¹⁵"]),
        ([text for _, text in ticks(-2e4, 2e4, 4)], [f"{MINUS}20 k", f"{MINUS}10 k", "0", "10 k", "20 k"]),
        ([text for _, text in ticks(12345.1, 12345.2, 2)], ["12.3451 k", "12.34515 k", "12.3452 k"]),
        ([text for _, text in ticks(-5e-7, 1.5e-6, 4)], [f"{MINUS}5·10⁻⁷", "0", "5·10⁻⁷", "1.0·10⁻⁶", "1.5·10⁻⁶"]),
        ([speed_text(slow) for slow in (1, 4, 1e4)], ["real time", "slow motion 1/4", "slow motion 1/10000"]),
        ([speed_text(slow) for slow in (0.7, 1e-5)], [f"fast motion {TIMES}1.429", f"fast motion {TIMES}100000"]),
        (mass_labels(one_on(3, hertz(1.0), [1500.0, 0.25, 2e-5, math.inf])), ("1500 kg", "0.25 kg", "2.00·10⁻⁵ kg", "wall")),
    ],
)  # fmt: skip
def test_numbers(found, expected):
    assert found == expected


# Simulation of red-green colour blindness (deuteranopia and protanopia) after Machado et al. (2009), for linear RGB and
# severity 1.
COLOUR_BLIND = [
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
]


def test_colours_differ_for_the_colour_blind():
    linear = (np.array(BEAD_COLOURS) / 255.0) ** 2.2
    seen = np.clip(linear @ np.transpose(COLOUR_BLIND, (0, 2, 1)), 0.0, 1.0) ** (1 / 2.2) * 255.0
    distance = np.linalg.norm(seen[:, :, None] - seen[:, None], axis=-1)
    # The limit is twice the smallest colour distance that people can distinguish.
    assert (distance + 1e3 * np.eye(len(BEAD_COLOURS))).min() > 40.0
    assert len(set(bead_colours(60))) == 60
    assert bead_colours(12) == BEAD_COLOURS
