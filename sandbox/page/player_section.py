"""The player: its markup and its data. The page's script draws the motion, and gives every control its work."""

from __future__ import annotations

import json
import math
from html import escape
from typing import Any

from softcradle.physics import Chain
from softcradle.sandbox.draw.lane_drawing import body_height, is_gear, mass_labels, solid_force
from softcradle.sandbox.draw.number_format import factor
from softcradle.sandbox.draw.palette import OKABE_ITO, bead_colours
from softcradle.sandbox.draw.rigid_clusters import cluster_ends, has_marks
from softcradle.sandbox.page.packed_motion import packed_lanes
from softcradle.sandbox.page.played_motion import Member, PlayedMotion

SPEEDS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)  # slow motion to choose from, relative to the scene's
ICONS = {
    "play": "M8 5v14l11-7z",
    "pause": "M7 5h4v14H7zM13 5h4v14h-4z",
    "back": "M6 5h2v14H6zM19 5v14L9 12z",
    "ahead": "M16 5h2v14h-2zM5 5v14l10-7z",
    "loop": "M17 17H7v-3l-4 4 4 4v-3h12v-6h-2zM7 7h10v3l4-4-4-4v3H5v6h2z",
}
HELP = (
    "Space plays and pauses, the arrow keys step through the motion (with Shift ten times as far), Page Up and Page Down go "
    "to the next switch of a contact, Home and End to the ends. Tap the beads to play or pause; drag over them or over a "
    "chart to move through time. Add #t=1.5 to the address for the moment 1.5 s."
)


def player_section(played: PlayedMotion) -> str:
    """The player of the page; there is one in a page."""
    lanes = "".join(_lane(played, k) for k in range(len(played.scene.lanes)))
    return (
        f'<section class="player" id="player" aria-label="player">{lanes}{_controls(played)}'
        f"<noscript><p>The motion plays by JavaScript; the tables below need none.</p></noscript></section>\n"
        f'<script type="application/json" id="data">{_json(_data(played))}</script>'
    )


def _lane(played: PlayedMotion, number: int) -> str:
    lane = played.scene.lanes[number]
    label = lane.label or played.scene.title
    return f'<canvas class="stage" data-lane="{number}" role="img" aria-label="{escape(label)}: the beads"></canvas>'


def _controls(played: PlayedMotion) -> str:
    """Slider of time under the marks of contacts, buttons, slow motion, and the slider of a family."""
    return (
        '<div class="time"><span class="caption">contacts closed</span>'
        '<canvas class="strip" role="img" aria-label="when each contact is closed"></canvas>'
        '<input type="range" id="time" min="0" max="100000" step="1" value="0" aria-label="time of the motion"></div>'
        '<div class="controls"><div class="buttons">'
        + _button("back", "to the switch of a contact before", "back")
        + _button("play", "play", "play", "pause")
        + _button("ahead", "to the next switch of a contact", "ahead")
        + _button("loop", "repeat without end", "loop", state='aria-pressed="true"')
        + '</div><output id="clock" for="time"></output>'
        + f'<label class="speed">speed <select id="speed">{_speeds(played.scene.view.slow)}</select></label>'
        + _family(played)
        + f'</div><details class="help"><summary>keys and touch</summary><p>{HELP}</p></details>'
    )


def _button(name: str, label: str, icon: str, second: str = "", state: str = "") -> str:
    """A button with an icon, and a `second` one that takes its place while the motion plays."""
    paths = f'<path class="one" d="{ICONS[icon]}"/>' + (f'<path class="two" d="{ICONS[second]}"/>' if second else "")
    picture = f'<svg viewBox="0 0 24 24" aria-hidden="true">{paths}</svg>'
    return f'<button type="button" id="{name}" aria-label="{label}" title="{label}" {state}>{picture}</button>'


def _speeds(slow: float) -> str:
    options = []
    for share in SPEEDS:
        chosen = " selected" if share == 1.0 else ""
        options.append(f'<option value="{slow * share:.9g}"{chosen}>{speed_text(slow * share)}</option>')
    return "".join(options)


def speed_text(slow: float) -> str:
    """The speed of a film of `slow` seconds for one of motion."""
    if abs(slow - 1.0) < 1e-9:
        return "real time"
    return f"1/{slow:.4g}" if slow > 1.0 else factor(1.0 / slow)


def _family(played: PlayedMotion) -> str:
    if not played.parameter:
        return ""
    name, last = escape(played.parameter), len(played.members) - 1
    return (
        f'<label class="family">{name} <input type="range" id="family" min="0" max="{last}" step="1" '
        f'value="{played.first}"><output id="member" for="family"></output></label>'
    )


def _data(played: PlayedMotion) -> dict[str, Any]:
    scales, view = played.scales, played.scene.view
    size, name = played.time_unit
    newtons, force_name = played.force_unit
    axes = ("time", "window", "velocity", "force", "magnify", "energy", "momentum")
    return {
        "slow": view.slow,
        "still": played.strongest_time,
        "first": played.first,
        "unit": {"size": size, "name": name},
        "forceUnit": {"size": newtons, "name": force_name},
        "length": view.length,
        "height": body_height(played.scene),
        "numbered": view.labels,
        "palette": [_hex(colour) for colour in bead_colours(_most_beads(played))] if _long(played) else [],
        "scales": {axis: getattr(scales, axis) for axis in axes},
        "members": _members(played),
    }


def _members(played: PlayedMotion) -> list[dict[str, Any]]:
    packed = iter(packed_lanes([motion for lanes in played.motions for motion in lanes], played.scales))
    length = played.scene.view.length
    return [
        {
            "name": member.name,
            "lanes": [_lane_data(member, k, length) | next(packed) for k in range(len(member.trajectories))],
        }
        for member in played.members
    ]


def _most_beads(played: PlayedMotion) -> int:
    return max(motion.chain.contacts + 1 for motion in played.motions[0])


def _long(played: PlayedMotion) -> bool:
    """Whether there are more beads than colours that can be told apart; a ramp of colours takes their place."""
    return _most_beads(played) > len(OKABE_ITO)


def _lane_data(member: Member, number: int, length: float) -> dict[str, Any]:
    trajectory = member.trajectories[number]
    chain: Chain = trajectory.chain
    ends = cluster_ends(trajectory.overlap[0].tolist(), trajectory.velocity[0].tolist(), length)
    return {
        "label": member.labels[number],
        "mass": [mass if math.isfinite(mass) else None for mass in chain.mass],
        "massLabels": mass_labels(chain),
        "gears": [is_gear(contact) for contact in chain.contact],
        "pulls": chain.pulls,
        "solid": [[_finite(solid_force(joint, sign)) for sign in (1.0, -1.0)] for joint in chain.contact],
        "preloads": [contact.preload for contact in chain.contact],
        "ends": ends,
        "marks": has_marks(ends),
        "dissipative": chain.dissipative,
        "closed": [
            [[begin, end if math.isfinite(end) else None] for begin, end in spans]
            for spans in trajectory.contact_intervals
        ],
    }


def _finite(force: float) -> float | None:
    return force if math.isfinite(force) else None


def _hex(colour: tuple[int, int, int]) -> str:
    return "#" + "".join(f"{part:02x}" for part in colour)


def _json(content: Any) -> str:
    """JSON inside a script element, in which no text may look like markup."""
    text = json.dumps(content, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return text.replace("<", "\\u003c")
