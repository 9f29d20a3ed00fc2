"""Tests of the web page in a real browser, which must report no errors.

The tests check throwing beads with mouse, touch and keys, rewinding the motion, comparing two rows of beads, and links.
"""

import re
import sys
import time
from math import inf
from pathlib import Path

import axe_core_python
import numpy as np
import pytest
from PIL import Image, ImageColor
from softcradle.sandbox.draw.bodies import rigid_forces
from softcradle.sandbox.story.numbers import MINUS

from softcradle import one_on, scenes, simulate
from tests.helpers.drawn_text import contrast
from tests.sandbox.page.conftest import (
    ALONE,
    BOOKED,
    LEDGER,
    NOTICE,
    PLACE,
    SAID,
    SCENE,
    SET,
    SOFT,
    TRAIN,
    error,
    hold_the_clock,
    pictures,
    run_to_the_end,
    velocities,
    visit_row,
)
from tools.browser import found

pytestmark = [pytest.mark.slow, pytest.mark.skipif(found() is None, reason="there is no browser")]
PUSHED = {"forces": [{"beads": 3, "time": [0, 1], "force": [0.01, 0.01]}], "duration": 9.0}
AXE = Path(axe_core_python.__file__).with_name("axe.min.js")
DEVICES = {"telephone": (390, 844), "desk": (1280, 800)}
FITS = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
HELP = """[...document.querySelectorAll('details > p')].filter((e) => getComputedStyle(e).display !== 'none')
  .map((e) => e.textContent)"""
ENDED = (
    "Bead 0 moves left at 0.57 m/s. Bead 1 moves right at 0.17 m/s. "
    "Beads 2 to 4 move right together at 0.46 m/s. "
    f"Two solid blocks would move at {MINUS}0.6 and 0.4 m/s."
)
COVERED = """(() => [...document.querySelectorAll('button, input, select, summary')].filter((e) => e.offsetParent).map((e) => {
  const area = e.type === 'checkbox' ? e.closest('label') : e;
  area.scrollIntoView({block: 'center'});
  const now = area.getBoundingClientRect(), top = document.elementFromPoint(now.x + now.width / 2, now.y + now.height / 2);
  return [e.id || e.tagName, area === top || area.contains(top), now.height];
}))()"""
CHART = """(() => { const {canvas} = page.charts[0], {width, height} = canvas;
  return Array.from(canvas.getContext("2d").getImageData(0, 0, width, height).data); })()"""
# Script that records the boxes of the texts and thin lines that are drawn together with the beads.
SPY = """(() => {
  const pen = CanvasRenderingContext2D.prototype, text = pen.fillText, box = pen.fillRect;
  const staged = (found) => page.stages.some(({pen, layer}) => found === pen || found === layer);
  window.texts = []; window.rules = [];
  pen.fillText = function (words, x, y, room) {
    const wide = this.measureText(words).width, left = {center: wide / 2, right: wide}[this.textAlign] || 0;
    const high = parseFloat(this.font.match(/([\\d.]+)px/)[1]);
    if (staged(this)) texts.push([words, x - left, y - 0.72 * high, x - left + wide, y]);
    text.call(this, words, x, y, room);
  };
  pen.fillRect = function (x, y, wide, high) {
    if (staged(this) && high === 1.5) rules.push(['', x, y, x + wide, y + high]);
    box.call(this, x, y, wide, high);
  };
})()"""
# Expression that is true if all curves are inside their charts.
INSIDE = """page.charts.every(({lane, channel, low, high}) => {
  const count = page.source.values(lane)[channel].length, found = [];
  page.source.trace(lane, channel, 400, -Infinity, (_, values, at) => found.push(...values.slice(at, at + count)));
  return Math.min(...found) >= low && Math.max(...found) <= high;
})"""


def seen(browser, folder):
    """Return the colours of a screenshot as an array of shape (height, width, 3)."""
    browser.picture(folder / "page.png")
    with Image.open(folder / "page.png") as opened:
        return np.asarray(opened.convert("RGB"), dtype=int)


def test_the_browser_reports_mistakes(process, tmp_path):
    """Check that the test browser reports errors of a page. Otherwise the tests of this file could not fail."""
    (tmp_path / "bad.html").write_text("<!doctype html><link rel=icon href='data:,'><script>nothing.there()</script>")
    process.fresh()
    process.open(tmp_path / "bad.html")
    assert any("nothing is not defined" in complaint for complaint in process.complaints)


@pytest.mark.parametrize(("fragment", "name", "apart"), [("", SCENE, 5e-3), ("#n=5&m=3&a=0.05", "three-on-five", 0.02)])
def test_the_rows_end_as_simulate_says(pages, browser, fragment, name, apart):
    """Compare the final velocities on the web page with the result of `simulate`.

    With 64 steps per contact, the velocities are accurate to a few thousandths. Energy and momentum are exact up to
    round-off.
    """
    browser.visit(pages(SCENE).output, fragment)
    (lane,) = scenes.load(name).lanes
    assert browser.run("page.specs[0].velocity") == list(lane.velocity)
    run_to_the_end(browser)
    np.testing.assert_allclose(velocities(browser), simulate(lane.chain(), lane.velocity).final_velocity, atol=apart)
    assert velocities(browser).sum() == pytest.approx(sum(lane.velocity), abs=1e-13)
    assert error(browser) < 1e-13


