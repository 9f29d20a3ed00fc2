"""`play`: the window, opened from a notebook or a script, which gets what was played."""

from __future__ import annotations

from softcradle.physics import Trajectory
from softcradle.physics.extras import needed_for
from softcradle.scenes import Scene, load


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
        from softcradle.sandbox.window.scene.scene_page import ScenePage
    require_display()
    session = Session(shown)
    app = App(size)
    app.show(ScenePage(app, session, app.show_gallery))
    app.run()
    return [session.trajectory(lane) for lane in range(len(session.lanes))]
