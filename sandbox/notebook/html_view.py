"""Tables of a notebook in HTML: what a trajectory, a scene or a chain is, in a few lines, with a picture of its motion."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from html import escape

from softcradle.physics import Chain, Trajectory
from softcradle.sandbox.trajectory_summary import summarise
from softcradle.scenes import Scene
from softcradle.scenes.contact_text import contact_text

MOST_ROWS = 12  # beads or contacts of a table; of more, the first and the last are shown


def html_of(shown: Trajectory | Scene | Chain) -> str:
    """The table, below a picture where matplotlib is installed and something moves."""
    if isinstance(shown, Chain):
        return f"<p>{escape(repr(shown))}</p>{_chain_table(shown)}"
    if isinstance(shown, Scene):
        rows = [(lane.label or k, len(lane.velocity), repr(lane.chain())) for k, lane in enumerate(shown.lanes)]
        words = f"<p><b>{escape(shown.title)}</b> {escape(shown.source)}</p><p>{escape(shown.text)}</p>"
        return words + _table(("lane", "beads", "chain"), rows)
    return f"<p>{escape(repr(shown))}</p>{_picture(shown)}{_trajectory_table(shown)}"


def _picture(trajectory: Trajectory) -> str:
    """The trajectory's figure; empty without matplotlib."""
    try:
        from softcradle.sandbox.notebook.figure_view import figure_of
    except ModuleNotFoundError:
        return ""
    data = base64.b64encode(figure_of(trajectory)._repr_png_()).decode()
    return f'<img alt="velocities and forces over time" src="data:image/png;base64,{data}">'


def _trajectory_table(trajectory: Trajectory) -> str:
    summary = summarise("", trajectory)
    last = "velocity when it gave up [m/s]" if summary.gave_up else "final velocity [m/s]"
    beads = [
        (
            i,
            "wall" if bead.mass is None else f"{bead.mass:g}",
            f"{bead.start_velocity:.6g}",
            f"{bead.final_velocity:.6g}",
        )
        for i, bead in enumerate(summary.beads)
    ]
    table = _table(("bead", "mass [kg]", "velocity at start [m/s]", last), beads)
    if summary.velocity_error is not None:
        table += f"<p>velocities at the end to {summary.velocity_error:.1e} m/s</p>"
    return table + "".join(f"<p>warning: {escape(warning)}</p>" for warning in summary.warnings)


def _chain_table(chain: Chain) -> str:
    rows = [
        (f"{i}-{i + 1}", f"{chain.mass[i]:g}, {chain.mass[i + 1]:g}", contact_text(contact), f"{chain.gap[i]:g}")
        for i, contact in enumerate(chain.contact)
    ]
    return _table(("contact", "masses [kg]", "law", "gap [m]"), rows)


def _table(titles: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    shown = list(rows)
    if len(shown) > MOST_ROWS:
        shown = [*shown[: MOST_ROWS - 2], ["…"] * len(titles), shown[-1]]
    return f"<table>{_row('th', titles)}{''.join(_row('td', row) for row in shown)}</table>"


def _row(kind: str, cells: Iterable[object]) -> str:
    return f"<tr>{''.join(f'<{kind}>{escape(str(cell))}</{kind}>' for cell in cells)}</tr>"