def test_a_page_plays_to_the_same_end_at_every_pace(pages, browser):
    browser.visit(pages(SCENE).output, "#with=none&pace=4")
    browser.run("page.play()")
    browser.until("!page.playing")
    said, last = browser.run(f"[{SAID}, page.source.last]")
    assert said == ENDED
    again = "document.getElementById('toggle').click(), [page.playing, page.source.time === page.source.begun]"
    assert browser.run(again) == [True, True]
    for fragment in (ALONE, "#with=none&pace=0.05"):
        browser.visit(pages(SCENE).output, fragment)
        run_to_the_end(browser)
        assert browser.run(f"[{SAID}, page.source.last]") == [ENDED, pytest.approx(last, abs=0.01)]


@pytest.mark.parametrize("row", [{}, {"duration": 6.0, "drive": 100 * [1]}])
def test_a_run_too_long_to_be_followed_goes_on_to_its_end(browser, tmp_path, row):
    row = {"contact": {"law": "hertz", "stiffness": 1e6}, "velocity": [1, *99 * [0]], "gap": 99 * [0.1]} | row
    visit_row(browser, tmp_path, **row)
    followed = browser.run("page.source.rows[0].begin(), page.source.lookAhead(), page.source.time")
    stopped = (
        "page.go(page.source.last), [page.playing, page.toggle(), page.playing, page.source.time < page.source.last]"
    )
    # The page is still playing and has not reached the end of the motion.
    assert browser.run(stopped) == [True, None, False, True]
    run_to_the_end(browser)
    if "duration" in row:
        assert followed < browser.run("page.source.time") == pytest.approx(6.0, abs=0.01)
        assert browser.run("page.source.over")
        assert browser.run(INSIDE)
    else:
        browser.run("page.source.next(), page.source.next()")
        assert followed < browser.run("page.source.last")
        assert not browser.run("page.source.over")


def test_the_ground_follows_a_row_that_is_driven_for_very_long(browser, tmp_path):
    """Check that the beads stay above the ground during a long motion.

    The page computes only 60 s in advance. The drawn ground was once at most four times as long as the distance covered
    in 60 s.
    """
    visit_row(browser, tmp_path, 200.0, velocity=[0, 0], drive=[1, 1])
    run_to_the_end(browser)
    seen = "page.stages.every(({edges, view}) => edges[0] >= 0 && edges.at(-1) + view.size <= view.width)"
    assert browser.run("page.source.values(0).position[0]") == pytest.approx(0.5 * 200.0**2, rel=1e-3)
    assert browser.run(seen)
    assert browser.run(f"page.go(page.source.begun), {seen}")


@pytest.mark.parametrize(
    ("row", "last"),
    [
        ({"velocity": [0, 0, 0], "gap": [0.5, 0], "drive": [1, 0, 0], "duration": 5.0}, 5.0),
        # The beads are pressed together and released. The beads separate after 0.69 s.
        ({"velocity": [0, 0, 0], "gap": [-0.2, -0.2]}, 2.19),
        ({"velocity": [1, 0, 0], "gap": [1, 0], "friction": 0.05}, 3.86),  # All beads are at rest after 2.36 s.
    ],
)
def test_a_run_is_followed_until_nothing_moves_any_more(browser, tmp_path, row, last):
    visit_row(browser, tmp_path, **row)
    assert browser.run("page.source.last") == pytest.approx(last, abs=0.01)


@pytest.mark.parametrize(("duration", "fragment"), [(10.0, ""), (None, "#mu=0.02")])
def test_a_moving_wall_on_a_bed_hits_again(browser, tmp_path, duration, fragment):
    friction = 0.02 if duration else 0.0
    visit_row(browser, tmp_path, duration, fragment, mass=[inf, 1], velocity=[2, 1], friction=friction)
    run_to_the_end(browser)
    assert browser.run("page.source.time") > 9.9
    # Bead 1 has a velocity of 2.7 m/s after 4.3 s and is slower at the end.
    assert browser.run("page.source.rows[0].velocity[1]") < 2.0
    assert browser.run("document.getElementById('words').className") == ""


def test_a_pressed_row_held_by_friction_has_ended(pages, browser):
    rest = "Beads 0 to 4 are at rest."
    browser.visit(pages(SCENE).output, "#loss=0.9&mu=0.02")
    run_to_the_end(browser)
    assert browser.run("page.source.values(0).force.some((force) => force > 0)")
    assert rest in browser.run(SAID)
    browser.run("page.go(1), page.go(page.source.last)")
    assert rest in browser.run(SAID)
    browser.run("page.go(2), page.chosen = {lane: 0, bead: 0}, page.throwChosen(1), page.pause()")
    assert browser.run("for (let k = 0; k < 3000 && !page.source.over; k++) page.source.next(); page.source.over")


@pytest.mark.parametrize(
    ("row", "rigid"),
    [({}, True), ({"gap": [0.5, 0.3, 0.3]}, False), (PUSHED, False), ({"duration": 0.4, "method": "radau"}, False)],
)
def test_the_rigid_outcome_is_shown_for_two_bodies_only(browser, tmp_path, row, rigid):
    visit_row(browser, tmp_path, **({"velocity": [1, 0, 0, 0], "gap": [0.5, 0, 0]} | row))
    run_to_the_end(browser)
    assert browser.run(SAID).startswith("Bead")
    assert ("solid blocks" in browser.run(SAID)) is rigid


