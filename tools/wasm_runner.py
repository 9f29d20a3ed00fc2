"""Frames of a chain, computed with assets/page/kernels.wasm in Node or a browser, as a page computes them.

The frames are used for tests and comparisons.
"""

from __future__ import annotations

import base64
import json
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, State
from softcradle.physics.fixed_step.discrete_gradient import WORK_ROWS
from softcradle.physics.fixed_step.step_loop import NEVER
from softcradle.physics.numerics.contact_solve import BEAD_ROWS
from softcradle.physics.numerics.records import COUNTERS, DONE
from softcradle.physics.state import rest_of

from tools import browser
from tools.wasm_kernels import ARRAYS, FILE, LOSSY

MOST_STEPS = 100_000  # Largest number of steps in one frame.
MOVED = ("overlap", "rate", "anchor", "force", "absorbed")  # Fields of a State that change in a frame.

# The JavaScript function `start` creates an instance of the module and returns the first free address of its memory.
# The function `call` copies an image of memory to this address, calls a kernel and returns the resulting image.
SCRIPT = """
let kernels, base;
const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
const text = (image) => btoa(Array.from(image, (byte) => String.fromCharCode(byte)).join(""));
const start = async (file) => {
  kernels = (await WebAssembly.instantiate(bytes(file), {})).instance.exports;
  return base = (kernels.__heap_base.value + 15) & ~15;
};
const call = (name, numbers, image) => {
  const lacking = base + image.length - kernels.memory.buffer.byteLength;
  if (lacking > 0) kernels.memory.grow(Math.ceil(lacking / 65536));
  const place = new Uint8Array(kernels.memory.buffer, base, bytes(image).length);
  place.set(bytes(image));
  if (kernels[name](...numbers)) throw new Error("a kernel has raised an exception");
  return text(place);
};
"""
NODE = """
import("node:readline").then(({ createInterface }) => createInterface({ input: process.stdin }).on("line", async (line) => {
  console.log(JSON.stringify(await eval(line)));
}));
"""

Run = Callable[[str], Any]  # A function that returns the value of a line of JavaScript.


