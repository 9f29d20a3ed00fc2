"""Notebook views without matplotlib: tables in HTML, films, web pages, and `play`, which opens the window.

Modules that draw are imported in the functions, because a table needs neither pygame nor an encoder.
"""

import base64
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import replace
from html import escape
from os import PathLike
from pathlib import Path

import numpy as np
from softcradle.physics import Chain, Contact, Coupler, Trajectory, hooke
from softcradle.physics.extras import needed_for
from softcradle.physics.notebook_views import InlineFilm
from softcradle.scenes import Lane, Scene, View, load
from softcradle.scenes.contact_text import contact_text

MOST_ROWS = 12  # most beads or contacts in a table; with more, only the first and the last are listed
UNDRAWN = hooke(1.0)  # placeholder for a user-defined law, which a scene cannot contain and a picture does not show
LENGTH = 6.0  # default duration of a film or page [s]
FILM_RATE = 30.0  # frames per second


def html_of(shown: Trajectory | Scene | Chain) -> str:
    """Return the table, below a picture if matplotlib is installed and something moves."""
    if isinstance(shown, Chain):
        return f"<p>{escape(repr(shown))}</p>{_chain_table(shown)}"
    if isinstance(shown, Scene):
        rows = [(lane.label or k, len(lane.velocity), repr(lane.chain())) for k, lane in enumerate(shown.lanes)]
        words = f"<p><b>{escape(shown.title)}</b> {escape(shown.source)}</p><p>{escape(shown.text)}</p>"
        return words + _table(("lane", "beads", "chain"), rows)
    return f"<p>{escape(repr(shown))}</p>{_picture(shown)}{_trajectory_table(shown)}"


def _picture(trajectory: Trajectory) -> str:
    """Return the trajectory's figure, or an empty text without matplotlib."""
    try:
        from softcradle.sandbox.notebook.figure_view import figure_of
    except ModuleNotFoundError:
        return ""
    data = base64.b64encode(figure_of(trajectory)._repr_png_()).decode()
    return f'<img alt="velocities and forces over time" src="data:image/png;base64,{data}">'


def _trajectory_table(trajectory: Trajectory) -> str:
    from softcradle.sandbox.story.sentences import describe
    from softcradle.sandbox.trajectory_summary import bead_table, contact_table, summarise

    summary = summarise("", trajectory)
    table = f"<p>{escape(describe('', trajectory))}</p>"
    table += "".join(_table(found.titles, found.rows) for found in (bead_table(summary), contact_table(summary)))
    if summary.velocity_error is not None:
        table += f"<p>velocities at the end to {summary.velocity_error:.1e} m/s</p>"
    return table + "".join(f"<p>warning: {escape(warning)}</p>" for warning in summary.warnings)


def _chain_table(chain: Chain) -> str:
    from softcradle.sandbox.story.numbers import plain
    from softcradle.sandbox.trajectory_summary import mass_text

    rows = [
        (
            f"{i}-{i + 1}",
            ", ".join(map(mass_text, chain.mass[i : i + 2])),
            contact_text(contact),
            plain(chain.gap[i], 6),
        )
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


def film_of(shown: Trajectory | Scene, slow: float | None, size: tuple[int, int]) -> InlineFilm:
    """Return the film as bytes; `slow` is seconds of film for each second of motion."""
    from softcradle.sandbox.film.scene_film import render_scene

    with tempfile.TemporaryDirectory(prefix="softcradle-") as folder:
        path = Path(folder) / "film.mp4"
        if isinstance(shown, Scene):
            render_scene(shown, path, size, fps=FILM_RATE, slow=slow, progress=False)
        else:
            _write_film(shown, path, slow, size)
        return InlineFilm(path.read_bytes(), size)


def _write_film(trajectory: Trajectory, path: Path, slow: float | None, size: tuple[int, int]) -> None:
    """Write the samples of the trajectory, each for as long as it is the nearest one."""
    from softcradle.sandbox.draw.scene_picture import Picture
    from softcradle.sandbox.draw.shared_scales import motion_of
    from softcradle.sandbox.film.encoder import open_film
    from softcradle.sandbox.film.scene_motion import require_finite

    motion = motion_of(trajectory)
    require_finite([motion])
    scene, span = scene_of(trajectory, slow), float(trajectory.time[-1] - trajectory.time[0])
    rate = scene.view.slow * FILM_RATE
    times = trajectory.time[0] + np.arange(int(span * rate) + 1) / rate
    between = 0.5 * (trajectory.time[1:] + trajectory.time[:-1])
    picture = Picture(scene, [motion], size, slow=scene.view.slow)
    with open_film(path, size, FILM_RATE) as film:
        for row in np.searchsorted(between, times):
            surface = film.free_surface()
            picture.paint(surface, int(row))
            film.add(surface)


def write_page_of(shown: Trajectory | Scene, path: str | PathLike[str], slow: float | None) -> None:
    """Write the page; `slow` is seconds for each second of motion, None for the scene's or the default slow motion."""
    from softcradle.sandbox.page import render_page, write_page

    if isinstance(shown, Scene):
        render_page(shown, path, slow)
    else:
        write_page(shown, scene_of(shown, slow), path)


def scene_of(trajectory: Trajectory, slow: float | None) -> Scene:
    """Return the scene of the trajectory's chain; pictures take title and view from it.

    It plays `slow` seconds for each second of motion, or LENGTH seconds in total if `slow` is None.
    """
    from softcradle.sandbox.film.scene_motion import checked_slow

    chain, span = trajectory.chain, float(trajectory.time[-1] - trajectory.time[0])
    usual = LENGTH / span if span > 0.0 else 1.0
    drawn = tuple(contact if isinstance(contact, Contact | Coupler) else UNDRAWN for contact in chain.contact)
    lane = Lane.of(replace(chain, contact=drawn), trajectory.velocity[0].tolist())
    title = f"{chain.contacts + 1} beads, by {trajectory.method}"
    return Scene(
        title=title,
        lanes=(lane,),
        duration=float(trajectory.time[-1]) or None,
        view=View(slow=checked_slow(usual if slow is None else slow)),
    )


def play(scene: Scene | str, size: tuple[int, int] = (1280, 720)) -> list[Trajectory]:
    """Open the window on `scene` and wait until it is closed.

    Parameters
    ----------
    scene : Scene or str
        A Scene, the name of one, or the path of a scene file.
    size : (int, int), optional
        Width and height of the window [pixels].

    Returns
    -------
    list of Trajectory
        The history of each lane, as it was when the window closed.

    Raises
    ------
    SceneError
        There is no such scene.
    UserError
        There is no display.
    ImportError
        The extra [window] is not installed.
    """
    shown = scene if isinstance(scene, Scene) else load(scene)
    with needed_for("play()", "window"):
        from softcradle.sandbox.session.session import Session
        from softcradle.sandbox.window.app import App
        from softcradle.sandbox.window.display import require_display
        from softcradle.sandbox.window.scene.page import ScenePage
    require_display()
    session = Session(shown)
    app = App(size)
    app.show(ScenePage(app, session, app.show_gallery))
    app.run()
    return [session.trajectory(lane) for lane in range(len(session.lanes))]
