"""Tests of sharing a web page by links, QR codes, embedded frames, tables and pictures.

The tests also check the messages between an embedded page and the website that contains it.
"""

import base64
import csv
import hashlib
import http.server
import io
import json
import re
import shutil
import subprocess
import threading
from functools import partial

import numpy as np
import pytest
from PIL import Image
from softcradle.sandbox.page.document import page_script_text

from tests.helpers.paths import ROOT
from tests.sandbox.page.conftest import ALONE, SCENE, SET, hold_the_clock, run_to_the_end
from tools.browser import found

NODE = shutil.which("node")
slow = [pytest.mark.slow, pytest.mark.skipif(found() is None, reason="there is no browser")]
LINK = "https://example.org/softcradle/one-on-four.html#n=9&a=0.05&with=steel&"
# Expected QR codes, computed with the Python package qrcode 8.2. Each entry contains the length of a text, the mask
# number and a digest of the code. The text is the beginning of LINK, which is repeated if necessary.
CODES = [
    (1, 3, "108d4f288f95ce68"),
    (14, 0, "f73768ff3fdee3d8"),
    (26, 1, "f1abee1353716bd7"),
    (60, 2, "c83e3639be932c6a"),
    (100, 4, "f4d752749fb62dff"),
    (150, 5, "7b4ebfc67cbfbd89"),
    (213, 6, "267d26c98d9d88f7"),
    (300, 7, "5e8ae6190cb847c6"),
    (500, 0, "4a26f5747bca5201"),
    (666, 3, "79fb83f16e1167db"),
]
KEPT = "window.kept = [], HTMLAnchorElement.prototype.click = function () { kept.push([this.download, this.href]); }, 0"
FIELD = "part('{}').value"


@pytest.fixture
def served(pages, process):
    """Open the page of the scene "one-on-four" from a local web server, and return the browser and the address."""
    page = pages(SCENE).output
    handler = partial(http.server.SimpleHTTPRequestHandler, directory=page.parent)
    handler.log_message = lambda *_: None
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_address[1]}/{page.name}"
        process.fresh()
        process.call("Page.navigate", url=f"{address}#n=2")
        loaded = "document.readyState === 'complete' && typeof started === 'object'"
        process.until(f"location.protocol === 'http:' && {loaded}")
        process.run("started.then((found) => { window.page = found; return 0; })")
        yield process, address
        server.shutdown()


@pytest.mark.skipif(NODE is None, reason="node is not installed")
@pytest.mark.parametrize(("length", "mask", "digest"), CODES)
def test_a_qr_code_has_the_modules_of_another_encoder(length, mask, digest):
    code = (
        f"{page_script_text('qr')}; console.log(JSON.stringify(qrCode({json.dumps((12 * LINK)[:length])}, [{mask}])))"
    )
    done = subprocess.run([NODE, "-e", code], capture_output=True, text=True, check=True)
    assert hashlib.sha256(done.stdout.strip().encode()).hexdigest()[:16] == digest


