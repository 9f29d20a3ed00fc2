"""Recordings: the first snapshot of a session, every input with its frame, and a hash of every following frame.

The file is an .npz with `metadata`, a JSON text, and `hashes`, one 64-bit number for each frame. It contains no pickled
data.
"""

from __future__ import annotations

import json
from array import array
from hashlib import blake2b
from os import PathLike

import numpy as np
from softcradle.physics.trajectory_file import versions
from softcradle.sandbox.files import output_file
from softcradle.sandbox.languages import _
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.snapshots import Snapshot, snapshot_from_table, snapshot_table
from softcradle.sandbox.user_error import UserError, reason
from softcradle.scenes import Scene, parse

FORMAT = 1
MOST_INPUTS = 50_000  # most inputs of one recording before a new one starts, about 8 megabytes
MOST_FRAMES = 1_000_000  # most frames of one recording before a new one starts: 8 megabytes of hashes

Path = str | PathLike[str]


class Recording:
    """Data that are needed to run a session again, frame by frame.

    Attributes:
        frame: frame of `base`.
        base: Snapshot with which it begins.
        inputs: list of (frame after which it was given, Input).
        hashes: of the states at `frame` + 1, `frame` + 2 ...
    """

    def __init__(self, base: Snapshot, frame: int = 0) -> None:
        self.base, self.frame = base, frame
        self.inputs: list[tuple[int, inputs.Input]] = []
        self.hashes = array("Q")

    @property
    def last(self) -> int:
        """Newest recorded frame."""
        return self.frame + len(self.hashes)

    @property
    def full(self) -> bool:
        """True if a new recording should be started."""
        return len(self.inputs) > MOST_INPUTS or len(self.hashes) > MOST_FRAMES

    def add_input(self, item: inputs.Input) -> None:
        """Record an input given now; of several pointer positions in one frame, only the last has an effect."""
        if isinstance(item, inputs.Drag) and self.inputs:
            frame, before = self.inputs[-1]
            if frame == self.last and isinstance(before, inputs.Drag):
                self.inputs.pop()
        self.inputs.append((self.last, item))

    def add_frame(self, snapshot: Snapshot) -> None:
        """Record that `snapshot` was reached."""
        self.hashes.append(hash_of(snapshot))

    @property
    def memory(self) -> int:
        """Approximate size in bytes."""
        return 8 * (len(self.inputs) + len(self.hashes))

    def copy(self) -> Recording:
        """Return an independent copy of the recording."""
        made = Recording(self.base, self.frame)
        made.inputs, made.hashes = self.inputs.copy(), self.hashes[:]
        return made

    def cut(self, frame: int) -> None:
        """Drop everything after `frame`."""
        del self.hashes[max(0, frame - self.frame) :]
        while self.inputs and self.inputs[-1][0] > frame:
            self.inputs.pop()

    def save(self, path: Path, scene: Scene) -> None:
        """Write it with its `scene`, completely or not at all. Raise UserError on failure."""
        metadata = {
            "softcradle recording": FORMAT,
            "versions": versions(),
            "scene": scene.to_toml(),
            "frame": self.frame,
            "base": snapshot_table(self.base),
            "inputs": [[frame, inputs.to_table(item)] for frame, item in self.inputs],
        }
        hashes = np.array(self.hashes, dtype=np.uint64)
        with output_file(path) as temporary, temporary.open("wb") as file:
            np.savez_compressed(file, metadata=np.array(json.dumps(metadata)), hashes=hashes)


def load_recording(path: Path) -> tuple[Recording, Scene]:
    """Return the recording and the scene written by :meth:`Recording.save`. Raise UserError for another file."""
    try:
        with open(path, "rb") as opened, np.load(opened, allow_pickle=False) as file:
            metadata, hashes = json.loads(str(file["metadata"])), file["hashes"]
        if metadata["softcradle recording"] != FORMAT:
            raise UserError(_("{path}: recorded by a later softcradle", path=path))
        scene = parse(metadata["scene"])
        base = snapshot_from_table(metadata["base"], scene)
        recording = Recording(base, int(metadata["frame"]))
        recording.inputs = [(int(frame), inputs.from_table(table)) for frame, table in metadata["inputs"]]
        recording.hashes = array("Q", hashes.tolist())
        return recording, scene
    except OSError as error:
        raise UserError(_("cannot read {path}: {error}", path=path, error=reason(error))) from None
    except UserError:
        raise
    except Exception:  # a damaged file may fail in zip, compression, arrays, JSON, or the objects made from them
        raise UserError(_("{path}: not a recording of softcradle", path=path)) from None


def hash_of(snapshot: Snapshot) -> int:
    """Return 64 bits that differ for states that differ in any bit."""
    digest = blake2b(np.float64(snapshot.time).tobytes(), digest_size=8)
    for state in snapshot.states:
        for values in (state.overlap, state.rate, state.anchor):
            digest.update(values.tobytes())
    return int.from_bytes(digest.digest(), "little")