@contextmanager
def node() -> Iterator[Run]:
    """Yield a function that runs lines of JavaScript in a Node process. The process has run SCRIPT before."""
    with subprocess.Popen(
        ["node", "-e", SCRIPT + NODE], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None

        def run(line: str) -> Any:
            process.stdin.write(line + "\n")
            process.stdin.flush()
            return json.loads(process.stdout.readline())

        try:
            yield run
        finally:
            process.kill()


@contextmanager
def chromium() -> Iterator[Run]:
    """Yield a function that runs lines of JavaScript in a page of Chromium. The page has run SCRIPT before."""
    with TemporaryDirectory(ignore_cleanup_errors=True) as profile, browser.Browser(Path(profile)) as page:
        page.run(SCRIPT)
        yield page.run


@contextmanager
def firefox() -> Iterator[Run]:
    """Yield a function that runs lines of JavaScript in a page of Firefox, over its Marionette protocol.

    The page has run SCRIPT before.
    """
    with TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        port = Path(profile, "MarionetteActivePort")
        Path(profile, "user.js").write_text('user_pref("marionette.port", 0);', encoding="utf-8")
        command = [str(installed("Firefox")), "--headless", "--no-remote", "--marionette", "--profile", profile]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            try:
                while not (port.exists() and port.read_text(encoding="utf-8")):
                    assert process.poll() is None, "Firefox has ended"
                    time.sleep(0.05)
                with socket.create_connection(("127.0.0.1", int(port.read_text(encoding="utf-8")))) as connection:
                    yield _marionette(connection)
            finally:
                process.kill()


def _marionette(connection: socket.socket) -> Run:
    stream = connection.makefile("rwb")

    def answer() -> Any:
        size = b""
        while (letter := stream.read(1)) != b":":
            size += letter
        return json.loads(stream.read(int(size)))

    def call(name: str, parameters: dict[str, Any]) -> Any:
        message = json.dumps([0, 1, name, parameters]).encode()
        stream.write(b"%d:%s" % (len(message), message))
        stream.flush()
        _, _, error, result = answer()
        assert error is None, error
        return result

    answer()  # Read the greeting of Firefox.
    call("WebDriver:NewSession", {})
    call("WebDriver:SetTimeouts", {"script": int(1000 * browser.PATIENCE)})
    call("WebDriver:Navigate", {"url": "about:blank"})
    script = "document.head.append(Object.assign(document.createElement('script'), {text: arguments[0]}))"
    call("WebDriver:ExecuteScript", {"script": script, "args": [SCRIPT]})

    def run(line: str) -> Any:
        return call("WebDriver:ExecuteScript", {"script": "return window.eval(arguments[0])", "args": [line]})["value"]

    return run


RUNNERS = {"Node": node, "Chromium": chromium, "Firefox": firefox}


def installed(runner: str) -> str | None:
    """Return the path of a JavaScript runner, or None if it is not installed."""
    if runner == "Chromium":
        return browser.found()
    return next(
        filter(None, map(shutil.which, {"Node": ["node"], "Firefox": ["firefox", "firefox-esr"]}[runner])), None
    )


class WasmKernels:
    """WebAssembly module in a JavaScript runner. The function `run` runs JavaScript in this runner, which has run
    SCRIPT before.
    """

    def __init__(self, run: Run, file: Path = FILE) -> None:
        self._run = run
        self.load(file)

    def load(self, file: Path) -> None:
        """Load the WebAssembly module from `file`."""
        self._base = self._run(f"start('{base64.b64encode(file.read_bytes()).decode()}')")

    def advance(self, chain: Chain, state: State, duration: float, step: float) -> None:
        """Advance `state` by `duration` in place, like :func:`softcradle.physics.advance` with the method conserving."""
        arrays = _arrays(chain, state)
        places, end = {}, self._base
        for name, array in arrays.items():
            places[name] = end
            end += -(-array.nbytes // 8) * 8
        image = b"".join(array.tobytes().ljust(-(-array.nbytes // 8) * 8, b"\0") for array in arrays.values())
        numbers = [chain.contacts, chain.anchor, int(state.external(chain) is not None), 0, MOST_STEPS]
        numbers += [step, state.time, state.time + duration, chain.swing]
        addresses = [places[name] for name in ARRAYS.split(", ")]
        kernel = "march"
        if chain.dissipative:
            kernel, addresses = "march_lossy", [*addresses, places["loss"], places["bed"], chain.bed.size]
        call = [kernel, [places["result"], places["raised"], *numbers, *addresses], base64.b64encode(image).decode()]
        moved = base64.b64decode(self._run(f"call({json.dumps(call)[1:-1]})"))
        found = {
            name: np.frombuffer(moved, array.dtype, array.size, places[name] - self._base)
            for name, array in arrays.items()
        }
        if found["result"][0] != DONE:
            raise ArithmeticError(f"the kernel ended with status {found['result'][0]}")
        for name in MOVED:
            getattr(state, name)[:] = found[name]
        state.time = float(found["reached"][0])


def _arrays(chain: Chain, state: State) -> dict[str, NDArray[Any]]:
    """Return all arrays that a kernel reads and writes."""
    n, push = chain.contacts, state.external(chain)
    nothing, result = np.zeros(0), np.zeros(2, dtype=np.int32)
    found = {
        "result": result, "raised": result, "law": chain.law_rows, "inverse_mass": chain.inverse_mass,
        "push": np.zeros(n + 1) if push is None else push, **{name: getattr(state, name) for name in MOVED},
        "log_contact": nothing, "log_time": nothing, "closed": state.closed.astype(np.int8),
        "counter": np.zeros(COUNTERS, dtype=np.int64), "plan": np.array([0, NEVER, 0]),
        "beads": np.zeros((BEAD_ROWS, n + 1)), "work": np.zeros((WORK_ROWS, n)), "reached": np.zeros(1),
        "loss": chain.loss, "bed": chain.bed, "rest": np.append(*rest_of(chain)),
    }  # fmt: skip
    assert found.keys() >= {*ARRAYS.split(", "), *LOSSY.split(", ")[:2]}
    return found
