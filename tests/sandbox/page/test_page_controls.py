"""Tests of the controls of the web page.

The tests check names and roles for screen readers, keys, touch, colour contrast and sizes. The tests also check
settings that a link requests.
"""

import numpy as np
import pytest
from PIL import Image, ImageColor
from softcradle.sandbox.page import render_page
from softcradle.scenes import Lane, Scene

from tests.helpers.drawn_text import contrast
from tests.sandbox.page.conftest import (
    ALONE,
    LEDGER,
    NOTICE,
    PLACE,
    SAID,
    SCENE,
    SET,
    SOFT,
    TRAIN,
    hold_the_clock,
    pictures,
    run_to_the_end,
    velocities,
    visit_row,
)
from tools.browser import found

pytestmark = [pytest.mark.slow, pytest.mark.skipif(found() is None, reason="there is no browser")]
SIZES = [(390, 664), (844, 390), (320, 640), (1280, 800)]
ROLES = ("application", "button", "checkbox", "combobox", "image", "img", "slider", "timer", "DisclosureTriangle")
CONTROLS = [
    ("application", "The beads of One bead on four. Arrow keys choose one, Enter grabs or releases it; while held, arrows "
     "pull it; Shift with an arrow throws it."),
    ("slider", "Time of the motion"), ("button", "Restart"), ("button", "Play"), ("button", "One step back"),
    ("button", "One step forward"), ("timer", ""), ("combobox", "Playback speed"), ("button", "Compare with steel balls"),
    ("combobox", "Contacts"), ("slider", "Softness (exponent \N{GREEK SMALL LETTER ALPHA})"), ("slider", "Beads at rest"),
    ("slider", "Beads that hit them"), ("slider", "Speed"), ("combobox", "Compare with"), ("slider", "Ground friction"),
    ("slider", "Energy lost in each contact"), ("checkbox", "forces"), ("checkbox", "magnifiers"),
    ("checkbox", "energy and momentum bars"), ("checkbox", "graphs"), ("button", "Share"), ("combobox", "Language"),
    ("button", "Only the last one flies off"), ("button", "All move off together"), ("button", "Each goes at its own speed"),
]  # fmt: skip
SLIDERS = {  # For each slider: the keys to press, and the text of its value after each key.
    "alpha": [("ArrowRight", "1/9"), ("Home", "1/40"), ("ArrowRight", "1/35"), ("End", "1.5")],
    "targets": [*[("ArrowRight", str(n)) for n in range(5, 10)], ("ArrowLeft", "8"), ("Home", "1"), ("End", "49")],
    "strikers": [("ArrowRight", "2"), ("ArrowUp", "3"), ("ArrowDown", "2"), ("End", "10"), ("Home", "1")],
    "speed": [("ArrowRight", "1.05 m/s"), ("ArrowLeft", "1 m/s"), ("Home", "0.2 m/s"), ("End", "1.4 m/s")],
    "friction": [("ArrowRight", "0.001"), ("Home", "0")],
    "loss": [("ArrowRight", "1 %"), ("ArrowRight", "2 %"), ("End", "90 %"), ("Home", "0 %")],
}
AT = """(() => { const box = document.getElementById('%s').getBoundingClientRect();
  return [box.left, box.top, box.width, box.height]; })()"""
# Script that records the texts drawn on canvases. For each text, the script stores its colour and the most frequent
# colour behind the text.
WRITTEN = """(() => {
  const pen = CanvasRenderingContext2D.prototype, text = pen.fillText;
  window.written = [];
  pen.fillText = function (words, x, y, room) {
    const {a, d} = this.getTransform(), wide = this.measureText(words).width, count = new Map();
    const left = x - ({center: wide / 2, right: wide}[this.textAlign] || 0), high = parseFloat(this.font.match(/([\\d.]+)px/)[1]);
    const top = y - 0.8 * high;
    const {data} = this.getImageData(Math.floor(left * a), Math.floor(top * d), Math.ceil(wide * a), Math.ceil(high * d));
    for (let k = 0; k < data.length; k += 4) {
      const colour = data.slice(k, k + 4).join();
      count.set(colour, (count.get(colour) ?? 0) + 1);
    }
    const [behind] = [...count].sort((one, other) => other[1] - one[1])[0];
    written.push([words, this.fillStyle, behind.split(',').map(Number)]);
    text.call(this, words, x, y, room);
  };
})()"""


