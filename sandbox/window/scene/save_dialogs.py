"""Save dialogs: the scene, the session, its history, a page to share, a film, a screenshot; no file is replaced unasked."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

from softcradle.sandbox.draw.png_file import write_png
from softcradle.sandbox.languages import N_, _, english, error_words
from softcradle.sandbox.output_files import output_file
from softcradle.sandbox.page import render_page, write_page
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.messages import Messages
from softcradle.sandbox.window.scene.file_names import free_path, shown_path, typed_path
from softcradle.sandbox.window.scene.window_film import FILM_ENDINGS, WindowFilm
from softcradle.sandbox.window.window_page import Host

REOPENED = (".toml", ".npz")  # endings of files that the window opens


class Saving(NamedTuple):
    """One kind of file: what the dialog says, the end of the proposed name, the endings, what writes it, and which files."""

    title: str
    note: str
    proposed: str
    endings: tuple[str, ...]
    write: Callable[[Path], object]
    files: Callable[[Path], list[Path]] = lambda path: [path]


def session_savings(messages: Messages, session: Session) -> dict[str, Saving]:
    """The files that come from a session."""

    def reporting(write: Callable[[Path], object]) -> Callable[[Path], None]:
        return lambda path: report(messages, partial(write, path), _("saved {path}", path=shown_path(path)))

    return {
        "save_scene": Saving(
            N_("Save the scene"),
            N_("a .toml file with all edits, to be opened here, rendered or run"),
            "-edited.toml",
            (".toml",),
            reporting(session.save_scene),
        ),
        "save_session": Saving(
            N_("Save the session"),
            N_("an .npz file: drop it here to replay the session"),
            "-session.npz",
            (".npz",),
            reporting(session.save_recording),
        ),
        "export": Saving(
            N_("Export the history"),
            N_(".csv (a table) or .npz (everything); a file a lane"),
            ".csv",
            (".csv", ".npz"),
            reporting(session.export),
            session.export_paths,
        ),
        "share_page": Saving(
            N_("Share as a page"),
            N_("an .html file: any browser plays what was recorded, no network needed"),
            ".html",
            (".html", ".htm"),
            reporting(partial(share_page, session)),
        ),
    }


class SaveDialogs:
    """Dialogs for the files of a page: its own `savings`, a film and a screenshot, named after its `title`."""

    def __init__(self, host: Host, title: str, film: WindowFilm, savings: dict[str, Saving]) -> None:
        self.host, self.title, self.film = host, title, film
        note = N_("a .mp4, .gif or .webp file; it records from now on until Stop")
        self.savings = {**savings, "film": Saving(N_("Film the window"), note, ".mp4", FILM_ENDINGS, film.begin)}
        self.actions: dict[str, Callable[[], None]] = {
            **{name: partial(self.ask, name) for name in self.savings},
            "film": self.toggle_film,
            "screenshot": self.screenshot,
        }

    def ask(self, name: str) -> None:
        """Ask for the path of a kind of file."""
        saving = self.savings[name]
        proposed = str(free_path(self.title, saving.proposed))
        note = _("{note}, in {folder}", note=_(saving.note), folder=shown_path(Path()))
        self.host.ask(_(saving.title), note, proposed, partial(self.save, name))

    def save(self, name: str, text: str) -> None:
        """Write that kind of file to the path `text`; ask first where there is a file already."""
        saving = self.savings[name]
        try:
            path = typed_path(text, saving.endings)
        except UserError as error:
            self.host.messages.show(str(error), warning=True)
            return
        taken = [file for file in saving.files(path) if os.path.exists(file)]
        if not taken:
            self._write(saving, path)
            return
        names = _(" and ").join(shown_path(file) for file in taken)
        self.host.choose(
            _("Replace it?"),
            _("There is already {names}.", names=names),
            {
                _("Another name ..."): partial(self.ask, name),
                _("Replace"): partial(self._write, saving, path),
                _("Cancel"): lambda: None,
            },
        )

    def _write(self, saving: Saving, path: Path) -> None:
        """Write it, and remember it among the recent files where it can be opened again."""
        saving.write(path)
        if path.suffix in REOPENED:
            self.host.settings.remember(path)

    def toggle_film(self) -> None:
        """Begin a film, or end the one that is recorded."""
        if self.film.film is not None:
            self.film.end()
        else:
            self.ask("film")

    def screenshot(self) -> None:
        """Write the window as it is, as a PNG file in the working folder."""
        path = free_path(self.title, ".png")

        def work() -> None:
            with output_file(path) as temporary:
                write_png(self.host.surface, temporary)

        report(self.host.messages, work, _("saved {path}", path=shown_path(path)))


def share_page(session: Session, path: Path) -> None:
    """Write what a session has recorded, up to the frame shown, as a page; before a run, one in which the scene lives.

    Raises:
        UserError: the page cannot be written.
    """
    found = [session.trajectory(lane) for lane in range(len(session.lanes))]
    try:
        scene = session.to_scene()
    except ValueError as error:
        raise UserError(_("this cannot be shared: {error}", error=error_words(error))) from None
    with english():  # as all else on a page
        if all(trajectory.time.size > 1 for trajectory in found):
            write_page(found, scene, path)
        else:
            render_page(scene, path)


def report(messages: Messages, work: Callable[[], object], done: str) -> None:
    """Do `work` and show the message `done`, or what went wrong."""
    try:
        work()
    except (UserError, OSError, ValueError) as error:
        messages.show(str(error), warning=True)
    else:
        messages.show(done)
