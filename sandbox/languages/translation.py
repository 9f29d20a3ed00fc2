"""Translation by gettext: messages in the language in use, with plural forms and with its form of numbers.

English is in use until :func:`use_language` is called, which only the window does: commands, files and pages stay English.
"""

from __future__ import annotations

import io
import os
import re
import string
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from gettext import NullTranslations

DOMAIN = "softcradle"
ENGLISH = "en"
VARIABLES = ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")  # the first one that is set counts, as for gettext


class Language(NamedTuple):
    """What a language calls itself, and the sign between the whole and the decimals of a number."""

    name: str
    decimal_mark: str


LANGUAGES = {
    ENGLISH: Language("English", "."),
    "de": Language("Deutsch", ","),
    "fr": Language("Français", ","),
}


class _Present:
    """The language in use, and its catalogue: None for English."""

    def __init__(self) -> None:
        self.code = ENGLISH
        self.catalogue: NullTranslations | None = None


_present = _Present()


def language() -> str:
    """The code of the language in use."""
    return _present.code


def use_language(code: str) -> None:
    """Use a language of LANGUAGES from now on."""
    _present.catalogue = None if code == ENGLISH else catalogue(code)
    _present.code = code


@contextmanager
def english() -> Iterator[None]:
    """English for a while: for files, which others read too."""
    code = language()
    use_language(ENGLISH)
    try:
        yield
    finally:
        use_language(code)


def catalogue_path(code: str) -> Path:
    """The file of the translations into a language."""
    return Path(__file__).parent / code / "LC_MESSAGES" / f"{DOMAIN}.po"


@lru_cache
def catalogue(code: str) -> NullTranslations:
    """The translations into a language, read from its .po file: no step of a build is between the two."""
    from gettext import GNUTranslations

    import polib

    return GNUTranslations(io.BytesIO(polib.pofile(str(catalogue_path(code))).to_binary()))


def language_of_environment(environment: Mapping[str, str] = os.environ) -> str:
    """The first language of the environment's locale that there is here; English where there is none."""
    wished = next((environment[name] for name in VARIABLES if environment.get(name)), "")
    codes = (one.partition(".")[0].partition("_")[0].lower() for one in wished.split(":"))
    return next((code for code in codes if code in LANGUAGES), ENGLISH)


def gettext(message: str, **values: object) -> str:
    """`message` in the language in use, with the `values` of its {names} filled in; floats take its decimal mark."""
    found = _present.catalogue.gettext(message) if _present.catalogue and message else message
    return _filled(found, values) if values else found


_ = gettext


def ngettext(one: str, many: str, n: int, **values: object) -> str:
    """The form of a message for the number `n`, which fills {n}."""
    usual = one if n == 1 else many
    return _filled(_present.catalogue.ngettext(one, many, n) if _present.catalogue else usual, {"n": n, **values})


def pgettext(context: str, message: str, **values: object) -> str:
    """`message` where its English has several meanings: `context` says which."""
    found = _present.catalogue.pgettext(context, message) if _present.catalogue else message
    return _filled(found, values) if values else found


def N_(message: str) -> str:  # noqa: N802 - gettext's own name for it
    """`message` as it is: marked for the catalogues, to be translated where it is shown."""
    return message


def NP_(context: str, message: str) -> str:  # noqa: N802 - likewise
    """`message` as it is: marked for the catalogues with its context, to be translated by :func:`pgettext`."""
    return message


def localized(number: str) -> str:
    """A number as text with the decimal mark of the language in use."""
    return number.replace(".", LANGUAGES[_present.code].decimal_mark)


class _Filler(string.Formatter):
    """str.format, but floats take the decimal mark of the language in use, and no scalar shows that it is NumPy's."""

    def convert_field(self, value: Any, conversion: str | None) -> Any:
        """The value as text where its form is asked for by !r."""
        if conversion == "r" and isinstance(value, float):
            return localized(float.__repr__(value))
        return super().convert_field(value, conversion)

    def format_field(self, value: Any, format_spec: str) -> str:
        """The text of one value."""
        text = format(value, format_spec)
        return localized(text) if isinstance(value, float) else text


_FILLER = _Filler()


def _filled(message: str, values: Mapping[str, object]) -> str:
    return _FILLER.vformat(message, (), values)


# Labels that sessions give to lanes after edits, and what they put after labels.
LABELS = (N_("draft gear"), N_("preloaded contact"), N_("mixed contacts"))
SUFFIXES = (N_(", edited"), N_(", the other"), N_(", compared"), N_(" ..."))
AND = N_(" and ")


def scene_words(text: str) -> str:
    """A title, text or source of a scene: translated where a catalogue has it, as those of the scenes that come with it."""
    words = " ".join(text.split())
    for suffix in SUFFIXES:
        if words.endswith(suffix):
            return scene_words(words.removesuffix(suffix)) + gettext(suffix)
    return gettext(words)


def label_words(label: str) -> str:
    """The label of a lane; one made by an edit part by part."""
    found = scene_words(label)
    if found == label and AND in label:
        return gettext(AND).join(map(label_words, label.split(AND)))
    return localized(found) if re.fullmatch(r"(Hooke, |Hertz, )?alpha = [\d.]+", found) else found
