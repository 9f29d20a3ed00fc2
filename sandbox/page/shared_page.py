"""The page to share of a scene: player, charts and tables of what was recorded."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from softcradle.physics import Trajectory
from softcradle.sandbox.motion_words import describe
from softcradle.sandbox.output_files import output_file
from softcradle.sandbox.page.motion_charts import chart_row, force_chart, overlap_chart, velocity_chart
from softcradle.sandbox.page.page_document import document, footer, heading, paragraph
from softcradle.sandbox.page.page_tables import member_notes, member_tables
from softcradle.sandbox.page.played_motion import Member, PlayedMotion, scene_member
from softcradle.sandbox.page.player_section import player_section
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Scene


@dataclass(frozen=True)
class PageReport:
    """What was written: where, and how long it is [bytes]."""

    output: Path
    size: int


def write_page(
    trajectories: Trajectory | Sequence[Trajectory], scene: Scene, path: str | os.PathLike[str]
) -> PageReport:
    """Write the recorded `trajectories`, one for each lane of `scene`, as a page that plays them.

    Raises
    ------
    UserError
        `path` cannot be written, or the motion is too long for a page; nothing is left behind.
    """
    found = (trajectories,) if isinstance(trajectories, Trajectory) else tuple(trajectories)
    if len(found) != len(scene.lanes):
        raise UserError(f"a page needs a trajectory for each lane: {len(scene.lanes)}, not {len(found)}")
    with output_file(path) as temporary:
        size = write_text(PlayedMotion(scene, (scene_member(scene, found),)), temporary)
    return PageReport(Path(path), size)


def write_text(played: PlayedMotion, path: Path) -> int:
    """Write the page of `played` to `path`; its length in bytes. Raises UserError where the motion is too long for a page."""
    return path.write_bytes(page_text(played).encode())


def page_text(played: PlayedMotion) -> str:
    """The whole page as text."""
    scene, lanes = played.scene, range(len(played.scene.lanes))
    charts = [chart(played, lane) for lane in lanes for chart in (velocity_chart, force_chart, overlap_chart)]
    parts = [
        heading(scene.title, scene.source),
        player_section(played),
        each_member(played, lambda member: _what_happened(played, member)),
        each_member(played, member_notes),
        "<h2>In curves</h2>",
        chart_row(charts),
        "<h2>In numbers</h2>",
        each_member(played, member_tables),
        _scene_file(played),
        footer([]),
    ]
    return document(scene.title, parts)


def _what_happened(played: PlayedMotion, member: Member) -> str:
    """The text of the scene; of another member of a family, for which it was not written, what was recorded, in words."""
    if member is played.members[played.first]:
        return paragraph(played.scene.text)
    return "".join(map(paragraph, map(describe, member.labels, member.trajectories)))


def each_member(played: PlayedMotion, part: Callable[[Member], str]) -> str:
    """`part` of every member, of which the script shows that of the one that plays."""
    return "".join(
        f'<div class="member" data-member="{k}"{"" if k == played.first else " hidden"}>{part(member)}</div>'
        for k, member in enumerate(played.members)
    )


def _scene_file(played: PlayedMotion) -> str:
    """The scene as text; nothing where a chain has a law of one's own, which no scene file can hold."""
    if any(found.chain.own_laws for member in played.members for found in member.trajectories):
        return ""
    return (
        "<details><summary>The scene as a file: softcradle play FILE lets you change it</summary>"
        f'<pre tabindex="0">{escape(played.scene.to_toml())}</pre></details>'
    )