@pytest.mark.skipif(NODE is None, reason="node is not installed")
def test_the_mask_of_a_qr_code_has_the_lowest_penalty_and_a_long_text_has_no_code():
    code = f"""{page_script_text("qr")}
    const text = {json.dumps(LINK)}, each = [0, 1, 2, 3, 4, 5, 6, 7].map((mask) => qrPenalty(qrCode(text, [mask])));
    console.log(qrPenalty(qrCode(text)) === Math.min(...each), new Set(each).size > 4);
    console.log(qrCode("x".repeat(667)), qrCode("x".repeat(666)).length)"""
    done = subprocess.run([NODE, "-e", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["true", "true", "null", "97"]


class TestInABrowser:
    pytestmark = slow

    def test_a_web_page_shares_its_link_a_qr_code_and_a_code_for_a_frame(self, served):
        browser, address = served
        browser.run("part('link').click()")
        assert browser.run("part('share').open")
        assert browser.run(FIELD.format("share-link")) == f"{address}#n=2"
        drawn = """(() => { const {width, height} = part('qr'), pen = part('qr').getContext('2d'), found = [];
          for (let y = 18; y < height - 16; y += 4) for (let x = 18; x < width - 16; x += 4) {
            found.push(pen.getImageData(x, y, 1, 1).data[0] === 0 ? 1 : 0);
          }
          return found; })()"""
        assert browser.run(drawn) == browser.run(f"qrCode('{address}#n=2').flat()")
        code = browser.run(FIELD.format("share-code"))
        assert code.startswith(f'<iframe src="{address}#n=2&amp;embed=1" title="One bead on two (changed')
        value = "{writeText: async (text) => { window.copied = text; }}"
        browser.run(f"Object.defineProperty(navigator, 'clipboard', {{value: {value}, configurable: true}})")
        browser.run("part('copy-link').click()")
        assert browser.until("window.copied") == f"{address}#n=2"
        browser.run("Object.defineProperty(navigator, 'clipboard', {value: undefined}), part('copy-code').click()")
        # Without a clipboard, the page selects the text. The user can then copy the text manually.
        assert browser.until("document.activeElement.id === 'share-code' && part('share-code').selectionEnd") == len(
            code
        )
        browser.key("Escape")
        assert not browser.run("part('share').open")

    def test_a_file_shares_only_what_follows_its_name(self, pages, browser):
        browser.visit(pages(SCENE).output, "")
        browser.run("part('link').click()")
        assert "Send the file itself" in browser.run("part('share-note').textContent")
        assert browser.run("[part('share-link-part').hidden, part('qr').hidden]") == [True, True]
        browser.run("part('close').click()")
        for name, value in (("targets", 15), ("speed", 5), ("loss", 50)):
            browser.run(SET.format(name, value, "input"))
        browser.run(SET.format("beside", "gear", "change"))
        experiment = browser.run("part('link').click(), page.experiment")
        link = browser.run(FIELD.format("share-link"))
        # The link does not contain the local path of the file, because other people cannot use it.
        assert link.startswith("#")
        assert link in browser.run("part('share-note').textContent")
        browser.visit(pages(SCENE).output, link)
        opened = browser.run("page.experiment")
        near = {name: pytest.approx(one) if isinstance(one, float) else one for name, one in experiment.items()}
        assert opened == near
        assert (opened["targets"], opened["loss"], opened["beside"]) == (15, 0.5, "gear")

    def test_the_table_has_time_position_velocity_and_force_of_each_bead(self, pages, browser):
        browser.visit(pages(SCENE).output, "")
        run_to_the_end(browser)
        before = browser.run(
            f"{KEPT}, page.source.rows.map((row) => [...row.kernel.overlap, row.kernel.time, row.given])"
        )
        browser.run("part('link').click(), part('save-csv').click(), part('csv').open = true")
        ((name, address),) = browser.run("kept")
        assert name == "One-bead-on-four.csv"
        written = browser.until(FIELD.format("csv-text"))
        assert (
            browser.run(f"decodeURIComponent({json.dumps(address)}.split(',').slice(1).join(','))").split()
            == written.split()
        )
        rows = list(csv.DictReader(io.StringIO(written)))
        assert {row["row"] for row in rows} == {"1", "2"}
        soft = [row for row in rows if row["row"] == "1"]
        assert len(soft) > 200

        def column(title):
            return np.array([float(row[title]) for row in soft])

        time, beads = column("time (s)"), range(5)
        x, v, force = (
            np.array([column(f"{name} {k} ({unit})") for k in beads])
            for name, unit in (("position", "m"), ("velocity", "m/s"), ("force", "N"))
        )
        assert (np.diff(time) > 0).all()
        np.testing.assert_allclose(v.sum(axis=0), 1.0, atol=1e-8)
        np.testing.assert_allclose(np.diff(x, axis=1), 0.5 * (v[:, 1:] + v[:, :-1]) * np.diff(time), atol=2e-3)
        np.testing.assert_allclose(force[0], -column("contact force 0-1 (N)"), atol=1e-9)
        np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-8)
        assert (
            browser.run("page.source.rows.map((row) => [...row.kernel.overlap, row.kernel.time, row.given])") == before
        )

    @pytest.mark.parametrize("scheme", ["light", "dark"])
    def test_the_picture_has_the_rows_and_the_verdict(self, pages, browser, scheme):
        browser.media("screen", scheme)
        browser.visit(pages(SCENE).output, "")
        run_to_the_end(browser)
        browser.run(f"{KEPT}, part('link').click(), part('save-png').click()")
        ((name, address),) = browser.run("kept")
        assert name == "One-bead-on-four.png"
        with Image.open(io.BytesIO(base64.b64decode(address.partition(",")[2]))) as picture:
            pixels = np.asarray(picture.convert("RGB"), dtype=int)
        assert pixels.shape[0] > browser.run("page.stages.reduce((sum, {canvas}) => sum + canvas.height, 0)")
        assert (pixels[2, 2] > 200).all() if scheme == "light" else (pixels[2, 2] < 60).all()
        # The top of the picture contains the title and the verdict in a contrasting colour.
        assert (np.abs(pixels[:60] - pixels[2, 2]).max(axis=2) > 100).sum() > 500

    def test_a_recorded_page_is_shared_and_handed_in_as_well(self, pages, browser):
        browser.visit(pages("train-solid").output, "")
        browser.run(f"{KEPT}, page.pause(), part('link').click(), part('save-csv').click(), part('save-png').click()")
        assert [name.split(".")[-1] for name, _ in browser.run("kept")] == ["csv", "png"]

    @pytest.mark.parametrize("size", [(720, 420), (360, 640), (480, 320)])
    def test_an_embedded_page_has_stage_transport_softness_and_a_link(self, pages, browser, size):
        browser.device(*size)
        browser.visit(pages(SCENE).output, "#embed=1&n=6")
        shown = """[...document.querySelectorAll('button, input, select, summary, a')].filter((one) => one.offsetParent)
          .map(({id}) => id)"""
        expected = [
            "guess-last",
            "guess-together",
            "guess-spread",
            "time",
            "again",
            "toggle",
            "back",
            "ahead",
            "alpha",
            "full",
        ]
        assert browser.run(shown) == expected
        assert browser.run("page.stages[0].canvas.getBoundingClientRect().bottom") < size[1]
        bar = browser.run("part('transport').offsetHeight")
        assert bar <= (60 if size[1] < 560 else 110)  # In a low frame, the toolbar has only one line.
        browser.run("part('full').addEventListener('click', (event) => event.preventDefault()), part('full').click()")
        assert browser.run("part('full').href").endswith("page.html#n=6") or browser.run("part('full').href").endswith(
            "#n=6"
        )
        browser.run("page.edit('alpha', 0.5), page.pause(), page.write()")
        assert "embed=1" in browser.run("location.hash")

    def test_a_host_gets_sets_and_follows_the_state(self, pages, browser, tmp_path):
        page = pages(SCENE).output
        (tmp_path / "page.html").write_bytes(page.read_bytes())
        (tmp_path / "host.html").write_text(
            "<!doctype html><title>host</title><link rel=icon href='data:,'><iframe src='page.html#embed=1' "
            "sandbox='allow-scripts' width=720 height=420></iframe>"
            "<script>const answers = [], frame = document.querySelector('iframe');"
            "addEventListener('message', ({data}) => { if (data.softcradle === 'answer') answers.push(data); });"
            "const ask = (message) => frame.contentWindow.postMessage(message, '*');</script>",
            encoding="utf-8",
        )
        browser.open(tmp_path / "host.html")
        state = "answers.find(({{id}}) => id === {})?.state"
        browser.run("ask({softcradle: 'get', id: 1})")
        first = browser.until(state.format(1))
        assert first["settings"] | {"a": 0.1, "n": 4, "m": 1, "with": "steel"} == first["settings"]
        assert [row["velocity"] for row in first["rows"]] == [[1, 0, 0, 0, 0]] * 2
        assert (first["playing"], first["outcome"], first["guess"], first["unmet"]) == (False, None, None, [])
        browser.run(
            "ask({softcradle: 'set', id: 2, settings: {n: 6, a: '1/20', pace: 4, v: 99}, play: true, follow: true})"
        )
        second = browser.until(state.format(2))
        assert (second["settings"]["n"], second["settings"]["a"], second["playing"]) == (6, 0.05, True)
        assert second["unmet"] == ["v = 99 (here 1.4)"]
        last = browser.until("answers.map(({state}) => state).find(({outcome}) => outcome)")
        assert last["outcome"] == "together"
        assert "solid block" in last["story"]
        count = browser.run(
            "ask({softcradle: 'other'}), ask('get'), ask(null), ask({softcradle: 'get', id: 3}), answers.length"
        )
        browser.until(state.format(3))
        assert browser.run("answers.filter(({id}) => id === undefined).length") == 0
        assert browser.run("answers.length") >= count

    def test_the_host_of_the_documentation_shows_the_answer(self, pages, browser, tmp_path):
        (host,) = re.findall(
            r"```html\n(<iframe id=.*?)```", (ROOT / "docs/sharing.md").read_text(encoding="utf-8"), re.DOTALL
        )
        assert host.count("\n") == 12
        (tmp_path / "page.html").write_bytes(pages(SCENE).output.read_bytes())
        head = "<!doctype html><title>host</title><link rel=icon href='data:,'>"
        (tmp_path / "host.html").write_text(head + host, encoding="utf-8")
        browser.open(tmp_path / "host.html")
        said = "document.getElementById('said').textContent"
        assert browser.until(said) == "Waiting for the end."
        browser.run("ask({softcradle: 'set', settings: {pace: 4}}), document.querySelector('button').click()")
        ended = browser.until(f"{said}.includes('solid block') && {said}")
        block = "Seven of the nine beads moved off together, like one solid block."
        assert ended == f"Guess: null. {block} In a steel cradle only the last one does."

    def test_another_window_gets_no_answer(self, pages, browser):
        browser.visit(pages(SCENE).output, ALONE)
        browser.run("window.answers = [], addEventListener('message', ({data}) => answers.push(data)), 0")
        browser.run("postMessage({softcradle: 'get', id: 1}, '*'), postMessage('end', '*')")
        assert browser.until("answers.includes('end') && answers.length") == 2
        hold_the_clock(browser)
