"""Translation of messages with gettext. The translation includes plural forms, decimal marks and the messages of
validation errors.

The current language is English until :func:`use_language` is called. Only the window calls this function. Commands and
files are always in English. A page contains all languages.
"""

from __future__ import annotations

import io
import os
import string
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from softcradle.physics.extras import needed_for
from softcradle.physics.messages import Message, message_of
from softcradle.sandbox.user_error import GaveUpError

if TYPE_CHECKING:
    from gettext import NullTranslations

DOMAIN = "softcradle"
ENGLISH = "en"
Said = TypeVar("Said")
# Environment variables that select the locale. As in gettext, the first variable that is set is used.
VARIABLES = ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")


class Language(NamedTuple):
    """Language of the window. A language has a name, written in the language itself, and a decimal mark."""

    name: str
    decimal_mark: str


LANGUAGES = {ENGLISH: Language("English", "."), "de": Language("Deutsch", ","), "fr": Language("Français", ",")}


class _Present:
    """Current language and its catalogue of translations. The catalogue is None for English."""

    def __init__(self) -> None:
        self.code = ENGLISH
        self.catalogue: NullTranslations | None = None


_present = _Present()


def language() -> str:
    """Return the code of the current language."""
    return _present.code


def use_language(code: str) -> None:
    """Use the language with this `code` from now on. The code is a key of LANGUAGES."""
    _present.catalogue = None if code == ENGLISH else catalogue(code)
    _present.code = code


@contextmanager
def english() -> Iterator[None]:
    """Use English inside the block. English is needed for files that users of other languages also read."""
    code = language()
    use_language(ENGLISH)
    try:
        yield
    finally:
        use_language(code)


def in_every_language(say: Callable[[], Said]) -> dict[str, Said]:
    """Call `say` once in each language and return the results by language code. The languages are the keys of
    LANGUAGES.
    """
    before, found = language(), {}
    try:
        for code in LANGUAGES:
            use_language(code)
            found[code] = say()
    finally:
        use_language(before)
    return found


def catalogue_path(code: str) -> Path:
    """Return the path of the file with the translations into a language."""
    return Path(__file__).parent / code / "LC_MESSAGES" / f"{DOMAIN}.po"


def compiled_catalogue(code: str) -> Path | None:
    """Return the path of the compiled translations into a language, or None if the .po file was edited since then."""
    path = catalogue_path(code)
    compiled = path.with_suffix(".mo")
    outdated = path.exists() and compiled.exists() and path.stat().st_mtime > compiled.stat().st_mtime
    return compiled if compiled.exists() and not outdated else None


@lru_cache
def catalogue(code: str) -> NullTranslations:
    """Return the translations into a language.

    The installation compiles the .po files. If a .po file was edited since then, it is compiled here, and Babel must be
    installed.
    """
    from gettext import GNUTranslations

    compiled = compiled_catalogue(code)
    if compiled is not None:
        with compiled.open("rb") as file:
            return GNUTranslations(file)
    with needed_for("a checkout in another language than English", "dev"):
        from babel.messages.mofile import write_mo
        from babel.messages.pofile import read_po
    found = io.BytesIO()
    with catalogue_path(code).open("rb") as file:
        write_mo(found, read_po(file, locale=code))
    return GNUTranslations(io.BytesIO(found.getvalue()))


def language_of_environment(environment: Mapping[str, str] = os.environ) -> str:
    """Return the language that the environment variables select. The result is the first available language of the
    locale. The default is English.
    """
    wished = next((environment[name] for name in VARIABLES if environment.get(name)), "")
    codes = (one.partition(".")[0].partition("_")[0].lower() for one in wished.split(":"))
    return next((code for code in codes if code in LANGUAGES), ENGLISH)


def gettext(message: str, **values: object) -> str:
    """Return `message` in the current language. Each name in braces is replaced by the value with this name in
    `values`. Floats are written with the decimal mark of the language.
    """
    found = _present.catalogue.gettext(message) if _present.catalogue and message else message
    return _filled(found, values) if values else found


_ = gettext


def ngettext(one: str, many: str, n: int, /, **values: object) -> str:
    """Return the singular or plural form of a message for the number `n`. The number replaces {n}, unless `values`
    contains another value of n.
    """
    usual = one if n == 1 else many
    return _filled(_present.catalogue.ngettext(one, many, n) if _present.catalogue else usual, {"n": n, **values})


def pgettext(context: str, message: str, **values: object) -> str:
    """Return the translation of a `message` whose English text has several meanings. `context` selects one meaning."""
    found = _present.catalogue.pgettext(context, message) if _present.catalogue else message
    return _filled(found, values) if values else found


def N_(message: str) -> str:  # noqa: N802 - gettext's own name for it
    """Return `message` unchanged. The call marks the message for the catalogues. The message is translated when it is
    shown.
    """
    return message


def NP_(context: str, message: str) -> str:  # noqa: N802 - likewise
    """Return `message` unchanged. The call marks the message and its context for the catalogues. :func:`pgettext`
    translates it later.
    """
    return message


def localized(number: str) -> str:
    """Return `number` with the decimal mark of the current language. `number` is a number as text."""
    return number.replace(".", LANGUAGES[_present.code].decimal_mark)


class _Filler(string.Formatter):
    """Formatter that works like str.format. The formatter writes floats with the decimal mark of the current language,
    and NumPy scalars as plain numbers.
    """

    def convert_field(self, value: Any, conversion: str | None) -> Any:
        """Return the value as text if the format string contains the conversion !r."""
        if conversion == "r" and isinstance(value, float):
            return localized(float.__repr__(value))
        return super().convert_field(value, conversion)

    def format_field(self, value: Any, format_spec: str) -> str:
        """Return the text of one value in the current language."""
        text = format(value, format_spec)
        return localized(text) if isinstance(value, float) else text


_FILLER = _Filler()


def _filled(message: str, values: Mapping[str, object]) -> str:
    return _FILLER.vformat(message, (), values)


def scene_words(text: str) -> str:
    """Return the translation of a title, text, source or label of a scene. If the catalogue does not contain the text,
    return it unchanged.
    """
    words = " ".join(text.split())
    return message_words(text) if isinstance(text, Message) else gettext(words)


GAVE_UP = N_("the method gave up before the end: take another one, a larger step or a looser tolerance")


def error_words(error: BaseException) -> str:
    """Return the message of an error in the current language. If a simulation gave up, return advice instead."""
    return gettext(GAVE_UP) if isinstance(error, GaveUpError) else message_words(message_of(error))


def message_words(text: str) -> str:
    """Return a Message in the current language. Return any other text unchanged."""
    if not isinstance(text, Message):
        return text
    return gettext(text.template, **{name: _value_words(name, value) for name, value in text.values.items()})


def _value_words(name: str, value: object) -> object:
    """Return a value that is inserted into a message. If the value is a message, a noun (`what`) or the `label` of a lane,
    translate it.
    """
    if isinstance(value, Message):
        return message_words(value)
    return gettext(value) if name in ("what", "label") and isinstance(value, str) else value
