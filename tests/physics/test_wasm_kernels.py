"""Tests of the kernels for browsers. The tests check the contents of the WebAssembly file. The results of the kernels
must be bitwise equal to plain Python.
"""

from importlib.util import find_spec
from io import BytesIO

import numpy as np
import pytest

from tests.helpers.own_process import python
from tests.helpers.paths import ROOT
from tools.same_digits import TIERS, TIERS_HERE, compare, frames, motions
from tools.wasm_kernels import FILE
from tools.wasm_runner import RUNNERS, WasmKernels, installed

FRAMES = 150  # Number of frames of the viewer. During these frames the beads meet and push each other.

# Numbers of the sections of a module, and operands of the instructions in the WebAssembly version of 2017.
IMPORTS, CODE, DATA = 2, 10, 11
NUMBERS = dict.fromkeys([12, 13, 16, *range(0x20, 0x25), 0x41, 0x42], 1) | dict.fromkeys([17, *range(0x28, 0x3F)], 2)
BYTES = dict.fromkeys([2, 3, 4, 0x3F, 0x40], 1) | {0x43: 4, 0x44: 8}
TABLE_JUMP, LAST = 14, 0xBF


class Reader(BytesIO):
    """A reader of the bytes of a WebAssembly module."""

    def number(self) -> int:
        """Read a whole number in LEB128 format: seven bits per byte, and the last byte is below 128."""
        (byte,) = self.read(1)
        return byte if byte < 128 else byte - 128 + 128 * self.number()


def instructions(body: bytes) -> list[int]:
    reader, found = Reader(body), []
    for _ in range(reader.number()):  # Each entry contains the number and the type of local variables.
        reader.number()
        reader.read(1)
    while code := reader.read(1):
        found.append(code[0])
        reader.read(BYTES.get(code[0], 0))
        for _ in range(reader.number() + 1 if code[0] == TABLE_JUMP else NUMBERS.get(code[0], 0)):
            reader.number()
    return found


def test_the_wasm_file_is_small_and_portable():
    content = FILE.read_bytes()
    assert content[:8] == b"\0asm\1\0\0\0"
    assert len(content) < 64_000  # A web page contains the file as base64 text, which is a third longer.
    reader, sections = Reader(content[8:]), {}
    while kind := reader.read(1):
        sections[kind[0]] = reader.read(reader.number())
    assert IMPORTS not in sections
    assert max(sections) <= DATA
    reader = Reader(sections[CODE])
    assert max(max(instructions(reader.read(reader.number()))) for _ in range(reader.number())) <= LAST


@pytest.fixture(scope="module")
def kernels():
    """Run the WebAssembly file in Node. If Node is not available, run the file in a browser."""
    runner = next(filter(installed, RUNNERS), None)
    if runner is None:
        pytest.skip("neither Node nor a browser is installed")
    with RUNNERS[runner]() as run:
        yield WasmKernels(run)


@pytest.fixture(scope="module")
def plainly(tmp_path_factory):
    """Return the frames of all motions, computed with plain Python in another process."""
    out = tmp_path_factory.mktemp("frames") / "plain.npz"
    words = ("--frames", str(FRAMES), "--tiers", "plain Python", "--write", str(out))
    python("-m", "tools.same_digits", *words, cwd=ROOT, **TIERS["plain Python"])
    with np.load(out) as file:
        return dict(file)


@pytest.mark.parametrize("name", ["one-on-four", "draft-gear-one-on-three", "friction", "loss", "pushed"])
def test_its_digits_are_those_of_plain_python(name, kernels, plainly):
    found = frames(motions()[name], FRAMES, kernels.advance)
    assert found.tobytes() == plainly[name].tobytes()
    chain = motions()[name][0]
    # Some contacts have pushed in the simulated time.
    assert (found[:, 3 + 2 * chain.contacts : 3 + 3 * chain.contacts] > 0.0).any()


@pytest.mark.slow
@pytest.mark.skipif(find_spec("ziglang") is None, reason="the linker is not installed: pip install '.[wasm]'")
def test_built_anew_it_has_the_same_digits(kernels, plainly, tmp_path):
    out = tmp_path / "kernels.wasm"
    python("-m", "tools.wasm_kernels", str(out), cwd=ROOT)
    kernels.load(out)
    for name, rows in plainly.items():
        assert frames(motions()[name], FRAMES, kernels.advance).tobytes() == rows.tobytes()
    kernels.load(FILE)


@pytest.mark.slow
def test_every_kernel_tier_has_the_same_digits():
    assert compare(TIERS_HERE, 200)
