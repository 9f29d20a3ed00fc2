"""The page in a real browser: drawn, played, scrubbed by mouse, keys and finger, without an error, open to everybody."""

from __future__ import annotations

import json
import math
import re
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from softcradle.sandbox.draw.number_format import MINUS

from softcradle import one_on, scenes, simulate
from tests.helpers.browser import Browser, found

pytestmark = [pytest.mark.slow, pytest.mark.skipif(found() is None, reason="there is no browser")]
DEVICES = {"telephone": (390, 844), "desk": (1280, 800)}
FITS = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
# Pairs of colours of the style sheet, text before ground; canvas and SVG text have the same.
TEXTS = [
    ("ink", "paper"),
    ("muted", "paper"),
    ("ink", "card"),
    ("muted", "card"),
    ("on-accent", "accent"),
    ("alarm", "paper"),
]
COVERED = """(() => [...document.querySelectorAll('button, input, select, summary')].map((control) => {
  const box = control.getBoundingClientRect(), x = box.x + box.width / 2, y = box.y + box.height / 2;
  control.scrollIntoView({block: 'center'});
  const now = control.getBoundingClientRect(), top = document.elementFromPoint(now.x + now.width / 2, now.y + now.height / 2);
  return [control.id || control.tagName, control === top || control.contains(top), box.height];
}))()"""


@pytest.fixture
def browser(tmp_path):
    with Browser(tmp_path / "profile") as opened:
        yield opened


def cells(browser, channel):
    """Texts of the cells with the values now."""
    query = (
        f"[...document.querySelectorAll('.member:not([hidden]) [data-now={channel}]')].map((cell) => cell.textContent)"
    )
    return browser.run(query)


