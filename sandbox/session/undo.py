"""Undo and redo. The session before each edit is stored with its motion, in limited memory.

An undo returns to the frame at which the edit was made. It restores the frames that the edit dropped. A redo restores
the edit and the motion after it. No frame is lost.
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
MEMORY = 24 * 2**20  # Largest number of bytes of history blocks and recordings that are stored only for undo steps.


class FrozenSession(NamedTuple):
    """A stored session: the visible frame, the blocks of the history, the recording, and the scene with its texts."""

    frame: int
    blocks: tuple[Block, ...]
    recording: Recording
    scene: Scene


class Checkpoint(NamedTuple):
    """A session before an edit. A checkpoint for a redo contains the session after the edit.

    Attributes:
        number: number of the edit; it stays the same through undo and redo.
        name: name of the edit.
        is_edit: True if the step changes the scene. Pulling a bead while the model runs changes only the motion.
        target: the part that the edit changes. Inputs of one gesture with the same target form one step.
        lanes: lanes that the edit changes; empty for texts, None for all.
        session: the stored session.
        memory: number of bytes that are not shared with the previous step.
        trial: True if the edit only tries another number from the start. Such an edit does not count as unsaved work.
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
    """Return the target of `step`. Pulling and placing a bead have the same target, because one gesture can contain
    both.
    """
    if isinstance(step, Scene):
        return ("words",)
    names = ["bead" if isinstance(item, inputs.Drag | inputs.Place) else type(item).__name__ for item in step]
    places = [[getattr(item, key, None) for key in ("lane", "bead", "contact")] for item in step]
    return tuple((name, *place) for name, place in zip(names, places, strict=True))


class UndoStack:
    """The steps that can be undone and redone.

    Attributes:
        done, undone: checkpoints; the next one to undo or redo is the last.
    """

    def __init__(self) -> None:
        self.done: deque[Checkpoint] = deque()
        self.undone: list[Checkpoint] = []
        self._numbers = count(1)
        self._saved = self._memory = 0
        self._dropped = 0  # Number of the last edit that can no longer be undone, because its step was dropped.
        self._open = False  # True while the gesture of the last input continues

    def continues(self, items: Sequence[inputs.Input], gesture: bool) -> bool:
        """Return True if `items` belong to the last step, which means to the same gesture."""
        return gesture and self._open and bool(self.done) and self.done[-1].target == target_of(items)

    def add(
        self, step: Sequence[inputs.Input] | Scene, gesture: bool, present: FrozenSession, trial: bool = False
    ) -> None:
        """Store the `present` session before a step. The step consists of inputs, or of a scene with new texts."""
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
        """End the gesture. The next input then starts a new step."""
        self._open = False

    def undo(self, present: FrozenSession) -> Checkpoint | None:
        """Return the session before the last step. Store the `present` session for a redo."""
        step = _move(self.done, self.undone, present)
        self._memory -= step.memory if step else 0
        return step

    def redo(self, present: FrozenSession) -> Checkpoint | None:
        """Return the session after the step that was undone last. Store the `present` session for an undo."""
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
        """True if there are unsaved edits, other than edits that only try another number."""
        only_trials = self._saved == self._dropped == 0 and all(step.trial for step in self.done if step.is_edit)
        return self.unsaved and not only_trials

    @property
    def unsaved_beside_first(self) -> bool:
        """True if there are unsaved edits that affect other lanes but not the first lane."""
        alone = (step.lanes and step.lanes.isdisjoint((0, None)) for step in self.done if step.is_edit)
        return self.unsaved and any(alone)

    def lose_what_was_saved(self) -> None:
        """Mark the present scene as unsaved, because no file contains it."""
        self._saved = -1

    def _last_edit(self) -> int:
        return next((step.number for step in reversed(self.done) if step.is_edit), self._dropped)


def _own_memory(present: FrozenSession, before: tuple[Block, ...]) -> int:
    """Return the number of bytes of `present` that are not shared with the blocks `before`."""
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
