"""The page in Firefox, where it is installed: drawn on a desk and on a telephone, without an error of its scripts."""

from __future__ import annotations

import re
import shutil
import subprocess

import numpy as np
import pytest
from PIL import Image

from tests.helpers.paths import ROOT

FIREFOX = next((path for name in ("firefox", "firefox-esr") if (path := shutil.which(name))), None)
pytestmark = [pytest.mark.slow, pytest.mark.skipif(FIREFOX is None, reason="there is no Firefox")]
# What is still shows the moment of the greatest force; errors of the page are printed.
SETTINGS = """
user_pref("ui.prefersReducedMotion", 1);
user_pref("ui.systemUsesDarkTheme", %d);
user_pref("devtools.console.stdout.content", true);
"""
STYLE = (ROOT / "assets" / "page" / "page.css").read_text(encoding="utf-8")


@pytest.mark.parametrize("dark", [0, 1], ids=["light", "dark"])
@pytest.mark.parametrize("size", ["1280,800", "500,844"])  # it makes no narrower window
def test_it_is_drawn(pages, tmp_path, size, dark):
    profile, picture = tmp_path / "profile", tmp_path / "page.png"
    profile.mkdir()
    (profile / "user.js").write_text(SETTINGS % dark, encoding="utf-8")
    page = pages("one-on-four").output
    command = [FIREFOX, "--headless", "--no-remote", "--profile", profile, "--window-size", size]
    done = subprocess.run(
        [*map(str, command), "--screenshot", str(picture), page.resolve().as_uri()],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert not [line for line in (done.stdout + done.stderr).splitlines() if page.name in line and "rror" in line]
    with Image.open(picture) as opened:
        pixels = np.asarray(opened.convert("RGB"), dtype=int)
    ground = np.median(pixels, axis=(0, 1))
    assert (ground < 40).all() if dark else (ground > 230).all()
    beads = re.findall(r"--c[0-4]: #(\w{6})", STYLE)[5 * dark : 5 * dark + 5]
    for bead in beads:
        colour = [int(bead[k : k + 2], 16) for k in (0, 2, 4)]
        assert (np.abs(pixels - colour).max(axis=2) < 3).sum() > 100  # of its bar
