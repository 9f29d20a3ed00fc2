"""The session: a scene that is being played with, everything that a window shows of it, and its exports."""

from __future__ import annotations

from pathlib import Path

from softcradle.physics.trajectory import Trajectory
from softcradle.sandbox.files import output_file
from softcradle.sandbox.languages import _, error_words
from softcradle.sandbox.motion import BAD, LEVELS, Array
from softcradle.sandbox.session.contact_events import ContactEvents, Impact, contact_events
from softcradle.sandbox.session.export import lane_label, scene_of, trajectory_of
from softcradle.sandbox.session.history_slices import HistorySlice, approach_of, history_slices, last_slice
from softcradle.sandbox.session.player import Player
from softcradle.sandbox.session.run_verdict import WINDOW, Finding, Health, health_of, run_findings
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Scene

AUDIBLE = 1e-3  # of the scene's closing speed: slower impacts make no click


class Session(Player):
    """A scene that is being played with; see :class:`Player` for the arguments and what moves it."""

    # ---- what is shown

    def history_slices(self, lane: int, frames: int) -> list[HistorySlice]:
        """The last `frames` frames of a lane up to the one shown, ascending."""
        return list(history_slices(self.history, lane, self.frame - frames + 1, self.frame))

    def contact_events(self) -> ContactEvents:
        """Contact closings and openings in the whole history."""
        return contact_events(self.history)

    @property
    def impacts(self) -> tuple[Impact, ...]:
        """Contacts that closed in the last tick, in order of time; those too slow to hear are left out."""
        before, after = self.last_tick
        if after == before or self.history.last <= before:
            return ()
        events = contact_events(self.history, before)
        hits = events.select(events.closed & (events.frame <= after))
        found = map(Impact, hits.time.tolist(), hits.lane.tolist(), hits.contact.tolist(), hits.speed.tolist())
        return tuple(hit for hit in found if hit.speed > AUDIBLE * self.setup.lanes[hit.lane].speed)

    def health(self, lane: int, velocity_error: float | None = None) -> Health:
        """The health of a lane at the frame shown, with the error that a VelocityCheck has found."""
        slices, live, length = self.history_slices(lane, WINDOW), self.lanes[lane], self.scene.view.length
        frame_time, pacer = self.setup.frame_time, self.pacer
        return health_of(slices, live.setup, frame_time, pacer, live.warning, length, velocity_error)

    def findings(self, lane: int) -> list[Finding]:
        """What was wrong with a lane in the whole run, in order of time."""
        return run_findings(self.history, lane, self.scene.view.length)

    def approach(self, lane: int) -> tuple[Array, Array]:
        """(n,) overlaps [m] and (n+1,) velocities [m/s] before the collision at the frame shown, or before the next."""
        found = approach_of(self.history, lane, self.frame)
        live = self.lanes[lane]
        return (live.setup.start.overlap, live.setup.start.velocity(live.chain)) if found is None else found

    def label(self, lane: int) -> str:
        """What is written beside a lane: the scene's label, or what its contacts are after an edit."""
        old, now = self.scene.lanes[lane], self.lanes[lane].chain
        return lane_label(old.label, old.chain(), now)

    def verdict(self) -> tuple[str, str]:
        """The worst level of any lane, 'good', 'fair' or 'bad', and its sentence."""
        if self.failure:
            return BAD, self.failure
        found = [self.health(lane) for lane in range(len(self.lanes))]
        worst = max(found, key=lambda health: LEVELS.index(health.level))
        return worst.level, worst.sentence

    # ---- exports

    def to_scene(self) -> Scene:
        """The scene with all edits, as it begins. ValueError (SceneError) where a scene file cannot say it."""
        labels = [self.label(lane) for lane in range(len(self.lanes))]
        return scene_of(self.scene, self.setup, labels)

    @property
    def edited(self) -> bool:
        """Whether its lanes begin otherwise than those of the scene it was opened with: what that says of them may be wrong."""
        try:
            return self.to_scene().lanes != self.scene.lanes
        except ValueError:  # no scene file can say it
            return True

    def save_scene(self, path: str | Path) -> None:
        """Write :meth:`to_scene` to a TOML file, whole or not at all. UserError where that cannot be."""
        try:
            text = self.to_scene().to_toml()
        except ValueError as error:
            raise UserError(_("this cannot be a scene file: {error}", error=error_words(error))) from None
        with output_file(path) as temporary:
            temporary.write_text(text, encoding="utf-8")
        self.undo_stack.mark_saved()

    def trajectory(self, lane: int) -> Trajectory:
        """The history of a lane up to the frame shown, from where its chain was last changed."""
        return trajectory_of(last_slice(self.history, lane, self.frame), lane, self.contact_events())

    def export_paths(self, target: Path) -> list[Path]:
        """The files that :meth:`export` writes."""
        several = len(self.lanes) > 1
        return [target.with_stem(f"{target.stem}-{k + 1}") if several else target for k in range(len(self.lanes))]

    def export(self, path: str | Path) -> list[Path]:
        """Write the history as .npz or .csv, one file a lane (name-1, name-2 ...); returns the paths.

        UserError for another suffix, or where it cannot be written.
        """
        target = Path(path)
        if target.suffix not in (".npz", ".csv"):
            raise UserError(_("{path}: a history is exported as .npz or .csv", path=target))
        paths = self.export_paths(target)
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
        self.undo_stack.mark_saved()