def tree(browser):
    """Return the role, the name and the properties of each element in the accessibility tree of the browser."""
    browser.call("Accessibility.enable")
    nodes = browser.call("Accessibility.getFullAXTree")["nodes"]
    return [
        (node["role"]["value"], node.get("name", {}).get("value", ""), node.get("value", {}).get("value"))
        for node in nodes
        if not node["ignored"]
    ]


def test_every_control_has_its_role_and_name(live):
    live.run("page.pause()")
    found = [(role, name) for role, name, _ in tree(live) if role in ROLES]
    assert [each for each in CONTROLS if each not in found] == []
    charts = [name for role, name in found if role in ("image", "img")]
    assert charts == [
        f"{name}. The values are under “In numbers” below." for name in ("Velocities (m/s)", "Forces (N)")
    ]
    assert len(found) == len(CONTROLS) + len(charts) + sum(role == "DisclosureTriangle" for role, _ in found)


@pytest.mark.parametrize("language", ["en", "de", "fr"])
@pytest.mark.parametrize(
    "name", [SCENE, "steel-and-soft", "draft-gear-two-on-two", "train-solid", "experiment-one-on-three"]
)
def test_no_control_is_without_a_name_or_has_that_of_another(pages, browser, name, language):
    browser.visit(pages(name).output, f"#lang={language}")
    browser.run("page.pause(), page.edit('shown', SHOWN)")
    named = [(role, name) for role, name, _ in tree(browser) if role in ROLES and role != "timer"]
    assert [role for role, name in named if not name.strip()] == []
    assert len(set(named)) == len(named)


def test_sliders_move_by_keys_in_steps_that_one_wants(live):
    for name, presses in SLIDERS.items():
        live.run(f"document.getElementById('{name}').focus()")
        for key, text in presses:
            live.key(key)
            shown = live.run(f"[part('{name}-value').textContent, part('{name}').getAttribute('aria-valuetext')]")
            assert shown == [text, text], (name, key)


def test_every_control_is_reached_and_works_by_keys(live):
    live.run("page.pause(), document.activeElement.blur()")
    reached = []
    for _ in range(40):
        live.key("Tab")
        reached.append(live.run("document.activeElement.id || document.activeElement.tagName"))
    expected = ["link", "language", "guess-last", "guess-together", "guess-spread", "CANVAS",
                "time", "again", "toggle", "back", "ahead", "pace", "contrast", "law", "alpha",
                "targets", "strikers", "speed", "beside", "friction", "loss", "show-forces"]  # fmt: skip
    assert reached[: len(expected)] == expected
    works = {
        "toggle": (" ", "page.playing"),
        "again": ("Enter", "page.source.time"),
        "contrast": ("Enter", "page.experiment.beside"),
        "pace": ("ArrowDown", "page.experiment.pace"),
        "law": ("ArrowDown", "page.experiment.law"),
        "beside": ("ArrowUp", "page.experiment.beside"),
        "language": ("ArrowDown", "page.language"),
        "time": ("Home", "page.source.time"),
        "show-loupes": (" ", "page.experiment.shown.join()"),
        "ahead": ("Enter", "page.source.time"),
    }
    for name, (key, state) in works.items():
        before = live.run(f"page.pause(), page.go(1.5), document.getElementById('{name}').focus(), {state}")
        live.key(key)
        assert live.run(f"[{state}, page.pause()][0]") != before, name


