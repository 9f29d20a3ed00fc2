"""The session: a scene that is being played with, everything there is to see of it, and what can be kept."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import perf_counter

from softcradle.physics.trajectory import Trajectory
from softcradle.sandbox.output_files import output_file
from softcradle.sandbox.session.contact_events import Impact, MarkBook, Marks
from softcradle.sandbox.session.frame_pacing import BUDGET
from softcradle.sandbox.session.health import BAD, LEVELS, WINDOW, Health, health_of
from softcradle.sandbox.session.history import MEMORY
from softcradle.sandbox.session.history_slices import Difference, Series, difference_of, series_of
from softcradle.sandbox.session.player import Player
from softcradle.sandbox.session.session_export import scene_of, trajectory_of
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Scene

SHOWN = 1200  # frames of a series unless told otherwise: ten seconds at the wall
AUDIBLE = 1e-3  # of the scene's closing speed: slower impacts make no click


class Session(Player):
    """A scene that is being played with; see :class:`Player` for the arguments and what moves it."""

    def __init__(
        self,
        scene: Scene,
        memory: int = MEMORY,
        budget: float = BUDGET,
        clock: Callable[[], float] = perf_counter,
    ) -> None:
        super().__init__(scene, memory, budget, clock)
        self._marks = MarkBook(self.history)

    # ---- to see

    def series(self, lane: int, frames: int = SHOWN, last: int | None = None) -> Series:
        """The `frames` frames of a lane up to `last` (the one shown), as long as its number of beads is the same."""
        end = self.frame if last is None else last
        return series_of(self.history, lane, max(self.history.first, end - frames + 1), end)

    def difference(self, frames: int = SHOWN) -> Difference:
        """The second lane minus the first. ValueError where there is only one."""
        if len(self.lanes) < 2:
            raise ValueError("a difference needs two lanes")
        return difference_of(self.series(0, frames), self.series(1, frames))

    def marks(self) -> Marks:
        """Contact closings and openings in the whole history."""
        return self._marks.all()

    @property
    def impacts(self) -> tuple[Impact, ...]:
        """Contacts that closed in the last tick, in order of time; those too slow to hear are left out."""
        before, after = self.ticked
        if after == before or self.history.last <= before:
            return ()
        marks = self._marks.since(before)
        hits = marks.chosen(marks.closed & (marks.frame <= after))
        found = map(Impact, hits.time.tolist(), hits.lane.tolist(), hits.contact.tolist(), hits.speed.tolist())
        return tuple(hit for hit in found if hit.speed > AUDIBLE * self.setup.lanes[hit.lane].speed)

    def health(self, lane: int) -> Health:
        """The badge of a lane at the moment shown."""
        series = self.series(lane, WINDOW)
        return health_of(series, self.setup.lanes[lane], self.setup.frame_time, self.pace, self.lanes[lane].trouble)

    def verdict(self) -> tuple[str, str]:
        """The worst level of any lane, 'good', 'fair' or 'bad', and its sentence."""
        if self.trouble:
            return BAD, self.trouble
        found = [self.health(lane) for lane in range(len(self.lanes))]
        worst = max(found, key=lambda health: LEVELS.index(health.level))
        return worst.level, worst.sentence

    # ---- to keep

    def to_scene(self) -> Scene:
        """The scene with all edits, as it begins. ValueError (SceneError) where a scene file cannot say it."""
        return scene_of(self.scene, self.setup)

    def save_scene(self, path: str | Path) -> None:
        """Write :meth:`to_scene` to a TOML file, whole or not at all. UserError where that cannot be."""
        try:
            text = self.to_scene().to_toml()
        except ValueError as error:
            raise UserError(f"this cannot be a scene file: {error}") from None
        with output_file(path) as temporary:
            temporary.write_text(text, encoding="utf-8")

    def trajectory(self, lane: int) -> Trajectory:
        """The history of a lane up to the moment shown, from where its chain was last changed."""
        return trajectory_of(self.series(lane, self.frame + 1), lane, self.marks())

    def export(self, path: str | Path) -> list[Path]:
        """Write the history as .npz or .csv, one file a lane (name-1, name-2 ...); returns the paths.

        UserError for another suffix, or where it cannot be written.
        """
        target = Path(path)
        if target.suffix not in (".npz", ".csv"):
            raise UserError(f"{target}: a history is exported as .npz or .csv")
        several = len(self.lanes) > 1
        paths = [target.with_stem(f"{target.stem}-{k + 1}") if several else target for k in range(len(self.lanes))]
        try:
            for lane, file in enumerate(paths):
                trajectory = self.trajectory(lane)
                (trajectory.save if target.suffix == ".npz" else trajectory.to_csv)(str(file))
        except OSError as error:
            raise UserError(str(error)) from None
        return paths

    def save_recording(self, path: str | Path) -> None:
        """Write what `Replay.load` runs again: base, inputs, hashes of the states. UserError where that cannot be."""
        self.recording.save(path, self.scene)
