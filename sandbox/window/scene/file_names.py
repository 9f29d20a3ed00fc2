"""Names of files that come from a session: free ones, typed ones, and how they are shown."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path

from softcradle.sandbox.languages import _
from softcradle.sandbox.user_error import UserError, reason

LONGEST_STEM = 40  # characters of a file name that is made from a title
LONGEST_SHOWN = 60  # characters of a name that no file can have


def free_path(title: str, suffix: str) -> Path:
    """A path named after a `title`; with a number before its last suffix where there is such a file already."""
    stem = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")[:LONGEST_STEM] or "scene"
    path = free = Path(f"{stem}{suffix}")
    number = 1
    while os.path.exists(free):
        number += 1
        free = path.with_name(f"{path.stem}-{number}{path.suffix}")
    return free


def typed_path(text: str, endings: Sequence[str]) -> Path:
    """The path that was typed: ~ is the home folder, and the first of `endings` is added where it has none of them.

    Raises:
        UserError: no file can have this name.
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
    except ValueError:  # a NUL
        raise UserError(
            _("cannot write {path}: {reason}", path=repr(text), reason=_("no file has such a name"))
        ) from None
    return path


def _shortened(text: str) -> str:
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 4]} ..."


def shown_path(path: Path) -> str:
    """The path with its full folder, the home folder as ~."""
    full = path.resolve()
    home = Path.home()
    return f"~/{full.relative_to(home)}" if full.is_relative_to(home) else str(full)