def test_nothing_that_is_read_aloud_changes_while_the_motion_plays(live):
    hold_the_clock(live)
    live.run("""window.spoken = 0, new MutationObserver((all) => {
      for (const {target} of all) {
        const part = target.nodeType === 1 ? target : target.parentElement;
        if (part.closest('output, [role=status], [role=alert], [role=log], [aria-live]:not([aria-live=off])')) spoken += 1;
      }
    }).observe(document, {subtree: true, childList: true, characterData: true}), 0""")
    before = live.run("document.getElementById('clock').textContent")
    pictures(live, 120)
    assert live.run("document.getElementById('clock').textContent") != before
    assert live.run("spoken") == 0
    assert "timer" in [role for role, _, _ in tree(live)]
    lengths = {len(live.run(f"page.pause(), page.go({t}), part('clock').textContent")) for t in np.linspace(0.9, 4, 30)}
    assert len(lengths) == 1  # The text of the clock always has the same number of digits, so the digits do not move.


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("fragment", [ALONE, "#with=steel"])
def test_beads_and_softness_are_seen_together(pages, browser, size, fragment):
    browser.device(*size)
    browser.visit(pages(SCENE).output, fragment)
    browser.run("page.pause(), part('alpha').focus(), part('alpha').scrollIntoView({block: 'nearest'})")
    for lane in range(1 if fragment == ALONE else 2):
        seen = f"""(() => {{ const stage = page.stages[{lane}], box = stage.canvas.getBoundingClientRect();
          return document.elementFromPoint(box.left + stage.middle(2), box.top + stage.view.ground - 5) === stage.canvas; }})()"""
        assert browser.run(seen)
    x, y, wide, high = browser.run(AT % "alpha")
    assert browser.run(f"document.elementFromPoint({x + wide / 2}, {y + high / 2}).id") == "alpha"
    # The bars that show forces have enough room to be distinguished.
    assert browser.run("page.stages.every(({view}) => view.barRoom > 12)")


@pytest.mark.parametrize("size", [(320, 256), (390, 664), (844, 390), (320, 640), (640, 400)])
def test_the_first_screen_shows_beads_and_no_bar_lies_on_them(pages, browser, size):
    """Check that small screens show the beads without scrolling, and that no toolbar covers them.

    The size 320 by 256 is a screen of 1280 by 1024 pixels at a zoom of 400 %.
    """
    browser.device(*size)
    browser.visit(pages(SCENE).output, ALONE)
    x, y, high = browser.run(PLACE % 2)
    assert y + high / 2 < size[1]
    assert browser.run(f"document.elementFromPoint({x}, {y}) === page.stages[0].canvas")
    browser.run("page.pause(), scrollTo(0, 1e6)")
    fixed = "[...document.querySelectorAll('#bench, .transport')].filter((one) => getComputedStyle(one).display !== 'contents')"
    boxes = browser.run(f"{fixed}.map((one) => one.getBoundingClientRect()).map(({{top, bottom}}) => [top, bottom])")
    wide = size[0] >= 640  # On a wide screen, the settings are to the right of the beads and scroll separately.
    for top, bottom in boxes:
        assert min(bottom, size[1]) - max(top, 0) <= (size[1] if wide else 0.7 * size[1])


@pytest.mark.parametrize("width", [320, 390, 1280])
def test_targets_are_large_enough_for_fingers(pages, browser, width):
    browser.device(width, 844)
    browser.visit(pages(SCENE).output, ALONE)
    small = """[...document.querySelectorAll('button, input, select, summary')].filter((e) => e.offsetParent)
      .map((e) => [e.id || e.textContent, (e.type === 'checkbox' ? e.closest('label') : e).getBoundingClientRect().height])
      .filter(([, high]) => high < 44)"""
    assert browser.run(small) == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize(
    ("name", "fragment"), [(SCENE, ""), (SCENE, "#n=20"), ("steel-and-soft", ""), ("galilean", "")]
)
def test_texts_of_canvases_and_edges_of_controls_stand_out(pages, browser, name, fragment, scheme):
    browser.media("screen", scheme)
    browser.device(1280, 800)
    browser.visit(pages(name).output, fragment)
    browser.run("page.pause(), page.go(1.9), page.edit('shown', SHOWN), page.pause()")
    browser.run(f"{WRITTEN}, page.go(1.9), written.length = 0, page.dress()")
    style = browser.run(
        "['paper', 'card', 'edge', 'ink'].map((one) => getComputedStyle(document.body).getPropertyValue('--' + one))"
    )
    paper, card, edge, ink = map(ImageColor.getrgb, style)
    texts = browser.run("written")
    assert len(texts) > 20
    for words, colour, (*behind, opacity) in texts:
        ground = tuple(behind) if opacity == 255 else paper
        assert contrast(ImageColor.getrgb(colour), ground) >= 4.5, words
    for one, other in ((edge, paper), (edge, card), (ink, paper)):
        assert contrast(one, other) >= 3.0  # The accessibility guideline WCAG 1.4.11 requires a contrast of at least 3.
    used = browser.run("['toggle', 'back', 'law'].map((id) => getComputedStyle(part(id)).borderColor)")
    assert all(contrast(ImageColor.getrgb(colour), paper) >= 3.0 for colour in used)