def test_a_pause_within_a_picture_leaves_one_clock(live):
    times = live.run("""new Promise((done) => {
      const times = [];
      page.picture = (now) => { times.push(now); if (times.length < 9) page.next(); else done(times); };
      page.again(), page.pause(), page.play(), page.pause(), page.play();
    })""")
    assert sorted(set(times)) == times


def test_nobody_who_wants_less_motion_gets_some(pages, browser):
    browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    browser.visit(pages(SCENE).output, ALONE)
    before = browser.run("[page.playing, page.source.time]")
    time.sleep(0.2)
    assert browser.run("[page.playing, page.source.time]") == before == [False, before[1]]


@pytest.mark.parametrize(("device", "bead", "pull"), [("desk", 4, -0.1), ("telephone", 0, 0.2)])
def test_a_bead_is_thrown_by_mouse_and_finger(pages, browser, device, bead, pull):
    browser.device(*DEVICES[device])
    browser.visit(pages(SCENE).output, ALONE)
    hold_the_clock(browser)
    pointer = browser.mouse if device == "desk" else browser.finger
    down, move, up = ("Pressed", "Moved", "Released") if device == "desk" else ("Start", "Move", "End")
    x, y, size = browser.run(PLACE % bead)
    pointer(down, x, y)
    for k in range(12):
        pointer(move, x + pull * k * size, y)
        pictures(browser, 2)
    assert browser.run("[page.source.hand.bead, page.playing]") == [bead, True]
    pointer(up, x + 11 * pull * size, y)
    assert browser.run("page.source.hand") is None
    browser.run("page.pause()")
    assert (velocities(browser).sum() - 1.0) * pull > 0.0  # The change of momentum has the same sign as the pull.
    assert browser.run("page.source.rows[0].given") != 0.0
    assert browser.run("scrollY") == 0
    if device == "telephone":
        browser.swipe((195.0, 160.0), (195.0, 20.0))
        browser.until("scrollY > 50")  # A swipe that starts next to the beads scrolls the page.


def test_a_bead_is_chosen_pulled_and_thrown_by_keys(live):
    hold_the_clock(live)
    live.run("page.stages[0].canvas.focus()")
    for _ in range(3):
        live.key("ArrowRight")  # The first press of the arrow key selects bead 0.
    assert live.run("document.getElementById('said').textContent").startswith("bead 2, ")
    live.key("Enter")
    chosen, held, before = live.run("[page.chosen.bead, page.source.hand.bead, page.source.hand.place]")
    assert (chosen, held) == (2, 2)
    live.key("ArrowLeft")
    assert live.run("page.source.hand.place") == pytest.approx(before - 0.3)
    pictures(live, 12)
    live.key("Escape")
    assert live.run("page.source.hand") is None
    assert error(live) < BOOKED
    live.run("page.again(), page.pause()")
    live.key("ArrowLeft", shift=True)
    live.run("page.pause()")
    # The thrown bead has a mass of 1 kg and gets a velocity of 1 m/s.
    assert live.run("page.source.rows[0].given") == pytest.approx(0.5)


@pytest.mark.parametrize(("mass", "chosen"), [([1, 1, inf], [0, 1, 1, 0, 0]), ([inf, 1, inf, 1], [1, 3, 3, 1, 1])])
def test_no_key_takes_a_wall(browser, tmp_path, mass, chosen):
    visit_row(browser, tmp_path, duration=1.0, mass=mass, velocity=[0] * len(mass))
    browser.run("page.stages[0].canvas.focus()")
    found = []
    for key in ("ArrowRight", "ArrowRight", "ArrowRight", "ArrowLeft", "ArrowLeft"):
        browser.key(key)
        found.append(browser.run("page.chosen.bead"))
    assert found == chosen


def test_the_energy_given_by_hand_is_shown_separately(pages, browser, tmp_path):
    browser.visit(pages("steel-and-soft").output, "")
    browser.run("page.pause(), page.go(0.9), page.chosen = {lane: 1, bead: 3}, page.throwChosen(1), page.pause()")
    steel, soft = browser.run(LEDGER).split("\n")  # The energy balance has one line of text for each row of beads.
    assert re.fullmatch(r"steel balls: Total energy 0\.5 J · .*made up", steel)
    assert re.fullmatch(r"soft beads, .*: Total energy 1 J .* · you added 0\.5 J", soft)
    visit_row(browser, tmp_path, duration=5.0, velocity=[0, 0, 0], gap=[0.5, 0], drive=[1, 0, 0])
    browser.run("page.go(0.5), page.chosen = {lane: 0, bead: 2}, page.throwChosen(1), page.pause()")
    thrown = browser.run("0.5 * page.specs[0].speed ** 2")
    assert browser.run("page.source.rows[0].given") == pytest.approx(thrown)
    assert browser.run("page.source.rows[0].driven") == pytest.approx(0.125, abs=0.01)
    browser.run("for (let k = 0; k < 50; k++) page.source.next(); page.step(-1)")


def test_a_moving_wall_has_no_energy_balance(browser, tmp_path):
    for mass, balanced in ([inf, 1, 1], False), ([1, 1, inf], True):
        visit_row(browser, tmp_path, mass=mass, velocity=[1, 0, 0], gap=[0.5, 0])
        run_to_the_end(browser)
        assert ("conserved" in browser.run(LEDGER)) is balanced
        walls = re.findall(r"Wall .*? m/s\. ", browser.run(SAID))
        assert walls == ([] if balanced else ["Wall 0 moves right at 1 m/s. "])


