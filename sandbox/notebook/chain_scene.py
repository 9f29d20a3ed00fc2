"""The scene of a trajectory that was made without one: films and pages are of a scene."""

from __future__ import annotations

from dataclasses import asdict

from softcradle.physics import OwnLaw, Trajectory, hooke
from softcradle.scenes import Lane, Scene, View
from softcradle.scenes.contact_table import law_of, table_of
from softcradle.scenes.scene_schema import ForceTable

UNDRAWN = law_of(hooke(1.0))  # stands in the scene for a law of one's own, which no scene can name and no picture shows
LENGTH = 6.0  # [s] of a film or page where no slow motion is given


def usual_slow(trajectory: Trajectory) -> float:
    """The slow motion [s of a film for one of motion] with which the trajectory is LENGTH long."""
    span = float(trajectory.time[-1] - trajectory.time[0])
    return LENGTH / span if span > 0.0 else 1.0


def scene_of(trajectory: Trajectory, slow: float) -> Scene:
    """The scene of the trajectory's chain, played `slow` seconds for one of motion: pictures take title and view from it."""
    chain = trajectory.chain
    lane = Lane(
        mass=chain.mass,
        contact=tuple(UNDRAWN if isinstance(contact, OwnLaw) else table_of(contact) for contact in chain.contact),
        velocity=tuple(trajectory.velocity[0].tolist()),
        gap=chain.gap,
        drive=chain.drive,
        friction=chain.friction,
        forces=tuple(ForceTable(**asdict(item)) for item in chain.forces),
        brakes=tuple(ForceTable(**asdict(item)) for item in chain.brakes),
    )
    title = f"{chain.contacts + 1} beads, by {trajectory.method}"
    return Scene(title=title, lanes=(lane,), duration=float(trajectory.time[-1]) or None, view=View(slow=slow))
