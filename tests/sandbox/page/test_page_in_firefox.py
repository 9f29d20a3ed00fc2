"""Tests of the web page in Firefox. The tests are skipped if Firefox is not installed.

The page must compute and draw the motion without errors, at the size of a desktop screen and of a phone.
"""

import json
import os
import re
import shutil
from subprocess import PIPE, STDOUT, Popen

import numpy as np
import pytest

from softcradle import scenes, simulate

FIREFOX = next((path for name in ("firefox", "firefox-esr") if (path := shutil.which(name))), None)
pytestmark = [pytest.mark.slow, pytest.mark.skipif(FIREFOX is None, reason="there is no Firefox")]
# Firefox settings that disable animations and print the console messages of the page.
SETTINGS = """
user_pref("ui.prefersReducedMotion", 1);
user_pref("ui.systemUsesDarkTheme", %d);
user_pref("devtools.console.stdout.content", true);
"""
# Script that reports if the compiled kernels run, and the final state of the beads. The script also counts the drawn
# pixels in the colour of each bead.
LOOK = """<script>
window.addEventListener('error', (event) => console.log('FOUND ' + JSON.stringify({thrown: String(event.error)})));
started.then((page) => {
  page.go(1.9);
  const canvas = page.stages[0].canvas, {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  const drawn = [0, 1, 2, 3, 4].map((k) => {
    const colour = [1, 3, 5].map((i) => parseInt(page.theme.bead(k).slice(i, i + 2), 16));
    let count = 0;
    for (let i = 0; i < data.length; i += 4) if (colour.every((part, j) => Math.abs(data[i + j] - part) < 3)) count += 1;
    return count;
  });
  page.go(page.source.last);
  const error = Math.max(...page.source.rows.map((row) => row.energyError()));
  console.log('FOUND ' + JSON.stringify({live: page.source.live, drawn, error, dark: page.theme.dark,
    velocity: Array.from(page.source.values(0).velocity), fits: document.documentElement.scrollWidth <= innerWidth}));
});
</script></body>"""


@pytest.mark.parametrize("dark", [0, 1], ids=["light", "dark"])
@pytest.mark.parametrize("size", [(1280, 800), (500, 844)])  # A window of Firefox cannot be narrower than 500 pixels.
def test_it_computes_and_draws(pages, tmp_path, size, dark):
    profile, page = tmp_path / "profile", tmp_path / "page.html"
    profile.mkdir()
    (profile / "user.js").write_text(SETTINGS % dark, encoding="utf-8")
    page.write_text(pages("one-on-four").output.read_text(encoding="utf-8").replace("</body>", LOOK), encoding="utf-8")
    found = said_by_firefox(profile, page, size)
    assert found["live"]
    assert found["fits"]
    assert found["dark"] == bool(dark)
    assert min(found["drawn"]) > 100
    assert found["error"] < 1e-13
    expected = simulate(scenes.load("one-on-four").lanes[0].chain(), [1, 0, 0, 0, 0]).final_velocity
    np.testing.assert_allclose(found["velocity"], expected, atol=5e-3)


def said_by_firefox(profile, page, size):
    environment = {**os.environ, "MOZ_HEADLESS_WIDTH": str(size[0]), "MOZ_HEADLESS_HEIGHT": str(size[1])}
    command = [FIREFOX, "--headless", "--no-remote", "--profile", str(profile), page.as_uri()]
    with Popen(command, stdout=PIPE, stderr=STDOUT, text=True, env=environment) as firefox:
        try:
            for line in firefox.stdout:
                if found := re.search(r"FOUND (\{.*\})", line):
                    return json.loads(found[1].replace('\\"', '"'))
        finally:
            firefox.kill()
    raise AssertionError("Firefox ended without a word of the page")