def number(text):
    """A number as the page writes it."""
    text = text.replace(MINUS, "-").replace("·10", "e")
    return float(text.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")))


def test_values_at_a_moment_are_those_recorded(pages, browser):
    browser.visit(pages("one-on-four").output, "#t=1.883")
    found = simulate(scenes.load("one-on-four").lanes[0].chain(), [1, 0, 0, 0, 0], samples=[1.883], duration=2.0)
    assert browser.run("document.getElementById('clock').textContent") == "t = 1.883 s"
    shown = [number(text) for text in cells(browser, "velocity")]
    np.testing.assert_allclose(shown, found.velocity[0], atol=1e-3)
    np.testing.assert_allclose([number(text) for text in cells(browser, "force")], found.force[0], atol=1e-3)
    np.testing.assert_allclose([number(text) for text in cells(browser, "overlap")], found.overlap[0], rtol=0.06)
    assert cells(browser, "state") == ["loaded"] * 4
    assert browser.complaints == []


def test_a_law_of_ones_own_is_played_as_it_was_recorded(browser, tmp_path):
    recorded = simulate(one_on(4, lambda d: math.expm1(3.0 * d)), [1, 0, 0, 0, 0], method="conserving", samples=1001)
    recorded.to_page(tmp_path / "page.html")
    k = 400
    browser.visit(tmp_path / "page.html", f"#t={float(recorded.time[k])}")
    shown = [number(text) for text in cells(browser, "velocity")]
    np.testing.assert_allclose(shown, recorded.velocity[k], atol=1e-3)
    np.testing.assert_allclose([number(text) for text in cells(browser, "force")], recorded.force[k], atol=2e-3)
    assert browser.complaints == []


def test_values_of_a_contact_agree(pages, browser):
    """A contact that is open has no overlap, and one that is closed is not apart, nor are beads that just touch."""
    browser.visit(pages("one-on-ten").output, "#t=0")
    for share in np.linspace(0.0, 1.0, 41):
        browser.run(f"player.go(player.span[0] + {share} * (player.span[1] - player.span[0]))")
        states, overlaps = cells(browser, "state"), cells(browser, "overlap")
        assert all(state == "open" for state, overlap in zip(states, overlaps, strict=True) if overlap == "apart")
        assert all(
            overlap in ("apart", "touching") for state, overlap in zip(states, overlaps, strict=True) if state == "open"
        )
        if share == 0.0:
            assert overlaps == ["apart"] + 9 * ["touching"]


def test_it_plays_by_itself_and_pauses(pages, browser):
    browser.open(pages("one-on-four").output)
    first = browser.run("player.time")
    assert browser.run("player.playing")
    while browser.run("player.time") == first:
        time.sleep(0.02)
    browser.run("document.getElementById('play').click()")
    paused = browser.run("player.time")
    time.sleep(0.2)
    assert browser.run("player.time") == paused
    assert browser.run("document.getElementById('play').getAttribute('aria-label')") == "play"
    assert browser.complaints == []


@pytest.mark.parametrize("name", ["one-on-four", "one-on-ten"])
def test_a_fifth_of_what_is_played_at_most_comes_before_the_hit(pages, browser, name):
    """A longer flight is left out; it can still be wound back to."""
    browser.open(pages(name).output)
    begin, (first, end), hit = browser.run("[player.opening(), player.span, player.switches[0]]")
    assert first == 0.0
    assert (hit - begin) / (end - begin) <= 0.2 + 1e-9
    assert (begin > 0.0) == (hit > 0.2 * end)
    browser.run("player.pause(); player.go(0)")
    assert browser.run("player.time") == 0.0
    assert browser.complaints == []


def test_nobody_who_wants_less_motion_gets_some(pages, browser):
    browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    browser.open(pages("one-on-four").output)
    assert not browser.run("player.playing")
    assert max(number(text) for text in cells(browser, "force")) == pytest.approx(
        0.923, abs=1e-3
    )  # the strongest moment


def test_the_clock_is_that_of_the_wall(pages, browser):
    """Slow motion is as slow as it says, at 60 frames a second or fewer."""
    browser.visit(pages("one-on-four").output, "#t=0")
    passed = browser.run(
        "new Promise((done) => { player.play(); requestAnimationFrame((begin) => requestAnimationFrame(function next(now) {"
        "now - begin < 400 ? requestAnimationFrame(next) : done([(now - begin) / 1000, player.time]); })); })"
    )
    assert passed[1] == pytest.approx(passed[0] / 2.0, abs=0.05)


def test_a_frame_is_quick(pages, browser):
    """Drawing leaves most of a sixtieth of a second free: the best of many frames, whatever else the machine does."""
    browser.visit(pages("one-on-four").output, "#t=0")
    best = browser.run(
        "Math.min(...Array.from({length: 60}, (_, k) => { const begin = performance.now();"
        "player.time = k / 15; player.show(true); return performance.now() - begin; }))"
    )
    assert best < 8.0


def test_keys(pages, browser):
    browser.visit(pages("one-on-four").output, "#t=0.5")
    browser.key("ArrowRight")
    one = browser.run("player.time") - 0.5
    assert 0.0 < one < 0.05
    browser.key("ArrowLeft")
    browser.key("ArrowRight", shift=True)
    assert browser.run("player.time") - 0.5 == pytest.approx(10 * one)
    browser.key("PageDown")
    assert browser.run("player.time") == pytest.approx(1.0, abs=1e-6)  # the blow
    assert cells(browser, "state")[0] == "loaded"
    browser.key("PageDown")
    assert browser.run("player.time") == pytest.approx(2.80128, abs=1e-5)  # the striker leaves
    assert cells(browser, "state") == ["open", "loaded", "loaded", "loaded"]
    browser.key("PageUp")
    assert browser.run("player.time") == pytest.approx(1.0, abs=1e-6)
    browser.key("End")
    assert number(cells(browser, "velocity")[0]) == pytest.approx(-0.568, abs=1e-3)
    browser.key("Home")
    assert browser.run("player.time") == 0.0
    browser.key(" ")
    assert browser.run("player.playing")
    assert browser.complaints == []


def test_every_control_is_reached_by_the_keyboard_in_reading_order(pages, browser):
    browser.visit(pages("one-on-four", "alpha").output, "#t=1")
    order = []
    for _ in range(7):
        browser.key("Tab")
        order.append(browser.run("document.activeElement.id"))
    assert order == ["time", "back", "play", "ahead", "loop", "speed", "family"]
    outline = (
        "document.activeElement.matches(':focus-visible') && getComputedStyle(document.activeElement).outlineWidth"
    )
    assert browser.run(outline) == "3px"
    browser.key("ArrowRight")
    assert browser.run("document.getElementById('member').value") == "alpha = 1/7"


def test_the_slider_of_time_tells_its_value(pages, browser):
    browser.visit(pages("one-on-four").output, "#t=0")
    browser.run(
        "(() => { const slider = document.getElementById('time'); slider.value = '50000';"
        "slider.dispatchEvent(new Event('input')); })()"
    )
    begin, end = browser.run("player.span")
    assert browser.run("player.time") == pytest.approx((begin + end) / 2)
    told = browser.run("document.getElementById('time').getAttribute('aria-valuetext')")
    assert told == browser.run("document.getElementById('clock').textContent")


def test_a_finger_winds_the_motion(pages, browser):
    browser.device(*DEVICES["telephone"])
    browser.visit(pages("one-on-four").output, "#t=1")
    y = browser.run("document.querySelector('.stage').getBoundingClientRect().y") + 90
    browser.swipe((60.0, y), (240.0, y))
    begin, end = browser.run("player.span")
    width = browser.run("document.querySelector('.stage').clientWidth")
    assert browser.run("player.time") == pytest.approx(1.0 + (end - begin) * 180 / width, rel=0.02)
    assert browser.run("scrollY") == 0
    browser.swipe((60.0, y), (60.0, y))  # a tap plays
    assert browser.run("player.playing")
    assert browser.complaints == []


def test_a_press_on_a_chart_goes_to_its_time(pages, browser):
    browser.visit(pages("one-on-four").output, "#t=0")
    chart = "document.querySelector('svg[data-time]')"
    browser.run(f"{chart}.scrollIntoView({{block: 'center'}})")
    left, top, width, height = browser.run(
        f"(({{x, y, width, height}}) => [x, y, width, height])({chart}.getBoundingClientRect())"
    )
    place = {
        "x": left + width * (52 + 0.5 * (440 - 52 - 20)) / 440,
        "y": top + height / 2,
        "button": "left",
        "clickCount": 1,
    }
    browser.call("Input.dispatchMouseEvent", type="mousePressed", **place)
    browser.call("Input.dispatchMouseEvent", type="mouseReleased", **place)
    begin, end = browser.run(f"{chart}.dataset.time.split(' ').map(Number)")
    assert browser.run("player.time") == pytest.approx((begin + end) / 2, abs=0.01)
    line = browser.run("document.querySelector('.cursor').getAttribute('transform')")
    assert float(re.search(r"[\d.]+", line)[0]) == pytest.approx(52 + 0.5 * (440 - 52 - 20), abs=1.0)


def test_a_family_changes_beads_curves_and_tables(pages, browser):
    browser.visit(pages("one-on-four", "alpha").output, "#t=3")
    before = [cells(browser, "velocity"), browser.run("document.querySelector('.curve').getAttribute('d')")]
    browser.run(
        "(() => { const all = document.getElementById('family'); all.value = all.max; all.dispatchEvent(new Event('input')); })()"
    )
    after = [cells(browser, "velocity"), browser.run("document.querySelector('.curve').getAttribute('d')")]
    assert before[0] != after[0]
    assert before[1] != after[1]
    assert browser.run("[...document.querySelectorAll('.member:not([hidden])')].length") == 2  # notes and tables of one
    assert "hooke(1)" in browser.run("document.querySelector('main').innerText")
    assert browser.complaints == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("device", DEVICES)
def test_it_is_drawn(pages, browser, tmp_path, device, scheme):
    browser.device(*DEVICES[device])
    browser.media("screen", scheme)
    browser.visit(pages("one-on-four").output, "#t=1.883")
    assert browser.run(FITS)
    browser.picture(tmp_path / "page.png")
    with Image.open(tmp_path / "page.png") as opened:
        picture = np.asarray(opened.convert("RGB"), dtype=int)
    ground = np.median(picture, axis=(0, 1))
    assert (ground > 230).all() if scheme == "light" else (ground < 40).all()
    beads = browser.run("[0, 1, 2, 3, 4].map((k) => player.theme.bead(k))")
    colours = [tuple(int(bead[k : k + 2], 16) for k in (1, 3, 5)) for bead in beads]
    area = {bead: (np.abs(picture - colour).max(axis=2) < 3).sum() for bead, colour in zip(beads, colours, strict=True)}
    assert min(area.values()) > 100  # each bead has its part of the bars
    assert browser.complaints == []


# Boxes of the texts, and of the thin lines, that are drawn on the canvas of the beads from now on.
SPY = """(() => {
  const pen = CanvasRenderingContext2D.prototype, text = pen.fillText, box = pen.fillRect;
  window.texts = []; window.rules = [];
  pen.fillText = function (words, x, y) {
    const wide = this.measureText(words).width, left = {center: wide / 2, right: wide}[this.textAlign] || 0;
    const high = parseFloat(this.font.match(/([\\d.]+)px/)[1]);
    if (this.canvas.className === 'stage') texts.push([words, x - left, y - 0.72 * high, x - left + wide, y]);
    text.call(this, words, x, y);
  };
  pen.fillRect = function (x, y, wide, high) {
    if (this.canvas.className === 'stage' && high === 1.5) rules.push(['', x, y, x + wide, y + high]);
    box.call(this, x, y, wide, high);
  };
})()"""


def covering(one, other):
    return min(one[3], other[3]) - max(one[1], other[1]) > 1 and min(one[4], other[4]) - max(one[2], other[2]) > 1


@pytest.mark.parametrize("width", [320, 390, 600, 740, 900, 1280])
@pytest.mark.parametrize("name", ["one-on-four", "one-on-ten", "three-on-five", "train-shunting"])
def test_no_text_of_the_drawing_covers_another_or_leaves_it(pages, browser, name, width):
    """The numbers on beads are left out: they move over each other with the beads."""
    browser.device(width, 844)
    browser.visit(pages(name).output, "#t=0")
    browser.run(SPY)
    room = browser.run("document.querySelector('.stage').clientWidth")
    for share in np.linspace(0.0, 1.0, 9):
        browser.run("texts.length = rules.length = 0")
        browser.run(f"player.go(player.span[0] + {share} * (player.span[1] - player.span[0]))")
        texts, rules = browser.run("[texts, rules]")
        words = [text for text in texts if not text[0].isdigit()]
        assert [
            (a[0], b[0]) for k, a in enumerate(texts) for b in words if b not in texts[: k + 1] and covering(a, b)
        ] == []
        assert [text for text in texts if any(covering(text, rule) for rule in rules)] == []
        assert [text for text in words if text[1] < -1 or text[3] > room + 1] == []


@pytest.mark.parametrize("width", [320, 390])
def test_every_control_is_large_enough_for_a_finger_and_not_covered(pages, browser, width):
    browser.device(width, 844)
    browser.visit(pages("one-on-four", "alpha").output, "#t=1")
    for name, free, height in browser.run(COVERED):
        assert free, name
        assert height >= 24.0, name  # WCAG 2.2, target size
    assert browser.run(FITS)
    assert browser.run("document.getElementById('clock').getBoundingClientRect().right") <= width - 8


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_texts_stand_out(pages, browser, scheme):
    browser.media("screen", scheme)
    browser.visit(pages("one-on-four").output, "#t=1")
    style = "getComputedStyle(document.documentElement).getPropertyValue('--{}').trim()"
    for text, ground in TEXTS:
        assert contrast(*(browser.run(style.format(name)) for name in (text, ground))) >= 4.5, (text, ground)


def contrast(one, other):
    """The contrast of two colours as WCAG has it."""
    light, dark = sorted((_luminance(one), _luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def _luminance(colour):
    parts = np.array([int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)])
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("device", DEVICES)
def test_axe_finds_nothing(pages, browser, device, scheme):
    spec = find_spec("axe_core_python")
    if spec is None or spec.origin is None:
        pytest.skip("axe-core-python is not installed")
    browser.device(*DEVICES[device])
    browser.media("screen", scheme)
    browser.visit(pages("one-on-four", "alpha").output, "#t=1.5")
    browser.run((Path(spec.origin).parent / "axe.min.js").read_text(encoding="utf-8") + ";0")
    report = browser.run(
        "axe.run().then(({violations, passes}) => JSON.stringify({violations, passes: passes.length}))"
    )
    found = json.loads(report)
    assert [(rule["id"], [node["html"] for node in rule["nodes"]]) for rule in found["violations"]] == []
    assert found["passes"] > 20


def test_print_shows_the_motion_without_its_controls(pages, browser):
    browser.visit(pages("one-on-four").output, "#t=1.883")
    browser.media("print")
    assert browser.run("getComputedStyle(document.querySelector('.controls')).display") == "none"
    assert browser.run("getComputedStyle(document.querySelector('.stage')).display") == "block"
    assert browser.complaints == []


RATTLES = pytest.mark.filterwarnings("ignore:final velocities are determined:RuntimeWarning")


@pytest.mark.parametrize(
    "name",
    [
        "galilean", "draft-gear-two-on-two", "weak-contact", pytest.param("mixed", marks=RATTLES), "train-shunting",
        "prestressed",
    ],
)  # fmt: skip
def test_other_scenes_play_to_their_end_without_an_error(pages, browser, name):
    browser.visit(pages(name).output, "#t=0")
    browser.run(
        "for (let k = 0; k <= 100; k++) player.go(player.span[0] + k / 100 * (player.span[1] - player.span[0]))"
    )
    assert browser.run(FITS)
    assert browser.complaints == []