def test_tracks_of_sliders_are_seen_in_forced_colours(pages, browser, tmp_path):
    browser.call("Emulation.setEmulatedMedia", features=[{"name": "forced-colors", "value": "active"}])
    browser.device(1280, 800)
    browser.visit(pages(SCENE).output, ALONE)
    browser.run("page.pause()")
    x, y, wide, high = browser.run(AT % "alpha")
    browser.picture(tmp_path / "page.png")
    with Image.open(tmp_path / "page.png") as picture:
        colours = np.asarray(picture.convert("RGB"), dtype=int)
    column = colours[int(y) : int(y + high), int(x + 0.8 * wide)]
    assert max(contrast(tuple(one), tuple(column[0])) for one in column) >= 3.0


TOUCHED = f"[page.source.touched, page.source.time, page.source.count, page.experiment, {SAID}]"


def test_a_finger_that_scrolls_throws_no_bead_and_moves_no_slider(pages, browser):
    browser.device(390, 664)
    browser.visit(pages(SCENE).output, ALONE)
    run_to_the_end(browser)
    before = browser.run(TOUCHED)
    x, y, _ = browser.run(PLACE % 1)
    browser.swipe((x, y), (x + 6, y - 120))
    browser.until("scrollY > 50")
    assert browser.run(TOUCHED) == before
    assert browser.run(f"[page.playing, {LEDGER}.includes('added')]") == [False, False]
    for name in ("alpha", "targets", "speed"):
        browser.run(f"document.getElementById('{name}').scrollIntoView({{block: 'end'}})")
        x, y, wide, high = browser.run(AT % name)
        far, from_there, value = x + 0.9 * wide, browser.run("scrollY"), browser.run(f"part('{name}').value")
        browser.swipe((far, y + high / 2), (far - 6, y - 110))
        browser.until(f"scrollY > {from_there} + 40")
        assert browser.run(f"part('{name}').value") == value
        assert browser.run(TOUCHED) == before
    browser.run("page.charts[0].canvas.scrollIntoView({block: 'end'})")
    from_there = browser.run("scrollY")
    browser.swipe((250, 600), (247, 470))
    browser.until(f"scrollY > {from_there} + 40")
    assert browser.run(TOUCHED) == before


def test_a_finger_that_moves_sideways_or_taps_moves_a_slider_and_winds_a_chart(pages, browser):
    browser.device(390, 664)
    browser.visit(pages(SCENE).output, ALONE)
    browser.run("page.pause(), page.go(1.5), part('alpha').scrollIntoView({block: 'end'})")
    x, y, wide, high = browser.run(AT % "alpha")
    start = browser.run("page.experiment.alpha")
    browser.swipe((x + 0.3 * wide, y + high / 2), (x + 0.95 * wide, y + high / 2 + 10))
    assert browser.run("page.pause(), page.experiment.alpha") > start
    x, y, wide, high = browser.run(AT % "alpha")
    browser.finger("Start", x + 0.1 * wide, y + high / 2)
    browser.finger("End")
    assert browser.until("page.experiment.alpha < 0.05")
    browser.run("page.pause(), page.charts[0].canvas.scrollIntoView({block: 'end'})")
    box = browser.run("(({left, top}) => [left, top])(page.charts[0].canvas.getBoundingClientRect())")
    browser.finger("Start", box[0] + 100, box[1] + 90)
    browser.finger("End")
    tapped = browser.run("page.source.time")
    assert tapped == pytest.approx(browser.run("page.charts[0].timeAt(100)"), abs=0.05)
    browser.swipe((box[0] + 100, box[1] + 90), (box[0] + 200, box[1] + 96))
    assert browser.run("page.source.time") > tapped


def test_shift_and_an_arrow_throw_at_the_first_press(live):
    live.run("page.pause(), page.stages[0].canvas.focus()")
    live.key("ArrowRight", shift=True)
    live.run("page.pause()")
    assert live.run("[page.chosen.bead, page.source.touched]") == [0, True]


