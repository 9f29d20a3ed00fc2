"""Tests of the question that a web page asks before the motion.

The tests check the possible answers, the verdict after the motion, and the explanation at the moment of the largest
force.
"""

import numpy as np
import pytest
from softcradle.sandbox.page import render_page
from softcradle.scenes import Lane, Scene

from softcradle import scenes, simulate
from tests.sandbox.page.conftest import ALONE, SCENE, SOFT, TRAIN, hold_the_clock, run_to_the_end
from tools.browser import found

pytestmark = [pytest.mark.slow, pytest.mark.skipif(found() is None, reason="there is no browser")]
LEAD = "part('lead').textContent"
ASKED = "In Newton's cradle only the last ball flies off. How will these soft beads move?"
BLOCK = "Three of the four beads moved off together, like one solid block. In a steel cradle only the last one does."
SOFT_WHY = (
    "Squeezed by 45 cm, 3 cm, 0.6 mm and 0.6 µm, the contacts still push with 1, 3/4, 1/2 and 1/4 of the force. "
    "So the push reaches the last bead at once, without a wave: an evanescent mode."
)
STEEL_WHY = "the contacts push with 1, 1/9, 0 and 0 of the force. So the push runs along the row as a wave."
SCREENS = [(390, 664), (844, 390), (1280, 800), (1024, 600), (1920, 1080)]
# Script that returns the boxes of the sentences and of the pictures. All boxes must be visible without scrolling.
BOXES = """[part('lead'), ...page.stages.map(({canvas}) => canvas)].map((one) => one.getBoundingClientRect())
  .map(({left, top, right, bottom}) => [left, top, right, bottom])"""


def text(words):
    """Return the text with each no-break space replaced by an ordinary space."""
    return words.replace("\N{NO-BREAK SPACE}", " ")


@pytest.mark.parametrize(
    ("kind", "opinion"), [("last", "Not quite. "), ("together", "You were right. "), ("spread", "Not quite. ")]
)
def test_a_tap_answers_the_question_and_the_end_gives_the_verdict(pages, browser, kind, opinion):
    browser.device(390, 664)
    browser.visit(pages(SCENE).output, "")
    assert browser.run(f"[page.playing, page.specs.length, {LEAD}]") == [False, 2, ASKED]
    browser.run("page.next = () => 0")
    browser.run(f"part('guess-{kind}').click()")
    assert browser.run(f"[page.playing, part('guesses').offsetParent, {LEAD}]") == [True, None, ASKED]
    run_to_the_end(browser)
    assert browser.run(LEAD) == opinion + BLOCK
    # The verdict stays visible when the motion is rewound.
    assert browser.run("page.go(1), part('explain').offsetParent !== null")
    browser.run("page.edit('alpha', 1.5), page.pause()")
    assert browser.run("part('explain').hidden")
    browser.run("page.edit('alpha', 0.1), page.next = Page.prototype.next")
    run_to_the_end(browser)
    browser.run("page.chosen = {lane: 0, bead: 0}, page.throwChosen(1), page.pause()")
    assert browser.run(f"[part('explain').hidden, {LEAD}]") == [True, ASKED]


@pytest.mark.parametrize(
    ("name", "fragment", "verdict"),
    [
        (SCENE, "#a=1/40", "All four beads moved off together, like one solid block."),
        (SCENE, "#a=1/2&with=none", "They spread out, each at its own speed."),
        ("hertz-cradle", "#with=none", "Only the last one flew off."),
        ("hertz-cradle", "#m=2&with=none", "As many beads flew off as came."),
        ("three-on-five", "", "In a steel cradle as many fly off as came."),
        ("draft-gear-one-on-three", "", "cylinders moved off together, like one solid block."),
        ("steel-and-soft", "", BLOCK),
        (SCENE, "#lang=de", "Drei der vier Kugeln liefen zusammen los, wie ein starrer Block."),
        (SCENE, "#lang=fr", "Trois des quatre billes partent ensemble, comme un seul bloc solide."),
    ],
)
def test_the_verdict_follows_from_the_motion(pages, browser, name, fragment, verdict):
    browser.visit(pages(name).output, fragment)
    run_to_the_end(browser)
    assert verdict in browser.run(LEAD)