def test_a_bead_in_hand_stays_there_when_the_pace_changes(pages, browser):
    browser.visit(pages(SCENE).output, "#pace=0.05")
    browser.run("page.pause(), page.grab(0, 2, null), page.pause(), page.source.hand.place += 0.2")
    browser.run(SET.format("pace", 4, "change"))
    browser.run("page.pause(); for (let k = 0; k < 300; k++) page.source.next()")
    # The pointer can accelerate a bead at most to twice the closing speed, which is 1 m/s.
    assert np.abs(velocities(browser)).max() < 4.0


def test_energy_is_balanced_wherever_soft_contacts_stand_in_the_row(browser, tmp_path):
    mixed = [{"law": "hertz", "stiffness": 100.0}, SOFT, SOFT]
    visit_row(browser, tmp_path, contact=mixed, velocity=[1, 0, 0, 0], gap=[0.5, 0, 0])
    assert "a row" in browser.run("page.stages[0].canvas.ariaLabel")
    browser.run("page.go(page.source.last), page.go(0.75), page.edit('alpha', 0.3), page.pause(), page.go(0.7)")
    assert error(browser) < BOOKED
    assert browser.run("page.looks[0].label") == "mixed contacts"


@pytest.mark.parametrize(("name", "fragment"), [("steel-and-soft", ""), ("hertz-cradle", "#law=soft&with=gear")])
def test_edited_rows_restart_with_their_edits(pages, browser, name, fragment):
    browser.visit(pages(name).output, fragment)
    laws = "page.source.rows.map(({kernel}) => [...kernel.law, ...kernel.loss, ...kernel.bed])"
    before = browser.run(f"page.pause(), page.go(1.9), {laws}")
    # The test needs beads that are pressed together when the edit is made.
    assert max(browser.run("page.source.rows.map((row) => row.stored(0))")) > 0.1
    browser.run("page.edit('alpha', 0.5), page.edit('loss', 0.5), page.edit('friction', 0.01), page.pause()")
    edited = browser.run(laws)
    assert error(browser) < BOOKED  # After the restart, the energy is still balanced in all rows of beads.
    assert edited == browser.run(f"page.restart(), {laws}") != before


def test_the_slider_tells_the_alpha_that_acts(pages, browser):
    browser.visit(pages(SCENE).output, "#a=1")
    assert browser.run("document.getElementById('alpha-value').textContent") == "1"
    assert browser.run("page.looks[0].label") == "springs, alpha = 1"
    browser.run(SET.format("alpha", 0, "input"))
    assert browser.run("document.getElementById('alpha-value').textContent") == "1/40"
    assert browser.run("page.source.rows[0].kernel.law[2]") == 1 / 40
    text = "document.getElementById('text').textContent"
    assert "solid block" not in browser.run(text)
    assert "changed the settings" in browser.run(text)
    browser.visit(pages(SCENE).output, "#pace=4&with=steel")
    assert "solid block" in browser.run(text)


def test_a_change_starts_the_run_again_with_the_previous_one_as_a_ghost(live, pages, browser):
    for name, place in (("alpha", 23), ("speed", 5), ("targets", 6), ("loss", 20)):
        run_to_the_end(live)
        live.run(SET.format(name, place, "input"))
        begins = "[page.playing, page.source.time < 0.3 * page.source.last, page.source.touched, page.after]"
        assert live.run(begins) == [True, True, False, None]
        assert min(live.run("page.charts.map(({ghost}) => ghost.length)")) > 50
        live.run("page.pause(), window.kept = page.ghosts")
        live.run(SET.format(name, place - 1, "input"))
        # A simulation that has just started does not replace the previous curves shown for comparison.
        assert live.run("page.pause(), page.ghosts === kept")
    drawn = np.array(live.run(f"page.dress(), {CHART}"))
    assert (drawn != np.array(live.run(f"page.ghosts = [], page.dress(), {CHART}"))).sum() > 1000
    browser.visit(pages("one-on-ten").output, "#n=5")
    assert "1/n" not in browser.run("page.looks[0].label")


def test_the_law_and_the_compared_row_are_changed(live):
    live.run("document.getElementById('contrast').click()")
    assert live.run("page.stages.length") == 2
    run_to_the_end(live)
    soft, steel = live.run(SAID).split("\n")
    assert soft.startswith("soft beads, alpha = 1/10: ")
    assert steel.startswith("steel balls: Beads 0 to 2 are almost at rest. ")
    assert len(set(live.run("page.source.rows.map((row) => row.kernel.time)"))) == 1
    beside = velocities(live, 1)
    assert beside[-1] == pytest.approx(0.986, abs=0.01)
    live.run("document.getElementById('contrast').click()")
    assert live.run("page.stages.length") == 1
    for law, last in (("steel", beside[-1]), ("gear", 0.4)):
        live.run(SET.format("law", law, "change"))
        run_to_the_end(live)
        assert velocities(live)[-1] == pytest.approx(last, abs=0.015)
        assert error(live) < 1e-13


