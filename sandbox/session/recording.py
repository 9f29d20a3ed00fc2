"""Recordings. A recording contains the first snapshot of a session, every input with its frame, and a hash of every
later frame.

The file is an .npz file with `metadata`, a JSON text, and `hashes`, one 64-bit number for each frame after the first.
It contains no pickled data.
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
MOST_INPUTS = 50_000  # Largest number of inputs of a recording before a new one starts. They take about 8 megabytes.
# Largest number of frames of a recording before a new one starts. Their hashes take 8 megabytes.
MOST_FRAMES = 1_000_000

Path = str | PathLike[str]


class Recording:
    """Data that are needed to run a session again, frame by frame.

    Attributes:
        frame: number of the first frame.
        base: Snapshot of the first frame.
        inputs: list of (frame after which the input was given, Input).
        hashes: hashes of the states at `frame` + 1, `frame` + 2 ...
    """

    def __init__(self, base: Snapshot, frame: int = 0) -> None:
        self.base, self.frame = base, frame
        self.inputs: list[tuple[int, inputs.Input]] = []
        self.hashes = array("Q")

    @property
    def last(self) -> int:
        """Number of the newest recorded frame."""
        return self.frame + len(self.hashes)

    @property
    def full(self) -> bool:
        """True if the recording is so long that a new one should be started."""
        return len(self.inputs) > MOST_INPUTS or len(self.hashes) > MOST_FRAMES

    def add_input(self, item: inputs.Input) -> None:
        """Record an input that is given now. Of several pointer positions in one frame, only the last is recorded."""
        if isinstance(item, inputs.Drag) and self.inputs:
            frame, before = self.inputs[-1]
            if frame == self.last and isinstance(before, inputs.Drag):
                self.inputs.pop()
        self.inputs.append((self.last, item))

    def add_frame(self, snapshot: Snapshot) -> None:
        """Record the hash of a new frame, `snapshot`."""
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
        """Drop all inputs and hashes after `frame`."""
        del self.hashes[max(0, frame - self.frame) :]
        while self.inputs and self.inputs[-1][0] > frame:
            self.inputs.pop()

    def save(self, path: Path, scene: Scene) -> None:
        """Write the recording and its `scene` to a file. Raise UserError on failure, and leave no partial file."""
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
    """Return the recording and the scene from a file written by :meth:`Recording.save`. Raise UserError for any other
    file.
    """
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
    # A damaged file may raise errors of zip, decompression, arrays, JSON, or of the objects made from them.
    except Exception:
        raise UserError(_("{path}: not a recording of softcradle", path=path)) from None


def hash_of(snapshot: Snapshot) -> int:
    """Return a 64-bit hash of the state of `snapshot`. States that differ in any bit have different hashes."""
    digest = blake2b(np.float64(snapshot.time).tobytes(), digest_size=8)
    for state in snapshot.states:
        for values in (state.overlap, state.rate, state.anchor):
            digest.update(values.tobytes())
    return int.from_bytes(digest.digest(), "little")
