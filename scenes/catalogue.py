"""The catalogue of scenes, and scenes by name or by the path of a file."""

import difflib
import errno
import os
import tomllib
from pathlib import Path

from pydantic import ValidationError
from softcradle.scenes.scene_errors import SceneError, scene_error
from softcradle.scenes.scene_schema import Scene

CATALOGUE = Path(__file__).parent / "catalogue"
MOST_TEXT = 2**26  # characters of a file: the longest lane has some millions


def names() -> tuple[str, ...]:
    """Names of the scenes that ship with softcradle, sorted."""
    return tuple(sorted(path.stem for path in CATALOGUE.glob("*.toml")))


def load(name_or_path: str | Path) -> Scene:
    """The scene of the catalogue by that name, or the scene in the file at that path.

    Raises:
        SceneError: there is no such scene or file, or the file is not a scene; one sentence for each problem.

    >>> load("one-on-four").lanes[0].velocity
    (1.0, 0.0, 0.0, 0.0, 0.0)
    """
    return parse(*_read(str(name_or_path)))


def text_of(name_or_path: str | Path) -> str:
    """The text of that scene's file, to start one's own scene from. Raises SceneError."""
    return _read(str(name_or_path))[0]


def parse(text: str, file: str = "scene") -> Scene:
    """The scene that the TOML `text` describes; errors call it `file`. Raises SceneError."""
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # of TOML, of digits or of brackets by the thousand
        raise SceneError([f"{file}: not valid TOML: {str(error)[:1].lower()}{str(error)[1:]}"]) from None
    try:
        return Scene.model_validate(table)
    except ValidationError as error:
        raise scene_error(file, error) from None


def _read(wanted: str) -> tuple[str, str]:
    """The text of the wanted scene, and the name of its file in errors."""
    shipped = CATALOGUE / f"{wanted}.toml"
    if wanted in names():
        return shipped.read_text(encoding="utf-8"), shipped.name
    if not wanted.endswith(".toml") and Path(wanted).name == wanted and not os.path.isfile(wanted):
        raise SceneError([_unknown(wanted)])
    try:
        return text_in(wanted), wanted
    except FileNotFoundError:
        raise SceneError([f"there is no file {wanted}"]) from None
    except UnicodeDecodeError:
        raise SceneError([f"{wanted}: not a text file in UTF-8"]) from None
    except OSError as error:
        raise SceneError([f"cannot read {wanted}: {(error.strerror or str(error)).lower()}"]) from None
    except ValueError:  # a name that no file can have
        raise SceneError([f"there is no file {wanted!r}"]) from None


def text_in(path: str) -> str:
    """The text of a file, which may be a pipe or have no end. Raises OSError, and ValueError where it is no text in UTF-8."""
    with open(path, encoding="utf-8-sig") as file:
        text = file.read(MOST_TEXT)
    if len(text) == MOST_TEXT:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG))
    return text


def _unknown(wanted: str) -> str:
    near = difflib.get_close_matches(wanted, names(), n=3, cutoff=0.5)
    hint = f"; did you mean {' or '.join(near)}?" if near else ""
    return f"there is no scene {wanted!r}{hint} (softcradle scenes lists them; a file of your own ends in .toml)"
