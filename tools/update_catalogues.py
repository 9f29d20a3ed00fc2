"""Update the message catalogues from the code, scenes and lessons: python -m tools.update_catalogues.

The tool requires Babel (`pip install softcradle[dev]`). Existing translations are kept. New messages are added without
a translation, and are shown in English until somebody translates them. Removed messages are dropped. A missing
catalogue is created for each code in LANGUAGES. With --complete, a missing translation is an error. This option is used
before a release.
"""

from __future__ import annotations

import io
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from softcradle.sandbox.languages.translation import DOMAIN, ENGLISH, LANGUAGES, catalogue_path

if TYPE_CHECKING:
    from babel.messages import Catalog, Message

# Functions whose arguments are messages, in the format of Babel. The message of an error is the argument after its
# code.
KEYWORDS = {"_": None, "gettext": None, "N_": None, "ngettext": (1, 2), "pgettext": ((1, "c"), 2), "NP_": ((1, "c"), 2)}
KEYWORDS |= {"Message": (2,), "InputError": (2,)}
WIDTH = 120  # Maximum length of a line in a catalogue.
# Header lines that are left out, because they change with each update or contain no name.
DATED = (
    b'"POT-Creation-Date',
    b'"PO-Revision-Date',
    b'"Report-Msgid',
    b'"Last-Tr',
    b'"Language-Team',
    b'"Generated-By',
)
ROOT = Path(__file__).parents[1]
# Folders that contain messages. This order keeps the entries of a folder together.
FOLDERS = ("sandbox", "scenes", "physics")
# A found message consists of the message (and its plural), the file and the context.
Found = tuple[str | tuple[str, str], str, str | None]


def messages() -> Iterator[Found]:
    """Yield every message of the code, the scenes and the lessons, and the summaries of methods."""
    yield from _of_code()
    yield from _of_scenes()
    lessons = ROOT / "sandbox" / "window" / "lessons" / "lessons.toml"
    for lesson in tomllib.loads(lessons.read_text(encoding="utf-8"))["lesson"]:
        for text in (lesson["question"], *lesson["choices"], *lesson["why"]):
            yield text, _name(lessons), None
    from softcradle.physics import METHODS

    for method in METHODS:
        yield method.summary, "physics/methods.py", None


def _of_code() -> Iterator[Found]:
    from babel.messages.extract import extract_from_file

    for path in (path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.py"))):
        for _line, message, _comments, context in extract_from_file("python", str(path), keywords=KEYWORDS):
            yield message if isinstance(message, str) else (message[0], message[1]), _name(path), context


def _of_scenes() -> Iterator[Found]:
    from softcradle.scenes import load, names

    for name in names():
        scene = load(name)
        for text in (scene.title, scene.question, scene.text, scene.source, *(lane.label for lane in scene.lanes)):
            if text:
                yield " ".join(text.split()), f"scenes/catalogue/{name}.toml", None


def _name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def template() -> Catalog:
    """Return a catalogue of all messages without translations."""
    from babel.messages import Catalog

    found = Catalog(domain=DOMAIN, project=DOMAIN, charset="utf-8", fuzzy=False)
    for message, file, context in messages():
        found.add(message, locations=[(file, 1)], context=context)
    return found


def read_catalogue(code: str) -> Catalog:
    """Return the catalogue of a language as Babel reads it. The catalogue is empty if the file does not exist."""
    from babel.messages import Catalog
    from babel.messages.pofile import read_po

    path = catalogue_path(code)
    if not path.exists():
        return Catalog(locale=code, domain=DOMAIN, project=DOMAIN, fuzzy=False)
    with path.open("rb") as file:
        return read_po(file, locale=code, domain=DOMAIN)


def written(catalogue: Catalog) -> bytes:
    """Return the text of a catalogue.

    The text contains file names without line numbers. The text therefore changes only if messages change.
    """
    from babel.messages.pofile import write_po

    text = io.BytesIO()
    catalogue.header_comment = f"# Messages of softcradle in {LANGUAGES[str(catalogue.locale)].name}."
    write_po(text, catalogue, width=WIDTH, include_lineno=False, ignore_obsolete=True)
    lines = text.getvalue().splitlines(keepends=True)
    return b"".join(line for line in lines if not line.startswith(DATED)).lstrip()


def update(code: str) -> int:
    """Update the catalogue of a language. Return the number of missing translations."""
    catalogue = read_catalogue(code)
    found = template()
    catalogue.update(found, no_fuzzy_matching=True)
    path = catalogue_path(code)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(written(catalogue))
    return sum(not is_translated(message) for message in catalogue if message.id)


def is_translated(message: Message) -> bool:
    """Return True if a message is translated in each of its plural forms."""
    forms = [message.string] if isinstance(message.string, str) else list(message.string or [""])
    return all(forms)


def main(arguments: list[str] | None = None) -> int:
    """Update all catalogues, and print the number of missing translations. With --complete, fail if a translation is
    missing.
    """
    waiting = {code: update(code) for code in LANGUAGES if code != ENGLISH}
    for code, count in waiting.items():
        print(f"{catalogue_path(code)}: {count} messages wait for {LANGUAGES[code].name}")
    return int("--complete" in (sys.argv[1:] if arguments is None else arguments) and any(waiting.values()))


if __name__ == "__main__":
    raise SystemExit(main())