@pytest.mark.parametrize(
    ("name", "fragment", "expected", "notice"),
    [
        (SCENE, "#a=1/14", {"alpha": 1 / 14}, ""),
        (SCENE, "#a=1,5", {"alpha": 1.5}, ""),
        (SCENE, "#A=0,05&N=9&WITH=Steel", {"alpha": 0.05, "targets": 9, "beside": "steel"}, ""),
        (SCENE, "#a=1/0&m=1/2/3", {}, "This link asks for a = 1/0, m = 1/2/3, which this page cannot do."),
        (SCENE, "#n=100&v=3&pace=3", {"targets": 49, "speed": 1.4, "pace": 2},
         "This link asks for n = 100 (here 49), v = 3 (here 1.4), pace = 3 (here 2), which this page cannot do."),
        (SCENE, "#law=steel&with=steel&lang=xx&speed=2", {"law": "steel", "beside": "none"},
         "This link asks for with = steel, lang = xx, speed = 2, which this page cannot do."),
        (SCENE, "#show=forces.bars&t=-1", {"shown": ["forces"]},
         "This link asks for show = forces.bars, t = -1, which this page cannot do."),
        ("hertz-cradle", "#a=0.5", {}, "This link asks for a = 0.5, which this page cannot do."),
        (TRAIN, "#with=steel&n=3", {}, "This link asks for with = steel, n = 3 (here 11), which this page cannot do."),
        ("train-solid", "#n=9&pace=2", {"pace": 2},
         "This is a recording: you can play and rewind it, but not change it. "
         "This link asks for n = 9, which this page cannot do."),
    ],
)  # fmt: skip
def test_all_that_a_link_asks_is_done_or_named_in_one_line(pages, browser, name, fragment, expected, notice):
    browser.visit(pages(name).output, fragment)
    experiment, own = browser.run("[page.experiment, page.own]")
    assert experiment == own | {
        key: pytest.approx(one) if isinstance(one, float) else one for key, one in expected.items()
    }
    assert browser.run(NOTICE) == notice
    browser.run("page.edit('pace', 1)")
    # After a manual change, the page no longer shows what the link requested.
    assert "This link" not in browser.run(NOTICE)


def test_what_a_link_asks_is_named_once_if_webassembly_is_refused(pages, browser, tmp_path):
    text = pages(SCENE).output.read_text(encoding="utf-8")
    (tmp_path / "page.html").write_text(text.replace(" 'wasm-unsafe-eval'", ""), encoding="utf-8")
    browser.visit(tmp_path / "page.html", "#n=9&a=0.1&with=steel")
    said = browser.run(NOTICE)
    assert said.startswith("Your browser or this website blocks WebAssembly.")
    assert said.endswith(
        "This link asks for n = 9 (here 4), with = steel, which this page cannot do."
    )  # The message does not mention a = 0.1, because the scene already has this value.
    assert browser.run("part('title').textContent") == "One bead on four"
    browser.run(SET.format("language", "de", "change"))
    assert "n = 9 (hier 4), with = steel" in browser.run(NOTICE)


@pytest.mark.parametrize(
    ("name", "fragment", "title"),
    [
        (SCENE, "", "One bead on four"),
        (SCENE, "#with=steel&pace=2", "One bead on four"),
        (SCENE, "#n=9&a=0.05&with=steel", "One bead on nine (changed from: One bead on four)"),
        (SCENE, "#m=3&n=40", "Three beads on 40 (changed from: One bead on four)"),
        (SCENE, "#a=0.2", "One bead on four (changed)"),
        (SCENE, "#n=9&lang=de", "Eine Kugel auf neun (geändert aus: Eine Kugel auf vier)"),
        (SCENE, "#n=9&lang=fr", "Une bille contre neuf (modifié à partir de\u00a0: Une bille contre quatre)"),
        ("hertz-cradle", "#law=soft", "One bead on four (changed from: Newton's cradle: steel balls)"),
        ("galilean", "#mu=0.01", "(changed)"),
    ],
)
def test_the_title_names_what_is_shown_and_no_figure_that_is_not(pages, browser, name, fragment, title):
    browser.visit(pages(name).output, fragment)
    shown, tab, source = browser.run("[part('title').textContent, document.title, part('source').textContent]")
    assert shown == tab
    assert shown.endswith(title)
    assert bool(source) is ("(" not in title)


def test_an_unknown_language_in_a_link_is_that_of_the_reader(pages, browser):
    agent = browser.run("navigator.userAgent")
    browser.call("Emulation.setUserAgentOverride", userAgent=agent, acceptLanguage="sv,de-AT")
    browser.visit(pages(SCENE).output, "#lang=xx")
    assert browser.run("page.language") == "de"