def test_why_stops_each_row_at_its_own_largest_force_and_explains_it(pages, browser):
    browser.visit(pages(SCENE).output, "")
    run_to_the_end(browser)
    browser.run("part('explain').click()")
    soft, steel = text(browser.run(LEAD)).split("\n")
    assert soft == f"soft beads, alpha = 1/10: {SOFT_WHY}"
    assert steel.endswith(STEEL_WHY)
    (lane,) = scenes.load(SCENE).lanes
    motion = simulate(lane.chain(), lane.velocity, samples=20001)
    force, overlap = browser.run("[Array.from(page.peaks[0].force), Array.from(page.peaks[0].overlap)]")
    peak = int(motion.force.max(axis=1).argmax())
    np.testing.assert_allclose(force, motion.force[peak], rtol=0.01)
    np.testing.assert_allclose(overlap, motion.overlap[peak], rtol=0.1)
    times, axes = browser.run("[page.peaks.map(({time}) => time), page.stages.map(({view}) => view.force)]")
    tops = browser.run("page.peaks.map(({force}) => Math.max(...force))")
    assert times[0] - times[1] > 0.5
    np.testing.assert_allclose(np.divide(axes, tops), 1.12)  # Each row of beads has its own scale of forces.
    assert browser.run("page.stages.map(({view}) => view.loupeFit.contacts)") == [[0, 1, 2, 3]] * 2
    assert browser.run("page.source.time") == pytest.approx(times[0], abs=0.02)
    browser.run("part('explain').click()")
    assert browser.run(f"[page.peaks, {LEAD}]") == [None, BLOCK]
    browser.run("part('explain').click(), part('toggle').click(), page.pause()")
    assert browser.run("page.peaks") is None  # The motion continues from the moment of the largest force.
    assert browser.run("page.source.time") == pytest.approx(times[0], abs=0.2)


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (
            "de",
            "Um 45 cm, 3 cm, 0,6 mm und 0,6 µm eingedrückt, drücken die Kontakte immer noch mit 1, 3/4, 1/2 und 1/4",
        ),
        ("fr", "Enfoncés de 45 cm, 3 cm, 0,6 mm et 0,6 µm, les contacts poussent encore avec 1, 3/4, 1/2 et 1/4"),
    ],
)
def test_the_explanation_is_translated(pages, browser, code, words):
    browser.visit(pages(SCENE).output, f"#lang={code}")
    run_to_the_end(browser)
    browser.run("page.reveal()")
    assert words in text(browser.run(LEAD))


def test_a_long_row_is_explained_by_four_contacts_from_its_struck_one_to_its_end(pages, browser):
    browser.visit(pages(SCENE).output, "#m=3&n=12&a=1/20")
    run_to_the_end(browser)
    browser.run("page.reveal()")
    assert browser.run("page.stages[0].view.loupeFit.contacts") == [2, 6, 9, 13]
    assert "contacts 2-3, 6-7, 9-10 and 13-14 still push with 1," in text(browser.run(LEAD))


@pytest.mark.parametrize("size", SCREENS)
@pytest.mark.parametrize("language", ["en", "de"])
def test_the_explanation_fits_into_the_first_screen(pages, browser, size, language):
    browser.device(*size)
    browser.visit(pages(SCENE).output, f"#lang={language}")
    run_to_the_end(browser)
    browser.run("scrollTo(0, 300), page.reveal()")
    assert browser.run("scrollY") == 0
    boxes = browser.run(BOXES)
    for left, top, right, bottom in boxes:
        assert 0 <= left < right <= size[0]
        assert 0 <= top < bottom <= size[1]
    play = browser.run("(({top, bottom}) => [top, bottom])(part('toggle').getBoundingClientRect())")
    assert play[1] <= size[1]
    # The toolbar with the Play button does not cover the magnified contacts.
    assert max(bottom for _, _, _, bottom in boxes[1:]) <= play[0] + 1
    assert browser.run("page.stages.every(({view}) => view.loupeFit.contacts.length === 4)")


@pytest.mark.parametrize("size", SCREENS)
def test_question_answers_and_beads_are_in_the_first_screen(pages, browser, size):
    browser.device(*size)
    browser.visit(pages(SCENE).output, "")
    parts = "[part('lead'), ...part('guesses').children, ...page.stages.map(({canvas}) => canvas), part('toggle')]"
    bottoms = browser.run(f"{parts}.map((one) => one.getBoundingClientRect().bottom)")
    assert max(bottoms) <= size[1]
    assert len(bottoms) == 7


def test_a_question_of_the_author_has_no_answers_of_the_page(browser, tmp_path):
    scene = Scene(title="a row", question="What will happen?", lanes=(Lane(contact=SOFT, velocity=[1, 0, 0]),))
    browser.visit(render_page(scene, tmp_path / "page.html").output, ALONE)
    assert browser.run(f"[part('guesses').hidden, page.playing, {LEAD}]") == [True, True, "What will happen?"]
    run_to_the_end(browser)
    assert browser.run(f"[part('explain').hidden, {LEAD}]") == [False, "What will happen?"]


def test_a_recording_explains_as_well(pages, browser, tmp_path):
    page = pages(SCENE).output.read_text(encoding="utf-8")
    (tmp_path / "page.html").write_text(page.replace(" 'wasm-unsafe-eval'", ""), encoding="utf-8")
    browser.visit(tmp_path / "page.html", "")
    run_to_the_end(browser)
    assert browser.run(LEAD).startswith("Three of the four beads moved off together")
    browser.run("part('explain').click()")
    assert "1, 3/4, 1/2 and 1/4 of the force" in text(browser.run(LEAD))


def test_a_row_without_a_question_plays_at_once_and_explains_nothing(pages, browser):
    browser.visit(pages(TRAIN).output, "")
    assert browser.run("[page.playing, part('guesses').hidden, part('explain').hidden]") == [True, True, True]
    hold_the_clock(browser)
    run_to_the_end(browser)
    assert browser.run(f"[part('explain').hidden, {LEAD}]") == [True, ""]