@pytest.mark.parametrize(
    ("name", "fragment", "offered", "contrast"),
    [
        (SCENE, ALONE, ["none", "steel", "gear"], "Compare with steel balls"),
        (SCENE, "#a=1/20&n=2&with=none", ["none", "steel", "soft", "gear"], "Compare with steel balls"),
        (SCENE, "#law=steel&with=none", ["none", "soft", "gear"], "Compare with soft beads"),
        ("hertz-cradle", "#n=2&with=none", ["none", "soft", "gear"], "Compare with soft beads"),
        ("draft-gear-one-on-three", "#n=2&with=none", ["none", "steel", "soft"], "Compare with steel balls"),
        (TRAIN, "", None, None),
    ],
)
def test_a_row_is_compared_with_rows_of_other_contacts_only(pages, browser, name, fragment, offered, contrast):
    browser.visit(pages(name).output, fragment)
    browser.run("page.pause()")
    if offered is None:
        assert browser.run("[part('beside'), part('contrast')].every((one) => one.offsetParent === null)")
        return
    assert browser.run("[...part('beside').options].filter((one) => !one.hidden).map(({value}) => value)") == offered
    assert browser.run("part('contrast').textContent") == contrast
    for kind in offered[1:]:
        browser.run(f"page.edit('beside', '{kind}'), page.pause()")
        labels, rooms = browser.run(
            "[page.looks.map(({label}) => label), page.stages.map(({view}) => (view.ground - view.base) / view.size)]"
        )
        assert labels[0] != labels[1]
        assert min(rooms) > 0.66  # Even the tallest beads and wagons end below the axis of the forces.
    browser.run("page.edit('beside', 'gear'), page.edit('law', 'gear'), page.pause()")
    assert browser.run("page.experiment.beside") != "gear"


def test_rewinding_a_page_gives_bitwise_the_same_motion(live):
    state = "[page.source.count, page.source.values(0), page.source.time]"
    run_to_the_end(live)
    kept = live.run(state)
    live.run("page.go(1.5), page.source.forget()")
    assert live.run("page.source.count") < kept[0]
    run_to_the_end(live)
    assert live.run(state) == kept
    live.run("page.go(1.5), page.chosen = {lane: 0, bead: 4}, page.throwChosen(-1), page.pause()")
    assert live.run("page.source.last") < 2.0  # The edited motion ends earlier than the original one.
    live.run("page.source.apartFor = -1e9; for (let k = 0; k < 9000; k++) page.source.next()")
    assert live.run("page.source.count - page.source.first") == 3600  # The number of stored states is limited to 3600.
    assert live.run("page.go(-1e9), page.source.time === page.source.begun")


@pytest.mark.parametrize(
    "edit", ["0", "page.throwChosen(1)", "page.go(1.2), page.source.forget(), page.throwChosen(-1)"]
)
def test_a_chart_drawn_in_pieces_equals_a_chart_drawn_at_once(live, edit):
    live.run(f"page.pause(), page.go(1.5), page.chosen = {{lane: 0, bead: 4}}, {edit}, page.pause()")
    live.run("for (let k = 0; k < 150; k++) { page.source.next(); page.source.next(); page.show(false); }")
    grown = np.array(live.run(CHART))
    live.run("page.dress()")
    # A few pixels may differ at the joints between two pieces of a curve.
    assert (np.abs(grown - live.run(CHART)) > 64).mean() < 0.004
    assert (grown > 0).mean() > 0.02


def test_a_frame_changes_only_canvases(pages, browser):
    """Check that drawing a frame changes only canvases, so the browser does not compute the layout again.

    Captions, axes and the ground are not drawn again.
    """
    browser.visit(pages(SCENE).output, "#with=none&t=1.5")
    browser.run(SPY)
    browser.run("page.play(), page.pause(), page.playing = true, window.still = new MutationObserver(() => 0), 0")
    browser.run("still.observe(document, {subtree: true, childList: true, characterData: true, attributes: true})")
    slider, whole = browser.run("document.getElementById('time').value"), browser.run("page.dress(), texts.length")
    moved = "texts.length = 0, still.takeRecords(), page.source.next(), page.show(false), texts.length"
    assert browser.run(moved) < whole
    assert browser.run("still.takeRecords().length") == 0
    assert browser.run("document.getElementById('time').value") == slider


@pytest.mark.parametrize(("then", "density"), [(15.0, 1), (33.0, 3)])
def test_play_skips_invisible_parts_and_reduces_pixels(pages, browser, then, density):
    browser.device(390, 844, 3)
    browser.visit(pages(SCENE).output, "#t=1.5")
    browser.until("page.unseen.has(page.charts[1].canvas)")
    chart = CHART.replace("[0]", "[1]")
    before = browser.run(chart)
    assert browser.run(f"page.playing = true, page.source.go(1.9), page.show(false), {chart}") == before
    assert browser.run(f"page.playing = false, page.show(false), {chart}") != before
    late = "for (let k = 0; k < 60; k++) page.spare({}); page.theme.density"
    assert [browser.run(late.format(wait)) for wait in (16.7, 33.0, then, 33.0)] == [3, 1, density, density]


def test_a_cluster_ends_at_its_first_open_contact(live):
    mass, force, overlap = [1.0, 2.0, 1.0, 3.0, 1.0], [1.0, 0.7, 0.1, 0.2], [0.1, 0.0, -0.1, 0.1]
    there = f"""(() => {{ const now = emptyNow(4); now.ends[0] = 1; now.force.set({force}); now.overlap.set({overlap});
      return Array.from(rigidForces({mass}, now, 1)); }})()"""
    expected = rigid_forces(mass, [True, False, False, False], overlap, force, 1.0)
    np.testing.assert_allclose(live.run(there), expected)
    run_to_the_end(live)
    assert live.run("Array.from(rigidForces([1, 1, 1, 1, 1], page.source.values(0), 1))") == [0, 0, 0, 0]


