"""Fixtures and helpers for tests of web pages. Each page is written once, its tags and data are parsed, and a browser
opens it.
"""

import json
import re
from functools import cache
from html.parser import HTMLParser

import numpy as np
import pytest
from softcradle.sandbox.page import render_page
from softcradle.sandbox.scene_runs import load_scene
from softcradle.scenes import Lane, Scene

from tools.browser import Browser

SOFT = {"law": "power_law", "f0": 1.0, "alpha": 0.1}
SCENE = "one-on-four"
ALONE = "#with=none"  # End of the address of a page that shows no second row of beads for comparison.
TRAIN = "train"  # Name under which `pages` writes the scene of `uncoupled`.
BOOKED = 1e-10  # Largest allowed relative energy error.
SAID = "document.getElementById('words').textContent.replaceAll('\u00a0', ' ')"
LEDGER = "document.getElementById('energy').textContent"
NOTICE = "document.getElementById('notice').innerText"
SET = "(() => {{ const e = document.getElementById('{}'); e.value = '{}'; e.dispatchEvent(new Event('{}')); }})()"
PLACE = """(() => { const stage = page.stages[0], box = stage.canvas.getBoundingClientRect(); page.show(false);
  return [box.left + stage.middle(%d), box.top + stage.view.ground - stage.view.size / 2, stage.view.size]; })()"""
VOID = frozenset({"meta", "link", "img", "br", "path", "rect", "input"})


class TagChecker(HTMLParser):
    """A parser that checks that every tag is closed.

    The parser also collects the links and the ids of the page.
    """

    def __init__(self, text):
        super().__init__()
        self.stack, self.links, self.ids = [], [], []
        self.feed(text)
        assert self.stack == []

    def handle_starttag(self, tag, attrs):
        self.links += [value for name, value in attrs if name in ("src", "href", "poster", "srcset")]
        self.ids += [value for name, value in attrs if name == "id"]
        if tag not in VOID:
            self.stack.append(tag)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.stack.pop() == tag


def page_data(text):
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)[1])


@pytest.fixture(scope="session")
def pages(tmp_path_factory):
    """Return a function that writes the web page of a scene and returns the report of `render_page`.

    The page of each scene is written only once.
    """
    folder = tmp_path_factory.mktemp("pages")
    return cache(lambda name: render_page(uncoupled() if name == TRAIN else load_scene(name), folder / f"{name}.html"))


def uncoupled():
    """Return the scene "train-shunting" without couplers.

    The draft gears of the wagons push but do not pull, so a web page can compute the motion.
    """
    scene = load_scene("train-shunting")
    (lane,) = scene.lanes
    pushing = lane.model_copy(update={"contact": lane.contact.push, "approach": 0.02})
    return scene.model_copy(update={"lanes": (pushing,)})


@pytest.fixture(scope="module")
def process(tmp_path_factory):
    with Browser(tmp_path_factory.mktemp("browser") / "profile") as opened:
        yield opened


@pytest.fixture
def browser(process):
    """Return a browser that shows an empty page.

    After each test, check that the energy of the simulation is balanced and that the console is empty. Hints about
    reading the pixels of a canvas are ignored.
    """
    process.fresh()
    yield process
    assert process.run("typeof page === 'object' && page.source.live") is False or error(process) < BOOKED
    assert [one for one in process.complaints if "willReadFrequently" not in one] == []


@pytest.fixture
def live(pages, browser):
    """Return the browser with the page of the scene "one-on-four". The page shows no second row of beads for
    comparison.
    """
    browser.visit(pages(SCENE).output, ALONE)
    return browser


def error(browser):
    """Return the largest relative energy error of all rows of beads on the page.

    A row with a moving wall is left out, because its energy balance is unknown.
    """
    return browser.run("Math.max(...page.source.rows.map((row) => (row.balanced ? row.energyError() : 0)))")


def velocities(browser, lane=0):
    return np.array(browser.run(f"Array.from(page.source.values({lane}).velocity)"))


def hold_the_clock(browser):
    """Stop the clock of the page. Only calls of `pictures` advance the time, so the result does not depend on the load
    of the computer.
    """
    browser.run("page.again(), page.pause(), page.next = () => 0, window.clock = 0")


def pictures(browser, count):
    """Draw `count` frames of the motion, with 1/60 s between two frames."""
    browser.run(f"for (let k = 0; k < {count}; k++) page.picture(window.clock += 1000 / 60)")


def run_to_the_end(browser):
    browser.run("page.pause(), page.go(page.source.last)")
    browser.until("!page.playing")


def visit_row(browser, folder, duration=None, fragment=ALONE, method=None, **lane):
    """Open the web page of one row of beads.

    By default, the contacts are soft and the page shows no second row for comparison. If `method` is given, the page
    plays a recorded motion.
    """
    scene = Scene(title="a row", lanes=(Lane(**{"contact": SOFT} | lane),), duration=duration)
    browser.visit(render_page(scene, folder / "page.html", method=method).output, fragment)
    browser.run("page.pause()")
