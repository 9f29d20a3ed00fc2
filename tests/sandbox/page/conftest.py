"""What the tests of pages share: pages written once, their tags and their data."""

import json
import re
from functools import cache
from html.parser import HTMLParser

import pytest
from softcradle.sandbox.page import render_page
from softcradle.sandbox.scene_runs import load_scene

SOFT = {"law": "power_law", "f0": 1.0, "alpha": 0.1}
VOID = frozenset({"meta", "link", "img", "br", "path", "rect", "input"})


class TagChecker(HTMLParser):
    """Checks that every tag is closed, and collects what the page would load and the ids that it has."""

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
    """A function: the page of a scene, written once, and what `render_page` reports of it."""
    folder = tmp_path_factory.mktemp("pages")
    return cache(lambda name: render_page(load_scene(name), folder / f"{name}.html"))