@pytest.mark.parametrize(
    ("name", "moment", "expected"),
    [(SCENE, "0", ["apart", *3 * ["touching"]]), ("train-starting", "page.source.last", 8 * ["pulled"])],
)
def test_the_state_of_each_contact_is_described(pages, browser, name, moment, expected):
    browser.visit(pages(name).output, "")
    browser.run(f"{SPY}, page.pause(), page.edit('shown', ['loupes'])")
    browser.run(f"page.go({moment}), document.getElementById('numbers').open = true")
    states = "[...document.querySelectorAll('#tables table')[1].tBodies[0].rows].map((row) => row.cells[1].textContent)"
    browser.until("document.querySelectorAll('#tables table').length >= 2")
    assert browser.run(states) == expected
    assert expected[-1] in browser.run("texts.map(([text]) => text)")


def test_the_address_follows_the_settings_and_back(live):
    live.run("location.hash = '#n=2&t=1.2&lang=de'")
    live.until("page.specs[0].mass.length === 3")
    assert live.run("[page.language, page.playing, page.source.time]") == ["de", False, pytest.approx(1.2, abs=0.02)]
    live.run("page.edit('speed', 0.5)")
    assert live.until("!location.hash.includes('t=') && location.hash") == "#n=2&v=0.5&lang=de"
    live.run("location.hash = '#n=3'")
    live.until("page.specs[0].mass.length === 4")
    assert live.run("[page.language, document.getElementById('toggle').title]") == ["de", "Abspielen"]


@pytest.mark.parametrize(
    ("name", "fragment", "expected"),
    [
        (SCENE, "#v=-3&n=-3&mu=-.5", {"speed": 0.2, "targets": 1}),
        (SCENE, "#a=.05&loss=5.e-1", {"alpha": 0.05, "loss": 0.5}),
        (SCENE, "#pace=3", {"pace": 2}),
        ("galilean", "#law=steel&n=9&m=2&with=steel", {}),
        ("hertz-cradle", "#a=0.5", {}),
        ("", "#v=2&n=7", {}),
        (SCENE, "#n=1e99&m=-3&a=NaN&v=Infinity&mu=0x10&loss=1e400&pace=__proto__", {"targets": 49}),
        (SCENE, "#law=__proto__&with=constructor&show=toString.forces&lang=hasOwnProperty", {"shown": ["forces"]}),
        (SCENE, "#n=%3Cimg%20src=x%20onerror=alert(1)%3E&law=%3Cscript%3Ealert(1)%3C/script%3E&lang=%22%3E%3Cb%3E", {}),
        (SCENE, "#a=javascript:alert(1)&n=4;n=5&n=2.7&n=%00&t=1e999&with=steel%00", {}),
        (SCENE, "#" + "n=4&" * 5000, {}),
        (SCENE, "#%E0%A4%A&a=%", {}),
    ],
)
def test_values_of_an_address_are_limited(pages, browser, tmp_path, name, fragment, expected):
    if name:
        browser.visit(pages(name).output, fragment)
    else:
        visit_row(browser, tmp_path, velocity=[0, 0, 0], gap=[-0.2, -0.2], fragment=fragment)
    experiment, own = browser.run("[page.experiment, page.own]")
    assert experiment == own | expected
    assert expected or "changed the settings" not in browser.run("document.getElementById('text').textContent")
    assert browser.run("document.querySelectorAll('main script, main img').length") == 0


def test_a_softness_without_meaning_is_ignored(pages, browser):
    said = "[document.getElementById('text').textContent, page.looks[0].label]"
    browser.visit(pages("hertz-cradle").output, "")
    before = browser.run(said)
    browser.run("page.edit('law', 'soft'), page.edit('alpha', 0.5), page.edit('law', 'scene'), page.pause()")
    assert [browser.run(said), browser.run("page.write(), location.hash")] == [before, ""]
    browser.run("page.edit('law', 'soft'), page.write()")
    assert browser.run("location.hash") == "#law=soft&a=0.5"


def test_a_recorded_page_offers_only_what_can_be_changed(pages, browser):
    browser.visit(pages("train-solid").output, "#t=0&pace=0.25&show=charts&mu=0.1&with=steel&lang=en")
    # The motion begins at t = 0, because the wagons of this scene touch at the start.
    assert browser.run("[page.source.begun, page.source.time]") == [0, 0]
    experiment, own = browser.run("[page.experiment, page.own]")
    assert experiment == own | {"pace": 0.25, "shown": ["charts"]}
    browser.run("page.edit('pace', 0.5)")
    assert browser.until("location.hash.includes('0.5') && location.hash") == "#pace=0.5&show=charts&lang=en"
    promised = ["page.stages[0].canvas.ariaLabel", HELP]
    assert not any("hrow" in str(browser.run(said)) for said in promised)
    assert "This is a recording" in browser.run(NOTICE)
    browser.run(SET.format("language", "de", "change"))
    assert "nicht ändern" in browser.run(NOTICE)
    (tables,) = browser.run(
        "[...document.querySelectorAll('#numbers > [lang]:not([hidden])')].map((one) => one.textContent)"
    )
    assert all(word in tables for word in ("Aufgezeichnete Bewegung", "größte Kraft [MN]", "noch geschlossen", "2,"))
    browser.visit(pages(SCENE).output, ALONE)
    assert all("hrow" in str(browser.run(said)) for said in promised)


