"""What the tests of pages share: recorded scenes, the packed motion read back, and pages written once."""

import base64
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from softcradle.sandbox.page import render_page
from softcradle.sandbox.scene_runs import load_scene

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


def unpacked(packed, beads, scales):
    """What the page's script makes of `packed`, by name: (T,) or (T, k) values."""
    data, rows = base64.b64decode(packed["data"]), packed["rows"]
    split = 4 * rows * (beads + 3)
    floats = np.frombuffer(data[:split], "<f4").astype(float).reshape(-1, rows)
    codes = np.frombuffer(data[split:], "<i2").astype(float).reshape(-1, rows) / 32767
    return {
        "time": floats[0],
        "anchor": floats[1],
        "stored": floats[2],
        "absorbed": floats[3],
        "overlap": floats[4:].T * np.array(packed["depth"]),
        "velocity": codes[:beads].T * max(map(abs, scales.velocity)),
        "force": codes[beads:].T * scales.force,
    }


@pytest.fixture(scope="session")
def pages(tmp_path_factory):
    """A function: the page of a scene, written once, and what `render_page` reports of it; keywords are settings of the run."""
    written = {}
    folder = tmp_path_factory.mktemp("pages")

    def page(name, **settings):
        key = (name, *settings.values())
        if key not in written:
            path = folder / f"{'-'.join(key)}.html"
            written[key] = render_page(load_scene(name), path, **settings)
        return written[key]

    return page
