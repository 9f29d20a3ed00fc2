"""Random play with the page of a scene, for an hour of the page's time, and a measurement of its cost.

    python -m benchmarks.page_play [MINUTES] [SCENE]

The events of the page are used. Beads are grabbed, pulled and released. Keys are typed. Every slider, list, box and
button is used, and links are opened. The test fails if a number is not finite, if the script raises an error, or if the
memory grows. It also fails if the energy differs from its initial value plus the work of the hand by more than BOOKED.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from softcradle.sandbox.page import render_page
from softcradle.sandbox.scene_runs import load_scene

from tools.browser import Browser

BOOKED = 1e-10  # Largest allowed relative error of the energy.
PICTURES = 60  # Number of pictures per second of the page's time.
CHUNK = 1800  # Number of pictures in one call of the page.
# Largest speed that the user's hand, or a bead pushed by other beads, may reach, in units of the closing speed.
MOST_SPEED = 100.0
LEAST_MOVED = 0.5  # Smallest allowed fraction of the pictures in which the time advances.
MOST_GROWN = 8e6  # Number of bytes that memory may grow in an hour. The browser keeps texts and caches.
MEASURED = 240  # Number of pictures whose cost is measured.
# Width and height of a screen [CSS pixels], and its device pixels per CSS pixel.
DESK, TELEPHONE = (1280, 900, 1.0), (390, 844, 3.0)
COSTS = (
    ("#with=none", 1, DESK),
    ("#with=none", 4, DESK),
    ("#with=steel", 4, DESK),
    ("#with=none", 4, TELEPHONE),
    ("#with=steel", 4, TELEPHONE),
    ("#n=49&with=none", 1, DESK),
)  # Each entry contains an experiment, a throttling factor of the processor, and a screen.
SCRIPTS = Path(__file__).with_suffix(".js").read_text(encoding="utf-8")


def play(browser: Browser, page: Path, minutes: float) -> None:
    """Play for `minutes` of the page's time, and print the result."""
    browser.call("Page.addScriptToEvaluateOnNewDocument", source=f"{SCRIPTS}; prelude()")
    browser.visit(page, "")
    seed, off, done, moved, used = 1, 0.0, 0, 0, []
    while done < 60 * PICTURES * minutes:
        found = browser.run(f"play({seed}, {CHUNK})")
        assert not found["bad"], f"a number is not finite after {done + found['bad']} pictures"
        assert not found["thrown"], found["thrown"]
        seed, off, done, moved = found["seed"], max(off, found["off"]), done + CHUNK, moved + found["moved"]
        assert off < BOOKED, f"the energy is off by {off:.1e}"
        assert found["fastest"] < MOST_SPEED, f"beads close at {found['fastest']:.1e} times the speed of the scene"
        browser.call("HeapProfiler.collectGarbage")
        used.append(browser.call("Runtime.getHeapUsage")["usedSize"])
        if done % (600 * PICTURES) == 0:
            print(
                f"{done / PICTURES / 60:.0f} minutes: energy booked to {off:.0e}, {used[-1] / 1e6:.1f} MB", flush=True
            )
    half = len(used) // 2
    share = moved / done
    print(
        f"{done / PICTURES / 60:.0f} minutes of play: beads move in {share:.0%} of the pictures, energy booked to {off:.0e}"
    )
    assert share > LEAST_MOVED, "most of the time nothing moves"
    print(
        f"memory in MB: {max(used[:half]) / 1e6:.1f} at most in the first half, {max(used[half:]) / 1e6:.1f} in the second"
    )
    assert max(used[half:]) < max(used[:half]) + MOST_GROWN, "memory grows"
    assert not browser.complaints, browser.complaints


def costs(browser: Browser, page: Path) -> None:
    """Print the processor time of the page's thread per picture, divided into physics, script, and the rest.

    Other processes do not affect this time. The rest is the work of the browser itself: layout and painting. A headless
    browser paints without a graphics card.
    """
    browser.call("Page.addScriptToEvaluateOnNewDocument", source=SCRIPTS)
    for fragment, rate, screen in COSTS:
        browser.device(*screen)
        browser.visit(page, fragment)
        browser.call("Performance.enable", timeDomain="threadTicks")
        browser.run(f"marched({PICTURES}), shown({PICTURES})")  # The first call compiles the kernels.
        browser.call("Emulation.setCPUThrottlingRate", rate=rate)
        browser.run("page.again(), page.pause()")
        physics = spent(browser, f"marched({MEASURED})")["TaskDuration"]
        found = spent(browser, f"shown({MEASURED})")
        browser.call("Emulation.setCPUThrottlingRate", rate=1)
        beads = browser.run("page.specs.map((spec) => spec.mass.length).join(' and ')")
        script, rest = found["ScriptDuration"], found["TaskDuration"] - found["ScriptDuration"]
        print(
            f"{beads} beads, {screen[0]} wide, throttled {rate} times: physics {physics:.3f} ms, script {script:.1f} ms, "
            f"painting and layout {rest:.1f} ms of the processor a picture; a picture every {found['value']:.1f} ms",
            flush=True,
        )


def spent(browser: Browser, script: str) -> dict[str, float]:
    """Return milliseconds per picture of the page's thread by kind, and the value of the script.

    The script shows MEASURED pictures.
    """
    before = browser.call("Performance.getMetrics")["metrics"]
    value = browser.run(script)
    after = browser.call("Performance.getMetrics")["metrics"]
    times = {
        new["name"]: 1000 * (new["value"] - old["value"]) / MEASURED for old, new in zip(before, after, strict=True)
    }
    return {**times, "value": value}


def main(minutes: float = 60.0, scene: str = "one-on-four") -> None:
    with tempfile.TemporaryDirectory() as made:
        page = Path(made) / "page.html"
        render_page(load_scene(scene), page)
        with Browser(Path(made) / "costs") as browser:
            costs(browser, page)
        with Browser(Path(made) / "play") as browser:
            play(browser, page, minutes)


if __name__ == "__main__":
    main(*(float(word) if k == 0 else word for k, word in enumerate(sys.argv[1:3])))
