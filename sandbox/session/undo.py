"""Undo and redo: the session before each edit, including its motion, in bounded memory.

An undo returns to the frame at which the edit was made and restores the frames that the edit dropped. A redo restores
the edit and the motion after it. Neither loses a frame.
"""

from collections import deque
from collections.abc import Sequence
from itertools import count
from typing import NamedTuple

from softcradle.sandbox.languages import N_
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.frame_history import Block
from softcradle.sandbox.session.recording import Recording
from softcradle.scenes import Scene

MOST_STEPS = 200
MEMORY = 24 * 2**20  # bytes of blocks and recordings held by undo steps only


class FrozenSession(NamedTuple):
    """A stored session: the frame shown, the blocks of the history, the recording, the scene with its texts."""

    frame: int
    blocks: tuple[Block, ...]
    recording: Recording
    scene: Scene


class Checkpoint(NamedTuple):
    """A session before an edit (or, for a redo, after it).

    Attributes:
        number: number of the edit; it stays the same through undo and redo.
        name: name of the edit.
        is_edit: True if it changes the scene; pulling a bead while the model runs changes only the motion.
        target: the part that the edit changes; inputs of one gesture with the same target are one step.
        lanes: lanes that it changes; empty for texts, None for all.
        session: the stored session.
        memory: bytes that the previous step does not share.
        trial: True if it only tries another number from the start, which is not work that could be lost.
    """

    number: int
    name: str
    is_edit: bool
    target: tuple[object, ...]
    lanes: frozenset[int | None]
    session: FrozenSession
    memory: int
    trial: bool = False


def target_of(step: Sequence[inputs.Input] | Scene) -> tuple[object, ...]:
    """Return the target of `step`; a bead may be pulled and placed in one gesture."""
    if isinstance(step, Scene):
        return ("words",)
    names = ["bead" if isinstance(item, inputs.Drag | inputs.Place) else type(item).__name__ for item in step]
    places = [[getattr(item, key, None) for key in ("lane", "bead", "contact")] for item in step]
    return tuple((name, *place) for name, place in zip(names, places, strict=True))


class UndoStack:
    """Steps that can be undone and redone.

    Attributes:
        done, undone: checkpoints, the nearest last.
    """

    def __init__(self) -> None:
        self.done: deque[Checkpoint] = deque()
        self.undone: list[Checkpoint] = []
        self._numbers = count(1)
        self._saved = self._memory = 0
        self._dropped = 0  # number of the last edit whose step was dropped
        self._open = False  # True while the gesture of the last input continues

    def continues(self, items: Sequence[inputs.Input], gesture: bool) -> bool:
        """Return True if `items` belong to the last step, that is, to the same gesture."""
        return gesture and self._open and bool(self.done) and self.done[-1].target == target_of(items)

    def add(
        self, step: Sequence[inputs.Input] | Scene, gesture: bool, present: FrozenSession, trial: bool = False
    ) -> None:
        """Store the `present` session before the inputs of a step, or before the texts of a scene."""
        is_edit = isinstance(step, Scene) or not all(isinstance(item, inputs.Drag) for item in step)
        own = _own_memory(present, self.done[-1].session.blocks if self.done else ())
        name = N_("words") if isinstance(step, Scene) else next(item.undo_name for item in step if item.undo_name)
        lanes = frozenset(getattr(item, "lane", None) for item in step) if not isinstance(step, Scene) else frozenset()
        self.done.append(Checkpoint(next(self._numbers), name, is_edit, target_of(step), lanes, present, own, trial))
        self._memory += own
        self.undone.clear()
        self._open = gesture
        while len(self.done) > MOST_STEPS or (len(self.done) > 1 and self._memory > MEMORY):
            dropped = self.done.popleft()
            self._memory -= dropped.memory
            self._dropped = dropped.number if dropped.is_edit else self._dropped

    def end_gesture(self) -> None:
        """End the gesture, so that the next input starts a new step."""
        self._open = False

    def undo(self, present: FrozenSession) -> Checkpoint | None:
        """Return the session before the last step; the `present` session can be redone."""
        step = _move(self.done, self.undone, present)
        self._memory -= step.memory if step else 0
        return step

    def redo(self, present: FrozenSession) -> Checkpoint | None:
        """Return the session after the step that was undone last."""
        step = _move(self.undone, self.done, present)
        self._memory += step.memory if step else 0
        return step

    def mark_saved(self) -> None:
        """Mark the present scene as saved."""
        self._saved = self._last_edit()

    @property
    def unsaved(self) -> bool:
        """True if there are unsaved edits."""
        return self._last_edit() != self._saved

    @property
    def unsaved_work(self) -> bool:
        """True if there are unsaved edits other than trials of numbers."""
        only_trials = self._saved == self._dropped == 0 and all(step.trial for step in self.done if step.is_edit)
        return self.unsaved and not only_trials

    @property
    def unsaved_beside_first(self) -> bool:
        """True if there are unsaved edits of lanes other than the first that the first lane does not share."""
        alone = (step.lanes and step.lanes.isdisjoint((0, None)) for step in self.done if step.is_edit)
        return self.unsaved and any(alone)

    def lose_what_was_saved(self) -> None:
        """Mark the state as unsaved, because no file contains it."""
        self._saved = -1

    def _last_edit(self) -> int:
        return next((step.number for step in reversed(self.done) if step.is_edit), self._dropped)


def _own_memory(present: FrozenSession, before: tuple[Block, ...]) -> int:
    """Return the bytes of `present` that are not in the blocks `before`."""
    shared = set(map(id, before))
    return present.recording.memory + sum(block.memory for block in present.blocks if id(block) not in shared)


def _move(
    source: deque[Checkpoint] | list[Checkpoint], target: deque[Checkpoint] | list[Checkpoint], present: FrozenSession
) -> Checkpoint | None:
    if not source:
        return None
    step = source.pop()
    target.append(step._replace(session=present))
    return step
