"""Tests of the notebook widget, a web page that sends its state to Python."""

import sys

import pytest
from softcradle.sandbox.files import resource
from softcradle.sandbox.page import scene_text
from softcradle.sandbox.page.document import json_text

from softcradle import scenes
from tools.browser import Browser
from tools.browser import found as chromium

# Web page with a model that imitates the model of anywidget. The list `sent` contains the states that the model would
# send to Python.
MODEL = """<!doctype html><title>notebook</title><link rel="icon" href="data:,"><div id="cell"></div><script>
const values = {text: %s, height: 500}, sent = [], listeners = [];
const model = {get: (name) => values[name], set: (name, value) => { values[name] = value; },
  save_changes: () => sent.push(values.state), on: (_, work) => listeners.push(work), off: () => listeners.pop()};
</script><script type="module">%s; window.end = widget.render({model, el: document.getElementById("cell")});</script>"""


def test_without_anywidget_the_page_is_shown_and_its_state_names_the_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    monkeypatch.delitem(sys.modules, "softcradle.sandbox.notebook.live_widget", raising=False)
    page = scenes.load("one-on-four").live()
    assert "<iframe" in page._repr_html_()
    with pytest.raises(ImportError, match=r"needs anywidget, .*softcradle\[widget\]"):
        page.state  # noqa: B018


def test_settings_go_to_the_page_and_its_state_comes_back(monkeypatch, tmp_path):
    pytest.importorskip("anywidget")
    page = scenes.load("one-on-four").live()
    sent = []
    monkeypatch.setattr(type(page), "send", lambda _, message: sent.append(message))
    page.set(n=9, a="1/20", play=True)
    assert sent == [{"settings": {"n": 9, "a": "1/20"}, "play": True}]
    assert page.state == {}
    page.set_state({"state": {"outcome": "together"}})
    assert page.state["outcome"] == "together"
    page.save(tmp_path / "page.html")
    assert "</html>" in (tmp_path / "page.html").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.skipif(chromium() is None, reason="there is no browser")
def test_the_script_connects_a_model_with_the_page_in_a_browser(tmp_path):
    script = resource("widget.js").read_text(encoding="utf-8").replace("export default", "window.widget =")
    text = json_text(scene_text(scenes.load("one-on-four"))[0])
    (tmp_path / "notebook.html").write_text(MODEL % (text, script), encoding="utf-8")
    with Browser(tmp_path / "profile") as browser:
        browser.open(tmp_path / "notebook.html")
        first = browser.until("sent[0]")
        assert (first["settings"]["n"], first["outcome"]) == (4, None)
        browser.run("listeners[0]({settings: {n: 6, pace: 4}, play: true})")
        last = browser.until("sent.find((state) => state.outcome)")
        assert (last["settings"]["n"], last["outcome"], len(last["rows"][0]["velocity"])) == (6, "together", 7)
        browser.run("end()")
        assert browser.run("listeners.length") == 0
        assert browser.complaints == []
