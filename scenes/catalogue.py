"""Catalogue of scenes, and loading of scenes by name or by path."""

import difflib
import errno
import os
from pathlib import Path

from pydantic import ValidationError
from softcradle.physics.messages import Message
from softcradle.scenes.scene_errors import SceneError, at, scene_error
from softcradle.scenes.scene_schema import Scene
from softcradle.scenes.toml_mistakes import MOST_SHOWN, read_toml

CATALOGUE = Path(__file__).parent / "catalogue"
# Largest number of characters that are read from a file. A lane of the largest size has a few million.
MOST_TEXT = 2**26


def names() -> tuple[str, ...]:
    """Return the sorted names of the scenes that are part of softcradle."""
    return tuple(sorted(path.stem for path in CATALOGUE.glob("*.toml")))


def load(name_or_path: str | Path) -> Scene:
    """Return a scene by the name of a scene of the catalogue, or by the path of a scene file.

    Raises:
        SceneError: the scene or file does not exist, or the file is not a valid scene. There is one sentence for each
            problem.

    >>> load("one-on-four").lanes[0].velocity
    (1.0, 0.0, 0.0, 0.0, 0.0)
    """
    return parse(*_read(str(name_or_path)))


def text_of(name_or_path: str | Path) -> str:
    """Return the text of a scene file, for example as a starting point for a new scene.

    Raise SceneError if the scene does not exist.
    """
    return _read(str(name_or_path))[0]


def parse(text: str, file: str = "scene") -> Scene:
    """Return the scene that the TOML `text` describes.

    Raise SceneError with all problems of the text. The messages use `file` as the name of the text.
    """
    table, mistakes = read_toml(text)
    problems: list[str] = [at(file, mistake) for mistake in mistakes]
    scene = None
    if table is not None:
        try:
            scene = Scene.model_validate(table)
        except ValidationError as error:
            problems += scene_error(file, error).problems
    if scene is None or problems:
        raise SceneError(problems)
    return scene


def _read(wanted: str) -> tuple[str, str]:
    """Return the text of the scene `wanted`, and the file name for error messages."""
    shipped = CATALOGUE / f"{wanted}.toml"
    if wanted in names():
        return shipped.read_text(encoding="utf-8"), shipped.name
    if not wanted.endswith(".toml") and Path(wanted).name == wanted and not os.path.isfile(wanted):
        raise SceneError([_unknown(wanted)])
    try:
        return text_in(wanted), wanted
    except FileNotFoundError:
        raise SceneError([Message("no_file", "cannot find the file {path}", path=wanted)]) from None
    except UnicodeDecodeError as error:
        raise SceneError([at(wanted, _encoding_hint(error))]) from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise SceneError([Message("unreadable", "cannot read {path}: {reason}", path=wanted, reason=reason)]) from None
    except ValueError:  # The name is not possible for a file. An example is a name with a null character.
        raise SceneError([Message("no_file", "cannot find the file {path}", path=repr(wanted))]) from None


def text_in(path: str) -> str:
    """Return the text of a file or pipe. Raise OSError if it cannot be read, or ValueError if it is not UTF-8 text."""
    with open(path, encoding="utf-8-sig") as file:
        text = file.read(MOST_TEXT)
    if len(text) == MOST_TEXT:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG))
    return text


def _encoding_hint(error: UnicodeDecodeError) -> Message:
    """Return advice about a file that is not in UTF-8.

    If the encoding has one byte per character, the advice contains the line of the problem.
    """
    data = bytes(error.object)
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return Message(
            "utf_16",
            "not a text file in UTF-8: save it as UTF-8 (it seems to be UTF-16, which Windows calls Unicode)",
        )
    if b"\0" in data:
        return Message("no_text", "not a text file in UTF-8: save it as UTF-8 (it does not seem to be text)")
    line = data.count(b"\n", 0, error.start)
    shown = data.split(b"\n")[line].decode("cp1252", "replace").strip()[:MOST_SHOWN]
    return Message(
        "no_utf_8",
        "not a text file in UTF-8: save it as UTF-8 (line {line}: {text})",
        line=line + 1,
        text=shown,
    )


def _unknown(wanted: str) -> Message:
    near = difflib.get_close_matches(wanted, names(), n=3, cutoff=0.5)
    if near:
        return Message(
            "near_scene",
            "unknown scene {name!r}; did you mean {near}? (softcradle scenes lists all scenes; scene files end in .toml)",
            name=wanted,
            near=", ".join(near),
        )
    return Message(
        "scene",
        "unknown scene {name!r} (softcradle scenes lists all scenes; scene files end in .toml)",
        name=wanted,
    )
