"""The charts of a played motion: velocities, forces and overlaps of every lane against time, on the same axes."""

from __future__ import annotations

from dataclasses import replace

from softcradle.sandbox.draw.number_format import subscript
from softcradle.sandbox.page.played_motion import PlayedMotion
from softcradle.sandbox.page.svg_charts import Axes, MotionCurves, Range, motion_chart


def velocity_axes(played: PlayedMotion) -> Axes:
    """Axes of velocities."""
    return _axes(played, played.scales.velocity, "velocity (m/s)")


def force_axes(played: PlayedMotion) -> Axes:
    """Axes of contact forces."""
    unit, name = played.force_unit
    axes = _axes(played, (played.scales.pull / unit, played.scales.force / unit), f"contact force ({name})")
    return replace(axes, y_unit=unit)


def overlap_axes(played: PlayedMotion) -> Axes:
    """Axes of overlaps, decades apart."""
    low, high = played.scales.decades
    return _axes(played, (float(low), float(high)), "overlap (m), logarithmic", True)


def _axes(played: PlayedMotion, values: Range, label: str, logarithmic: bool = False) -> Axes:
    unit, name = played.time_unit
    low, high = played.scales.time
    return Axes((low / unit, high / unit), values, f"time ({name})", label, unit, logarithmic=logarithmic)


def velocity_chart(played: PlayedMotion, lane: int) -> str:
    """Velocities of the beads of one lane."""
    beads = played.motions[0][lane].chain.contacts + 1
    names = [f"v{subscript(k)}" for k in range(beads)]
    return _chart(played, MotionCurves(lane, "velocity", names, 0), velocity_axes(played))


def force_chart(played: PlayedMotion, lane: int) -> str:
    """Forces of the contacts of one lane."""
    return _chart(played, _contact_curves(played, lane, "force", "f"), force_axes(played))


def overlap_chart(played: PlayedMotion, lane: int) -> str:
    """Overlaps of the contacts of one lane."""
    return _chart(played, _contact_curves(played, lane, "overlap", "δ"), overlap_axes(played))


def _contact_curves(played: PlayedMotion, lane: int, channel: str, letter: str) -> MotionCurves:
    """A contact has the colour of the bead on its right."""
    contacts = range(played.motions[0][lane].chain.contacts)
    return MotionCurves(lane, channel, [letter + subscript(k, k + 1) for k in contacts], 1)


def _chart(played: PlayedMotion, curves: MotionCurves, axes: Axes) -> str:
    label = played.scene.lanes[curves.lane].label if len(played.scene.lanes) > 1 else ""
    return motion_chart(f"{label}: {axes.y_label}" if label else axes.y_label, curves, axes)


def chart_row(charts: list[str]) -> str:
    """Charts side by side, or below each other where there is no room."""
    return f'<div class="charts">{"".join(charts)}</div>'