def test_a_host_that_refuses_kernels_gets_the_recorded_motion(pages, browser, tmp_path):
    text = pages(SCENE).output.read_text(encoding="utf-8")
    (tmp_path / "page.html").write_text(text.replace(" 'wasm-unsafe-eval'", ""), encoding="utf-8")
    browser.visit(tmp_path / "page.html", "")
    assert not browser.run("page.source.live")
    assert "blocks WebAssembly" in browser.run(NOTICE)
    run_to_the_end(browser)
    (lane,) = scenes.load(SCENE).lanes
    np.testing.assert_allclose(velocities(browser), simulate(lane.chain(), lane.velocity).final_velocity, atol=0.02)
    assert browser.run("document.querySelector('.sliders').offsetParent") is None


@pytest.mark.parametrize("own", [False, True], ids=["a scene", "a law of one's own"])
def test_a_recorded_motion_is_shown_as_it_was(browser, tmp_path, own):
    scene, k = scenes.load(SCENE), 1200
    chain, method = (one_on(4, lambda d: d + d**3), "conserving") if own else (scene.lanes[0].chain(), "accurate")
    recorded = simulate(chain, scene.lanes[0].velocity, method=method, samples=2001)
    recorded.to_page(tmp_path / "page.html")
    browser.visit(tmp_path / "page.html", f"#t={recorded.time[k]}")
    np.testing.assert_allclose(velocities(browser), recorded.velocity[k], atol=2e-3)
    np.testing.assert_allclose(browser.run("Array.from(page.source.values(0).force)"), recorded.force[k], atol=2e-3)
    shown = browser.run("Array.from(page.source.values(0).overlap)")
    np.testing.assert_allclose(shown, recorded.overlap[k], rtol=0.01)
    assert "This is a recording" in browser.run(NOTICE)
    run_to_the_end(browser)
    assert browser.run(SAID).startswith("Bead 0 moves left at 0.098 m/s. " if own else ENDED)
    assert browser.run("page.looks[0].marks")
    # The samples [1.0, 2.0] do not include the start of the motion.
    for samples, start in ([0.0, 2.0], "1.000"), ([1.0, 2.0], "-"):
        simulate(chain, scene.lanes[0].velocity, samples=samples).to_page(tmp_path / "page.html")
        browser.visit(tmp_path / "page.html", "#show=nothing")
        browser.run("part('numbers').open = true, page.show(true)")
        assert browser.run("[...document.querySelectorAll('#tables td')].map((one) => one.textContent)[2]") == start


@pytest.mark.parametrize(
    ("code", "title"), [("de-AT", "Eine Kugel auf vier"), ("fr", "Une bille contre quatre"), ("sv", "One bead on four")]
)
def test_it_speaks_the_language_of_its_reader(pages, browser, code, title):
    agent = browser.run("navigator.userAgent")
    browser.call("Emulation.setUserAgentOverride", userAgent=agent, acceptLanguage=code)
    browser.visit(pages(SCENE).output, ALONE)
    assert browser.run("[document.title, document.getElementById('title').textContent]") == [title, title]
    run_to_the_end(browser)
    assert ("0.46" if code == "sv" else "0,46") in browser.run(SAID)
    browser.run(SET.format("language", "fr", "change"))
    assert browser.run("document.documentElement.lang") == "fr"
    assert browser.run("document.getElementById('toggle').title") == "Lecture"
    axis = "ticksOf(-5e-7, 1.5e-6, 4).concat(ticksOf(0, 2e5, 2)).map(({text}) => text)"
    expected = [f"{MINUS}5·10⁻⁷", "0", "5·10⁻⁷", "1,0·10⁻⁶", "1,5·10⁻⁶", "0", "1·10⁵", "2·10⁵"]
    assert browser.run(axis) == expected
    assert browser.run("massLabels([1500, 0.25, null])") == ["1500 kg", "0,25 kg", "mur"]
    around = "[...document.querySelectorAll('.source, main > details:last-of-type summary, footer')].map((e) => e.textContent)"
    for word, text in zip(("éqs.", "Fichier de la scène", "fait avec softcradle"), browser.run(around), strict=True):
        assert word in text


@pytest.mark.parametrize("fragment", ["", "#with=steel&show=forces.loupes.balance.charts", "#n=49&lang=de"])
@pytest.mark.parametrize("width", [320, 390, 768, 1280, 2560])
def test_it_fits(pages, browser, width, fragment):
    browser.device(width, 844)
    browser.visit(pages("draft-gear-two-on-two").output, "#with=steel&lang=de")
    assert browser.run(
        "page.stages.every(({view}) => view.barRoom > 17)"
    )  # The bars that show forces have enough room between the captions and the beads.
    browser.visit(pages(SCENE).output, fragment)
    assert browser.run(FITS)
    # The Play button is visible without scrolling.
    assert browser.run("document.getElementById('toggle').getBoundingClientRect().bottom") <= 844
    for name, free, height in browser.run(COVERED):
        assert free, name
        # The accessibility guideline WCAG 2.2 requires a target size of at least 24 pixels.
        assert height >= 24.0, name


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("device", DEVICES)
def test_the_page_is_drawn_accessibly(pages, browser, tmp_path, device, scheme):
    browser.device(*DEVICES[device])
    browser.media("screen", scheme)
    browser.visit(pages(SCENE).output, "#with=none&t=1.9")
    picture = seen(browser, tmp_path)
    ground = np.median(picture, axis=(0, 1))
    assert (ground > 230).all() if scheme == "light" else (ground < 40).all()
    beads = browser.run("[0, 1, 2, 3, 4].map((k) => page.theme.bead(k))")
    areas = [(np.abs(picture - ImageColor.getrgb(bead)).max(axis=2) < 3).sum() for bead in beads]
    assert min(areas) > 100  # The colour of each bead fills more than 100 pixels.
    style = "getComputedStyle(document.documentElement).getPropertyValue('--{}').trim()"
    # Names of text colours and background colours in the style sheet. Canvases and SVG pictures use the same colours.
    for pair in ("ink", "paper"), ("muted", "paper"), ("ink", "card"), ("muted", "card"), ("alarm", "paper"):
        colours = [ImageColor.getrgb(browser.run(style.format(name))) for name in pair]
        assert contrast(*colours) >= 4.5, pair
    browser.run(AXE.read_text(encoding="utf-8") + "; document.getElementById('contrast').click(), page.go(1.5)")
    found = browser.run("axe.run().then(({violations, passes}) => ({violations, passes: passes.length}))")
    assert [(rule["id"], [node["html"] for node in rule["nodes"]]) for rule in found["violations"]] == []
    assert found["passes"] > 20
    browser.media("print")
    for part, shown in ((".transport", "none"), (".stage", "block")):
        assert browser.run(f"getComputedStyle(document.querySelector('{part}')).display") == shown


