"""Dialogs for the files of a page: scene, recording, data, web page, film and screenshot. A file is only replaced after
a question.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.surfaces import write_png
from softcradle.sandbox.files import output_file
from softcradle.sandbox.languages import N_, _, english, error_words
from softcradle.sandbox.page import render_page, write_page
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.user_error import UserError, reason
from softcradle.sandbox.window.dialog import MARGIN, WIDTH, shortened_path
from softcradle.sandbox.window.messages import Messages
from softcradle.sandbox.window.page import Host

LONGEST_STEM = 40  # Largest number of characters of a file name that is made from a title.
LONGEST_SHOWN = 60  # Largest number of characters that a message shows of an invalid file name.


def free_path(title: str, suffix: str) -> Path:
    """Return a path that is named after `title` and does not exist yet. If necessary, a number is added before the
    suffix.
    """
    stem = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")[:LONGEST_STEM] or "scene"
    path = free = Path(f"{stem}{suffix}")
    number = 1
    while os.path.exists(free):
        number += 1
        free = path.with_name(f"{path.stem}-{number}{path.suffix}")
    return free


def typed_path(text: str, endings: Sequence[str]) -> Path:
    """Return the path in `text`, with ~ as the home folder. If it has none of the `endings`, the first of them is
    added.

    Raises:
        UserError: a file cannot have this name.
    """
    path = Path(os.path.expanduser(text))
    if path.name in ("", ".."):
        raise UserError(_("{path} is a folder: add the name of a file", path=text))
    path = path if path.suffix.lower() in endings else path.with_name(path.name + endings[0])
    try:
        path.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return path
    except OSError as error:
        raise UserError(_("cannot write {path}: {reason}", path=_shortened(text), reason=reason(error))) from None
    except ValueError:  # The name contains a NUL character.
        raise UserError(
            _("cannot write {path}: {reason}", path=repr(text), reason=_("this is not a valid file name"))
        ) from None
    return path


def _shortened(text: str) -> str:
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 4]} ..."


def shown_path(path: Path) -> str:
    """Return the absolute path as text, with the home folder written as ~."""
    full = path.resolve()
    home = os.path.expanduser("~")  # The result of expanduser is "~" if there is no home folder.
    return f"~/{full.relative_to(home)}" if full.is_relative_to(home) else str(full)


FILM_ENDINGS = (".mp4", ".gif")
FRAME_RATE = 30.0  # Frames per second of the film. It contains every other frame of the window.
# Largest number of frames by which the film may be late. After a slow frame, further missing frames are left out.
MOST_DUE = 2.0


class WindowFilm:
    """The film that is being recorded, if any.

    Attributes:
        film: the open film, or None if nothing is recorded.
        seconds: duration of the film so far.
    """

    def __init__(self, host: Host) -> None:
        self.host = host
        self.film: Any = None
        self.path, self.seconds = Path(), 0.0
        self._size = (0, 0)
        self._stack: ExitStack | None = None
        self._due = 0.0

    @property
    def recording(self) -> bool:
        """True while a film is being recorded."""
        return self.film is not None

    def begin(self, path: Path) -> None:
        """Start recording a film with the present size of the window."""
        from softcradle.sandbox.film.encoder import open_film

        width, height = self.host.size
        self._size = width - width % 2, height - height % 2
        stack = ExitStack()
        try:
            self.film = stack.enter_context(open_film(path, self._size, FRAME_RATE))
        except (UserError, OSError) as error:
            self.host.messages.show(str(error), warning=True)
            return
        self._stack, self.path, self._due, self.seconds = stack, path, 0.0, 0.0

    def end(self) -> None:
        """Stop recording and write the film."""
        stack, self._stack, self.film = self._stack, None, None
        if stack is None:
            return
        try:
            stack.close()
        except (UserError, OSError, ValueError) as error:
            self.host.messages.show(_("the film could not be saved: {error}", error=error_words(error)), warning=True)
        else:
            text = _("saved {seconds:.0f} s to {path}", seconds=self.seconds, path=shown_path(self.path))
            self.host.messages.show(text)

    def record(self, surface: pygame.Surface, seconds: float) -> None:
        """Add the finished frame to the film, if the film needs a frame now. The frame comes `seconds` after the
        previous frame.
        """
        if self.film is None:
            return
        self._due = min(self._due + seconds * FRAME_RATE, MOST_DUE)
        if self._due < 1.0:
            return
        self._due -= 1.0
        try:
            frame = self.film.free_surface()
            _copy_whole(surface, frame)
            self.film.add(frame)
            self.seconds += 1.0 / FRAME_RATE
        except (UserError, OSError, ValueError, pygame.error) as error:
            self.host.messages.show(_("the film stopped: {error}", error=error_words(error)), warning=True)
            self.end()

    @property
    def clock(self) -> str:
        """Duration of the film as text, in minutes and seconds."""
        return f"{int(self.seconds) // 60}:{int(self.seconds) % 60:02d}"


def _copy_whole(surface: pygame.Surface, frame: pygame.Surface) -> None:
    """Copy `surface` onto `frame`. If the size of the window differs from the film, scale the picture and centre it."""
    (width, height), (wide, high) = surface.get_size(), frame.get_size()
    if width - width % 2 == wide and height - height % 2 == high:
        frame.blit(surface, (0, 0))
        return
    scale = min(wide / width, high / height)
    image = pygame.transform.smoothscale(surface, (round(width * scale), round(height * scale)))
    frame.fill(tones.background)
    frame.blit(image, image.get_rect(center=frame.get_rect().center))


class Saving(NamedTuple):
    """A kind of file that can be saved.

    It consists of the texts of the dialog, the proposed end of the file name, the possible endings, and two functions.
    One function writes the file. The other returns the paths of the resulting files. If it is `reopened`, the window
    can open the file, so its path is added to the recent files.
    """

    title: str
    note: str
    proposed: str
    endings: tuple[str, ...]
    write: Callable[[Path], object]
    files: Callable[[Path], list[Path]] = lambda path: [path]
    reopened: bool = False


def session_savings(messages: Messages, session: Session) -> dict[str, Saving]:
    """Return the kinds of files that a session can write."""
    savings = {
        "save_scene": Saving(
            N_("Save the scene"),
            N_("A .toml file with your changes. You can open the file here later."),
            "-edited.toml",
            (".toml",),
            session.save_scene,
            reopened=True,
        ),
        "save_session": Saving(
            N_("Save a recording"),
            N_("An .npz file. Drop it here to replay the session."),
            "-session.npz",
            (".npz",),
            session.save_recording,
            reopened=True,
        ),
        "export": Saving(
            N_("Export data"),
            N_("A .csv file (table) or .npz file (everything) for each row."),
            ".csv",
            (".csv", ".npz"),
            session.export,
            session.export_paths,
        ),
        "share_page": Saving(
            N_("Web page of this run"),
            N_("A web page that plays this run. Works offline."),
            ".html",
            (".html", ".htm"),
            partial(share_page, session),
        ),
        "live_page": Saving(
            N_("Web page to play with"),
            N_("A web page with beads you can throw. Works offline."),
            ".html",
            (".html", ".htm"),
            partial(share_page, session, live=True),
        ),
    }
    return {name: saving._replace(write=partial(_write_and_tell, messages, saving)) for name, saving in savings.items()}


def _write_and_tell(messages: Messages, saving: Saving, path: Path) -> None:
    """Write the files of one kind, and show a message with their names."""
    names = _(" and ").join(map(shown_path, saving.files(path)))
    report(messages, partial(saving.write, path), _("saved {path}", path=names))


class SaveDialogs:
    """Dialogs for the files of a page: its `savings`, a film and a screenshot. Proposed file names are made from the
    title of the page.
    """

    def __init__(self, host: Host, film: WindowFilm, savings: dict[str, Saving]) -> None:
        self.host, self.film = host, film
        note = N_("A .mp4 or .gif file. Records until you press Stop.")
        self.savings = {**savings, "film": Saving(N_("Record a video"), note, ".mp4", FILM_ENDINGS, film.begin)}
        self.actions: dict[str, Callable[[], None]] = {
            **{name: partial(self.ask, name) for name in self.savings},
            "film": self.toggle_film,
            "screenshot": self.screenshot,
        }

    def ask(self, name: str) -> None:
        """Ask for the path of the file for the saving `name`."""
        saving = self.savings[name]
        proposed = str(free_path(self.host.page.title, saving.proposed))
        unit = self.host.unit
        folder = shortened_path(
            shown_path(Path()), 16 * unit, (WIDTH - 2 * MARGIN) * unit
        )  # Shorten the path to the width of a line, because it contains no spaces at which it could be wrapped.
        note = _("{note} Folder: {folder}", note=_(saving.note), folder=folder)
        self.host.ask(_(saving.title), note, proposed, partial(self.save, name))

    def save(self, name: str, text: str) -> None:
        """Write the file of the saving `name` to the path `text`. If the file exists, ask before replacing it."""
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
        """Write the file. If the window can open it again, add it to the recent files."""
        saving.write(path)
        if saving.reopened:
            self.host.settings.remember(path)

    def toggle_film(self) -> None:
        """Start recording a film, or stop and write it."""
        if self.film.recording:
            self.film.end()
        else:
            self.ask("film")

    def screenshot(self) -> None:
        """Write the present window as a PNG file in the working folder."""
        path = free_path(self.host.page.title, ".png")

        def work() -> None:
            with output_file(path) as temporary:
                write_png(self.host.surface, temporary)

        report(self.host.messages, work, _("saved {path}", path=shown_path(path)))


def share_page(session: Session, path: Path, live: bool = False) -> None:
    """Write a web page with the motion of a session up to the current frame.

    If `live`, or if no motion has been recorded yet, the page simulates the scene instead.

    Raises:
        UserError: the page cannot be written.
    """
    found = [session.trajectory(lane) for lane in range(len(session.lanes))]
    try:
        scene = session.to_scene() if live else session.shown_scene()
    except ValueError as error:
        raise UserError(_("this cannot be shared: {error}", error=error_words(error))) from None
    with english():  # Web pages are always in English.
        if live or any(trajectory.time.size <= 1 for trajectory in found):
            render_page(scene, path)
        else:
            write_page(found, scene, path)


def report(messages: Messages, work: Callable[[], object], done: str) -> None:
    """Run `work` and show the message `done`, or the error message if it fails."""
    try:
        work()
    except (UserError, OSError, ValueError) as error:
        messages.show(str(error), warning=True)
    else:
        messages.show(done)
