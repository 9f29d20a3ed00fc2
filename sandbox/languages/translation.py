"""Translation by gettext: messages in the language in use, with plural forms and with its form of numbers; refusals.

English is in use until :func:`use_language` is called, which only the window does: commands and files stay English,
and a page has every language.
"""

from __future__ import annotations

import io
import os
import re
import string
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from softcradle.sandbox.user_error import GaveUpError

if TYPE_CHECKING:
    from gettext import NullTranslations

DOMAIN = "softcradle"
ENGLISH = "en"
Said = TypeVar("Said")
VARIABLES = ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")  # the first one that is set counts, as for gettext


class Language(NamedTuple):
    """What a language calls itself, and the sign between the whole and the decimals of a number."""

    name: str
    decimal_mark: str


LANGUAGES = {ENGLISH: Language("English", "."), "de": Language("Deutsch", ","), "fr": Language("Français", ",")}


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


def in_every_language(say: Callable[[], Said]) -> dict[str, Said]:
    """What `say` says in each of LANGUAGES, by its code."""
    before, found = language(), {}
    try:
        for code in LANGUAGES:
            use_language(code)
            found[code] = say()
    finally:
        use_language(before)
    return found


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
    """The label of a lane; that of several contacts, which an edit has made, part by part."""
    parts = [_law_words(part) for part in label.split(AND)]
    return scene_words(label) if None in parts else gettext(AND).join(filter(None, parts))


def _law_words(text: str) -> str | None:
    """What a contact is called, None where `text` is no name of one."""
    found = scene_words(text)
    if re.fullmatch(r"(Hooke, |Hertz, )?alpha = [\d./]+[^\d.]*", found):
        return localized(found)
    return found if found != text else None


# Physics and scenes know no language and fill their sentences themselves: here they are told by their words.
# The first that fits is taken, so a special one stands before a general one. {least}, {most} and {given} are numbers.
REFUSALS = (
    N_("contact exponent must be from {least} to {most}, not {given}; its limit 0 is step_force(f0)"),
    N_("contact preload and stiffness are both 0: the contact would never push"),
    N_("contact loss must be >= 0 and below 1, not {given}: at 1 it would never come out again"),
    N_("{what} must be a finite number {sign} 0, not {given}"),
    N_("{what} must be from {least} to {most}, not {given}: choose other units"),
    N_("two walls side by side: a contact between them could never be solved"),
    N_("there is no file {path}"),
    N_("{path}: not a text file in UTF-8: save it as UTF-8 ({detail})"),
    N_("cannot read {path}: {error}"),
    N_(
        "there is no scene {name}; did you mean {near}? (softcradle scenes lists them; a file of your own ends in .toml)"
    ),
    N_("there is no scene {name} (softcradle scenes lists them; a file of your own ends in .toml)"),
    N_("{path}: not valid TOML: {error}"),
    N_("{path}: the scene: key {key} is missing"),
    N_("{place}: key {key} is missing"),
    N_("{place} must be a number, not {value}"),
    N_("{place} must be a whole number, not {value}"),
    N_("{place} must be true or false, not {value}"),
    N_("{place} must be text in quotes, not {value}"),
    N_("{place} must be a list in [ ], not {value}"),
    N_("{place} must be a table, not {value}"),
)
WHAT = (N_("contact preload"), N_("contact stiffness"), N_("every mass (inf is a wall)"))
NUMBERS = ("least", "most", "given")
GAVE_UP = N_("the method gave up before the end: take another one, a larger step or a looser tolerance")


def error_words(error: object) -> str:
    """What an error says, in the language in use where its sentence is known there; a run that gave up says what helps."""
    return gettext(GAVE_UP) if isinstance(error, GaveUpError) else refusal_words(str(error))


def refusal_words(text: str) -> str:
    """`text`, translated where it is one of the sentences."""
    for sentence in REFUSALS:
        found = _pattern(sentence).fullmatch(text)
        if found is not None:
            return gettext(sentence, **{name: _value(name, value) for name, value in found.groupdict().items()})
    return text


@lru_cache
def _pattern(sentence: str) -> re.Pattern[str]:
    parts = re.split(r"\\{(\w+)\\}", re.escape(sentence))
    return re.compile("".join(f"(?P<{part}>.+?)" if k % 2 else part for k, part in enumerate(parts)), re.DOTALL)


def _value(name: str, text: str) -> str:
    """What is filled in: a number with its mark, a name of WHAT translated, else as it is."""
    if name in NUMBERS and re.fullmatch(r"-?[\d.]+(e[-+]?\d+)?", text):
        return localized(text)
    return gettext(text) if text in WHAT else text