@pytest.mark.parametrize(
    ("name", "fragment", "lead"),
    [
        (SCENE, "", "In Newton's cradle only the last ball flies off. How will these soft beads move?"),
        ("three-on-five", "", "In Newton's cradle as many balls fly off as came. How will these soft beads move?"),
        ("steel-and-soft", "", "In Newton's cradle only the last ball flies off. How will these soft beads move?"),
        (
            "draft-gear-one-on-three",
            "",
            "In Newton's cradle only the last ball flies off. How will these draft gears move?",
        ),
        ("hertz-cradle", "", "In Newton's cradle only the last ball flies off. How will these soft beads move?"),
        ("hertz-cradle", ALONE, "How many of these balls will fly off?"),
        (TRAIN, "", ""),
        ("prestressed", "", ""),
    ],
)
def test_a_question_stands_above_the_beads_and_the_text_below(pages, browser, name, fragment, lead):
    browser.visit(pages(name).output, fragment)
    assert browser.run("part('lead').textContent") == lead
    tops = browser.run("['lead', 'lanes', 'words', 'text', 'energy'].map((id) => part(id).getBoundingClientRect().top)")
    assert tops[not lead :] == sorted(tops[not lead :])


def test_a_question_of_the_scene_takes_the_place_of_the_usual_one(browser, tmp_path):
    scene = Scene(title="a row", question="What will happen?", lanes=(Lane(contact=SOFT, velocity=[1, 0, 0]),))
    browser.visit(render_page(scene, tmp_path / "page.html").output, "")
    assert browser.run("part('lead').textContent") == "What will happen?"


def test_lines_of_rigid_groups_are_drawn_with_their_legend_only_and_until_a_hand_moves_a_bead(pages, browser):
    lines = """(() => {
      const pen = CanvasRenderingContext2D.prototype, box = pen.fillRect;
      let count = 0;
      pen.fillRect = function (x, y, wide, high) {
        if (this === page.stages[0].pen && high === 1.5) count += 1;
        box.call(this, x, y, wide, high);
      };
      page.show(false);
      pen.fillRect = box;
      return count;
    })()"""
    legend = "page.stages[0].view.captions.found.some(({mark}) => mark)"
    for width, shown in ((1280, True), (320, False)):
        browser.device(width, 640)
        browser.visit(pages(SCENE).output, "#with=none&t=1.9")
        assert browser.run(legend) is shown
        assert (browser.run(lines) > 0) is shown
    browser.device(1280, 800)
    browser.visit(pages(SCENE).output, "#with=none&t=1.9")
    browser.run("page.chosen = {lane: 0, bead: 4}, page.throwChosen(-1), page.pause()")
    assert browser.run(f"[{legend}, {lines}]") == [False, 0]
    browser.visit(pages(TRAIN).output, "#t=0.5")
    assert browser.run(f"[{legend}, {lines}]") == [False, 0]


def test_a_row_on_a_bed_is_played_until_it_rests_and_keeps_the_sentence_of_its_collision(pages, browser):
    browser.visit(pages("experiment-one-on-three").output, "")
    browser.run("page.pause(), page.go(0.2)")
    assert browser.run("page.source.last") > 0.3
    assert "Cylinders 1 to 3 move right together" in browser.run(SAID)
    run_to_the_end(browser)
    assert np.abs(velocities(browser)).max() < 1e-6
    assert "Cylinders 1 to 3 move right together" in browser.run(SAID)
    assert browser.run(SAID).endswith("Then friction stopped them.")


def test_a_motion_that_ends_before_its_row_has_come_apart_says_so_and_shows_what_pushes_it(pages, browser):
    browser.visit(pages("prestressed").output, "")
    run_to_the_end(browser)
    assert browser.run(SAID) == "The motion is shown up to 12 s."
    assert browser.run("page.looks.map(({drive}) => drive)") == [None, [0, 0.75, 0, 0, -0.75]]


def test_energy_is_told_for_each_row_and_what_of_it_is_absorbed(pages, browser):
    browser.visit(pages(TRAIN).output, "")
    run_to_the_end(browser)
    assert browser.run(LEDGER).startswith("Total energy 160 kJ · 13")
    assert "kJ of it absorbed" in browser.run(LEDGER)
    browser.visit(pages(SCENE).output, "#with=steel")
    lines = browser.run(LEDGER).split("\n")
    assert [line.split(" · ")[0] for line in lines] == [
        "soft beads, alpha = 1/10: Total energy 0.5 J",
        "steel balls: Total energy 0.5 J",
    ]


