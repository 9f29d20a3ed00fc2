"""Headless browser for tests, pictures and measurements of pages. The browser is controlled with the DevTools protocol
over two pipes.
"""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
PATIENCE = 1800.0  # Time to wait for any answer of the browser [s]. The time is long because the machine may be busy.

# Program that starts the browser. The browser reads commands from file descriptor 3 and writes answers to 4.
LAUNCH = (
    "import os, sys; os.dup2(int(sys.argv[1]), 3); os.dup2(int(sys.argv[2]), 4); os.execv(sys.argv[3], sys.argv[3:])"
)


def found() -> str | None:
    """Return the path of an installed browser, or None if there is none."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Browser:
    """One page in a separate browser process. The list `complaints` contains errors of the page and requests to the
    network.
    """

    def __init__(self, profile: Path, size: tuple[int, int] = (1280, 900)) -> None:
        browser = found()
        assert browser is not None
        command_end, self._write = os.pipe()
        self._read, answer_end = os.pipe()
        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run"]
        flags += ["--remote-debugging-pipe", f"--user-data-dir={profile}", f"--window-size={size[0]},{size[1]}"]
        flags += ["--autoplay-policy=no-user-gesture-required", "--mute-audio"]
        browser_ends = (command_end, answer_end)
        self._process = subprocess.Popen(
            [sys.executable, "-c", LAUNCH, str(command_end), str(answer_end), browser, *flags],
            pass_fds=browser_ends, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        for end in browser_ends:
            os.close(end)
        os.set_blocking(self._read, False)
        self._unread, self._count, self._session, self.context = b"", 0, "", ""
        self.complaints: list[str] = []
        self.fresh()

    def fresh(self) -> None:
        """Replace the page by an empty one, without the settings and permissions of the previous page."""
        before, self._session = self.context, ""
        self.context = self.call("Target.createBrowserContext")["browserContextId"]
        target = self.call("Target.createTarget", url="about:blank", browserContextId=self.context)["targetId"]
        if before:
            self.call("Target.disposeBrowserContext", browserContextId=before)
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.complaints.clear()

    def __enter__(self) -> Browser:
        return self

    def __exit__(self, *error: object) -> None:
        self._process.kill()
        self._process.wait()
        os.close(self._read)
        os.close(self._write)

    def call(self, method: str, **parameters: Any) -> Any:
        """Send a command and wait for its answer."""
        self._count += 1
        message: dict[str, Any] = {"id": self._count, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            for answer in self._messages():
                if answer.get("id") == self._count:
                    assert "error" not in answer, answer["error"]
                    return answer["result"]
        raise TimeoutError(f"the browser did not answer {method}")

    def _messages(self) -> list[dict[str, Any]]:
        try:
            chunk = os.read(self._read, 1 << 20)
        except BlockingIOError:
            time.sleep(0.005)
            return []
        assert chunk, "the browser has ended"
        *whole, self._unread = (self._unread + chunk).split(b"\0")
        messages = [json.loads(message) for message in whole]
        for message in messages:
            self._listen(message.get("method"), message.get("params", {}))
        return messages

    def _listen(self, event: str | None, parameters: dict[str, Any]) -> None:
        if event == "Runtime.exceptionThrown":
            details = parameters["exceptionDetails"]
            self.complaints.append(details.get("exception", {}).get("description", details["text"]))
        elif event == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning", "assert"):
            self.complaints.append(json.dumps(parameters["args"])[:500])
        elif event == "Log.entryAdded" and parameters["entry"]["level"] in ("error", "warning"):
            self.complaints.append(parameters["entry"]["text"])
        elif event == "Network.requestWillBeSent" and not parameters["request"]["url"].startswith(
            ("data:", "file:", "about:")
        ):
            self.complaints.append(f"requests {parameters['request']['url']}")

    def run(self, script: str) -> Any:
        """Return the value of a JavaScript expression. If the value is a promise, wait for its result."""
        answer = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def open(self, path: Path) -> None:
        """Open a file and wait until it is loaded."""
        self.call("Page.navigate", url=path.resolve().as_uri())
        self.until("document.readyState + location.protocol === 'completefile:'")

    def until(self, script: str) -> Any:
        """Wait until a JavaScript expression is true, and return its value. The wait may take long on a busy machine."""
        end = time.monotonic() + PATIENCE
        while not (found := self.run(script)):
            assert time.monotonic() < end, f"never came: {script}"
            time.sleep(0.02)
        return found

    def picture(self, path: Path, whole: bool = False) -> None:
        """Write a screenshot of the window, or of the whole page if `whole` is True."""
        shot = self.call("Page.captureScreenshot", captureBeyondViewport=whole)
        path.write_bytes(base64.b64decode(shot["data"]))

    def media(self, kind: str = "", scheme: str = "light") -> None:
        """Show the page on a medium of the given `kind` ("screen", "print"), in the light or dark colour `scheme`."""
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        self.call("Emulation.setEmulatedMedia", media=kind, features=features)

    def device(self, width: int, height: int, density: float = 1.0) -> None:
        """Show the page on a device with the given width and height [CSS pixels].

        A device of small width is a telephone with a touch screen.
        """
        narrow = width < 600
        size = {"width": width, "height": height, "deviceScaleFactor": density}
        self.call("Emulation.setDeviceMetricsOverride", **size, mobile=narrow)
        self.call("Emulation.setTouchEmulationEnabled", enabled=narrow)

    def key(self, key: str, shift: bool = False) -> None:
        """Press and release the key with the DOM name `key`."""
        code = {
            " ": 32,
            "Tab": 9,
            "Enter": 13,
            "Escape": 27,
            "PageUp": 33,
            "PageDown": 34,
            "End": 35,
            "Home": 36,
            "ArrowLeft": 37,
            "ArrowUp": 38,
            "ArrowRight": 39,
            "ArrowDown": 40,
        }[key]
        event: dict[str, Any] = {"key": key, "windowsVirtualKeyCode": code, "modifiers": 8 if shift else 0}
        if key == "Enter":
            event["text"] = "\r"  # Without this text, the key does not activate a button.
        self.call("Input.dispatchKeyEvent", type="keyDown", **event)
        self.call("Input.dispatchKeyEvent", type="keyUp", **event)

    def swipe(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Move a finger over the screen from `start` to `end` [CSS pixels]."""
        points = [(start[0] + k * (end[0] - start[0]) / 8, start[1] + k * (end[1] - start[1]) / 8) for k in range(9)]
        for k, (x, y) in enumerate(points):
            self.call(
                "Input.dispatchTouchEvent", type="touchMove" if k else "touchStart", touchPoints=[{"x": x, "y": y}]
            )
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def visit(self, path: Path, fragment: str) -> None:
        """Open a page at `fragment`, which is empty or begins with #.

        The JavaScript variable `page` then contains the Page of the script.
        """
        self.open(path)
        self.run(f"history.replaceState(null, '', '{fragment}')")
        self.call("Page.reload")
        self.until("document.readyState === 'complete' && typeof started === 'object'")
        self.run("started.then((found) => { window.page = found; return 0; })")

    def mouse(self, kind: str, x: float, y: float) -> None:
        """Press, move or release the left mouse button. The `kind` is "Pressed", "Moved" or "Released"."""
        held = 0 if kind == "Released" else 1
        self.call("Input.dispatchMouseEvent", type=f"mouse{kind}", x=x, y=y, button="left", buttons=held, clickCount=1)

    def finger(self, kind: str, x: float = 0.0, y: float = 0.0) -> None:
        """Put a finger on the screen, move it or lift it. The `kind` is "Start", "Move" or "End"."""
        points = [] if kind == "End" else [{"x": x, "y": y}]
        self.call("Input.dispatchTouchEvent", type=f"touch{kind}", touchPoints=points)