def covering(one, other):
    return min(one[3], other[3]) - max(one[1], other[1]) > 1 and min(one[4], other[4]) - max(one[2], other[2]) > 1


@pytest.mark.parametrize("width", [320, 390, 600, 740, 900, 1280])
@pytest.mark.parametrize("name", ["one-on-four", "one-on-ten", "three-on-five", TRAIN, "train-starting"])
@pytest.mark.parametrize("language", ["en", "de"])
def test_no_text_of_the_drawing_covers_another_or_leaves_it(pages, browser, name, width, language):
    """Check that no text in the drawing overlaps another text or leaves the drawing.

    The numbers of the beads are left out, because they move across each other together with the beads.
    """
    browser.device(width, 844)
    browser.visit(pages(name).output, f"#t=0&with=none&lang={language}")
    browser.run(SPY)
    room = browser.run("document.querySelector('.stage').clientWidth")
    for share in np.linspace(0.0, 1.0, 9):
        browser.run(f"page.go(page.source.begun + {share} * (page.source.last - page.source.begun))")
        browser.run("texts.length = rules.length = 0, page.dress()")
        texts, rules = browser.run("[texts, rules]")
        words = [text for text in texts if not text[0].isdigit()]
        pairs = [(a, b) for k, a in enumerate(texts) for b in words if b not in texts[: k + 1]]
        assert [(a[0], b[0]) for a, b in pairs if covering(a, b)] == []
        assert [text for text in texts if any(covering(text, rule) for rule in rules)] == []
        assert [text for text in words if text[1] < -1 or text[3] > room + 1] == []


def test_force_bars_next_to_a_wall_cover_no_text(browser, tmp_path):
    visit_row(browser, tmp_path, 8.0, mass=[1, 1, 1, inf], velocity=[1, 0, 0, 0], gap=[0.5, 0, 0.3])
    browser.device(1100, 900)
    texts = browser.run(f"{SPY}, page.go(3.6), texts.length = 0, page.dress(), texts")
    (scale,) = [text for text in texts if text[0] == "drawn to scale"]
    assert [text[0] for text in texts if text is not scale and covering(text, scale)] == []
    assert browser.run("(({ground, base, size}) => (ground - base) / size)(page.stages[0].view)") > 1.2


@pytest.mark.parametrize("name", scenes.names())
def test_every_scene_plays_to_its_end_without_an_error(pages, browser, name):
    browser.visit(pages(name).output, "")
    browser.run("page.pause(), window.span = page.source.last - page.source.begun")
    browser.run("for (let k = 0; k <= 40; k++) page.go(page.source.begun + k / 40 * span)")
    assert np.isfinite(velocities(browser)).all()
    assert browser.run(INSIDE)
    dissipative = scenes.load(name).lanes[0].chain().dissipative
    assert (browser.run("page.source.values(0).absorbed") > 0.0) == dissipative
    assert browser.run(FITS)


def test_beads_smaller_than_a_pixel_are_drawn(browser, tmp_path):
    visit_row(browser, tmp_path, mass=[1, 2, 1], velocity=[1, 0, 0], gap=[2000, 0])
    browser.run("page.edit('shown', SHOWN), page.pause()")
    assert browser.run("page.stages[0].view.size") < 1.0
    run_to_the_end(browser)
    browser.run("page.dress()")


def test_it_lives_in_a_frame_that_may_do_nothing_else(browser, tmp_path, monkeypatch):
    """Check the page inside the cell of a notebook. Such a page has no address, no clipboard and no storage."""
    monkeypatch.setitem(sys.modules, "anywidget", None)  # Without it the cell is a frame with the page.
    monkeypatch.delitem(sys.modules, "softcradle.sandbox.notebook.live_widget", raising=False)
    cell = scenes.load(SCENE).live()._repr_html_()
    (tmp_path / "notebook.html").write_text(f"<!doctype html><title>cell</title>{cell}", encoding="utf-8")
    browser.open(tmp_path / "notebook.html")
    for _ in range(1000):
        if len(np.unique(seen(browser, tmp_path).reshape(-1, 3), axis=0)) > 50:
            return
        time.sleep(0.1)
    pytest.fail("nothing is drawn")