@pytest.mark.parametrize(
    ("name", "words", "hint"),
    [
        (SCENE, "Bead", "a bead"),
        (TRAIN, "Wagon", "a wagon"),
        ("draft-gear-one-on-three", "Cylinder", "a cylinder"),
    ],
)
def test_bodies_are_called_what_they_are(pages, browser, name, words, hint):
    browser.visit(pages(name).output, "")
    assert browser.run(SAID) == f"Try it: drag {hint} and let go."
    run_to_the_end(browser)
    assert words in browser.run(SAID) or "shown up to" in browser.run(SAID)
    assert words.lower() in browser.run("page.stages[0].canvas.ariaLabel").lower()


def test_a_host_that_forbids_scripts_gets_a_sentence_and_no_dead_controls(pages, process, tmp_path):
    text = pages(SCENE).output.read_text(encoding="utf-8")
    (tmp_path / "page.html").write_text(
        text.replace("script-src 'unsafe-inline' 'wasm-unsafe-eval'", "script-src 'none'"), encoding="utf-8"
    )
    process.fresh()
    process.open(tmp_path / "page.html")
    wait = "getComputedStyle(document.getElementById('wait')).visibility === 'visible'"
    assert process.until(wait)
    assert "This site blocks the page" in process.run("document.getElementById('wait').innerText")
    assert (
        process.run("[...document.querySelectorAll('button, input, select')].filter((one) => one.offsetParent).length")
        == 0
    )
    process.visit(pages(SCENE).output, ALONE)
    assert process.run("document.getElementById('wait').offsetParent") is None


def test_a_finger_beside_the_beads_takes_none(browser, tmp_path):
    browser.device(390, 664)
    visit_row(browser, tmp_path, velocity=[1, 0, 0])
    box = browser.run("(({left, top}) => [left, top])(page.stages[0].canvas.getBoundingClientRect())")
    browser.swipe((box[0] + 40, box[1] + 20), (box[0] + 140, box[1] + 22))
    assert browser.run("[page.source.hand, page.source.touched]") == [None, False]


DIALOG = [
    ("textbox", "Link with your settings"), ("button", "Copy Link with your settings"), ("textbox", "Code for a web page"),
    ("button", "Copy Code for a web page"), ("button", "Table (CSV)"), ("button", "Picture (PNG)"),
    ("DisclosureTriangle", "Table to copy, if downloads are blocked"), ("textbox", "Table to copy, if downloads are blocked"),
    ("button", "Copy Table to copy, if downloads are blocked"), ("button", "Close"),
]  # fmt: skip


def test_every_control_of_the_dialog_has_its_role_and_name_and_is_reached_by_keys(live):
    live.run("page.edit('loss', 0.1), page.pause(), part('link').focus()")
    live.key("Enter")
    live.until("part('share').open")
    live.run("part('csv').open = true")
    found = [(role, name) for role, name, _ in tree(live) if role in (*ROLES, "textbox")]
    assert sorted(found) == sorted(DIALOG)  # While the dialog is open, only its own controls can be reached.
    reached = [live.run("document.activeElement.id")]
    for _ in range(len(DIALOG) - 1):
        live.key("Tab")
        reached.append(live.run("document.activeElement.id || document.activeElement.tagName"))
    assert reached == ["share-link", "copy-link", "share-code", "copy-code", "save-csv", "save-png", "csv-label", "csv-text",
                       "copy-csv", "close"]  # fmt: skip
    live.key("Enter")
    assert live.run("[part('share').open, document.activeElement.id]") == [False, "link"]


def test_the_question_is_answered_and_the_explanation_opened_by_keys(pages, browser):
    browser.visit(pages(SCENE).output, "")
    browser.run("page.next = () => 0, part('guess-together').focus()")
    browser.key("Enter")
    assert browser.run("[page.guess, page.playing, document.activeElement.id]") == ["together", True, "toggle"]
    browser.run("delete page.next")
    run_to_the_end(browser)
    assert ("button", "Why?") in [(role, name) for role, name, _ in tree(browser)]
    for pressed in ("true", "false"):
        browser.run("part('explain').focus()")
        browser.key(" ")
        state = "[part('explain').ariaPressed, page.peaks !== null, document.activeElement.id]"
        assert browser.run(state) == [pressed, pressed == "true", "explain"]
