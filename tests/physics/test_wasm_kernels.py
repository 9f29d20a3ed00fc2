"""The kernels for browsers: what the shipped file is made of, and its digits, which are those of plain Python."""

import os
import subprocess
import sys
from importlib.util import find_spec

import numpy as np
import pytest

from tests.helpers.paths import ROOT
from tools.same_digits import TIERS, TIERS_HERE, compare, frames, motions
from tools.wasm_kernels import FILE, KERNELS
from tools.wasm_runner import RUNNERS, WasmKernels, installed

FRAMES = 150  # of a viewer: beads meet and push
RUNS = ("one-on-four", "draft-gear-one-on-three", "friction", "loss", "pushed")
MOST_BYTES = 64_000  # a page holds them as text, a third longer

# sections of a module, and what follows an instruction of the WebAssembly of 2017
IMPORTS, EXPORTS, CODE, DATA = 2, 7, 10, 11
BLOCKS, ONE_INDEX, TWO_NUMBERS = {2, 3, 4}, {12, 13, 16, *range(0x20, 0x25)}, {17, *range(0x28, 0x3F)}
BYTE = {0x3F, 0x40}
TABLE_JUMP, CONSTANT_I, CONSTANT_F4, CONSTANT_F8, LAST = 14, {0x41, 0x42}, 0x43, 0x44, 0xBF


class Reader:
    """Numbers one after the other from the bytes of a module."""

    def __init__(self, content: bytes) -> None:
        self.content, self.at = content, 0

    def take(self, count: int) -> bytes:
        self.at += count
        return self.content[self.at - count : self.at]

    def number(self) -> int:
        found = shift = 0
        while True:
            (byte,) = self.take(1)
            found |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return found

    @property
    def ended(self) -> bool:
        return self.at >= len(self.content)


def sections() -> dict[int, bytes]:
    reader, found = Reader(FILE.read_bytes()[8:]), {}
    while not reader.ended:
        (kind,) = reader.take(1)
        found[kind] = reader.take(reader.number())
    return found


def instructions(body: bytes) -> list[int]:
    reader, found = Reader(body), []
    for _ in range(reader.number()):  # local variables: how many, of which type
        reader.number()
        reader.take(1)
    while not reader.ended:
        (code,) = reader.take(1)
        found.append(code)
        if code in BLOCKS | BYTE:
            reader.take(1)
        elif code in ONE_INDEX | CONSTANT_I:
            reader.number()
        elif code in TWO_NUMBERS:
            reader.number(), reader.number()
        elif code == TABLE_JUMP:
            for _ in range(reader.number() + 1):
                reader.number()
        elif code in (CONSTANT_F4, CONSTANT_F8):
            reader.take(8 if code == CONSTANT_F8 else 4)
    return found


def test_the_file_is_small_and_whole():
    content = FILE.read_bytes()
    assert content[:8] == b"\0asm\1\0\0\0"
    assert len(content) < MOST_BYTES
    assert max(sections()) <= DATA


def test_it_takes_nothing_and_gives_the_kernels():
    assert IMPORTS not in sections()
    reader, names = Reader(sections()[EXPORTS]), set()
    for _ in range(reader.number()):
        names.add(reader.take(reader.number()).decode())
        reader.take(1)
        reader.number()
    assert names == {*KERNELS, "memory", "__heap_base"}


def test_every_browser_has_its_instructions():
    reader, most = Reader(sections()[CODE]), 0
    for _ in range(reader.number()):
        most = max(most, *instructions(reader.take(reader.number())))
    assert most <= LAST


@pytest.fixture(scope="module")
def kernels():
    """The shipped file in Node, else in a browser."""
    runner = next(filter(installed, RUNNERS), None)
    if runner is None:
        pytest.skip("neither Node nor a browser is installed")
    with RUNNERS[runner]() as run:
        yield WasmKernels(run)


@pytest.fixture(scope="module")
def plainly(tmp_path_factory):
    """Frames of all motions by plain Python, in a process of its own."""
    out = tmp_path_factory.mktemp("frames") / "plain.npz"
    words = ["--frames", str(FRAMES), "--tiers", "plain Python", "--write", str(out)]
    command = [sys.executable, "-m", "tools.same_digits", *words]
    subprocess.run(command, cwd=ROOT, env=os.environ | TIERS["plain Python"], check=True)
    with np.load(out) as file:
        return dict(file)


@pytest.mark.parametrize("name", RUNS)
def test_its_digits_are_those_of_plain_python(name, kernels, plainly):
    found = frames(motions()[name], FRAMES, kernels.advance)
    assert found.tobytes() == plainly[name].tobytes()
    chain = motions()[name][0]
    assert (found[:, 3 + 2 * chain.contacts : 3 + 3 * chain.contacts] > 0.0).any()  # contacts have pushed


@pytest.mark.slow
@pytest.mark.skipif(find_spec("ziglang") is None, reason="the linker is not installed: pip install '.[wasm]'")
def test_built_anew_it_has_the_same_digits(kernels, plainly, tmp_path):
    out = tmp_path / "kernels.wasm"
    subprocess.run([sys.executable, "-m", "tools.wasm_kernels", str(out)], cwd=ROOT, check=True)
    kernels.load(out)
    for name, rows in plainly.items():
        assert frames(motions()[name], FRAMES, kernels.advance).tobytes() == rows.tobytes()
    kernels.load(FILE)


@pytest.mark.slow
def test_every_tier_has_the_same_digits_whatever_the_processor_and_the_c_library():
    assert compare(TIERS_HERE, 200)
