"""Views in a notebook that do not need matplotlib: HTML tables, films, web pages, and the function `play`, which opens
the window.

The functions themselves import the modules that draw. A table therefore needs neither pygame nor an encoder.
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

# Largest number of beads or contacts in a table. If there are more, the table omits rows before the last one.
MOST_ROWS = 12
# Placeholder for a user-defined contact law. A scene cannot contain such a law, and a picture does not show it.
UNDRAWN = hooke(1.0)
LENGTH = 6.0  # default duration of a film or page [s]
FILM_RATE = 30.0  # number of frames per second of a film


def html_of(shown: Trajectory | Scene | Chain) -> str:
    """Return an HTML table. If matplotlib is installed and the object has a motion, a picture is above the table."""
    if isinstance(shown, Chain):
        return f"<p>{escape(repr(shown))}</p>{_chain_table(shown)}"
    if isinstance(shown, Scene):
        rows = [(lane.label or k, len(lane.velocity), repr(lane.chain())) for k, lane in enumerate(shown.lanes)]
        words = f"<p><b>{escape(shown.title)}</b> {escape(shown.source)}</p><p>{escape(shown.text)}</p>"
        return words + _table(("lane", "beads", "chain"), rows)
    return f"<p>{escape(repr(shown))}</p>{_picture(shown)}{_trajectory_table(shown)}"


def _picture(trajectory: Trajectory) -> str:
    """Return the figure of the trajectory as HTML. Return an empty text if matplotlib is not installed."""
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
    """Return the film as bytes. `slow` is the number of seconds of film for each second of motion."""
    from softcradle.sandbox.film.scene_film import render_scene

    with tempfile.TemporaryDirectory(prefix="softcradle-") as folder:
        path = Path(folder) / "film.mp4"
        if isinstance(shown, Scene):
            render_scene(shown, path, size, fps=FILM_RATE, slow=slow, progress=False)
        else:
            _write_film(shown, path, slow, size)
        return InlineFilm(path.read_bytes(), size)


def _write_film(trajectory: Trajectory, path: Path, slow: float | None, size: tuple[int, int]) -> None:
    """Write a film of the samples of a trajectory. Each frame shows the sample that is nearest in time."""
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
    """Write the web page. `slow` is the number of seconds for each second of motion. If it is None, the value of the
    scene or the default is used.
    """
    from softcradle.sandbox.page import render_page, write_page

    if isinstance(shown, Scene):
        render_page(shown, path, slow)
    else:
        write_page(shown, scene_of(shown, slow), path)


def scene_of(trajectory: Trajectory, slow: float | None) -> Scene:
    """Return a scene with the chain of the trajectory. Pictures use the title and the view of this scene.

    The scene is played with `slow` seconds for each second of motion. If `slow` is None, it is played in LENGTH seconds
    in total.
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
    """Open the window with `scene` and wait until the user closes it.

    Parameters
    ----------
    scene : Scene or str
        A Scene, the name of a scene, or the path of a scene file.
    size : (int, int), optional
        Width and height of the window [pixels].

    Returns
    -------
    list of Trajectory
        The recorded motion of each lane at the time the window was closed.

    Raises
    ------
    SceneError
        The scene does not exist.
    UserError
        No display is available.
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
