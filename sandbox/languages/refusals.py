"""Refusals of physics and scenes in the language in use: sentences that a typed number or a faulty file can meet."""

from __future__ import annotations

import re
from functools import lru_cache

from softcradle.sandbox.languages.translation import N_, gettext, localized
from softcradle.sandbox.user_error import GaveUpError

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
    N_("{path}: not a text file in UTF-8"),
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
