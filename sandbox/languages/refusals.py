"""Refusals of the physics in the language in use: the sentences that numbers typed into the window can meet."""

from __future__ import annotations

import re
from functools import lru_cache

from softcradle.sandbox.languages.translation import N_, gettext, localized

# The physics knows no language and fills its sentences itself: here they are told by their words.
REFUSALS = (
    N_("contact exponent must be from {least} to {most}, not {given}; its limit 0 is step_force(f0)"),
    N_("contact preload and stiffness are both 0: the contact would never push"),
    N_("contact loss must be >= 0 and below 1, not {given}: at 1 it would never come out again"),
    N_("{what} must be a finite number {sign} 0, not {given}"),
    N_("{what} must be from {least} to {most}, not {given}: choose other units"),
    N_("two walls side by side: a contact between them could never be solved"),
)
WHAT = (N_("contact preload"), N_("contact stiffness"), N_("every mass (inf is a wall)"))


def refusal_words(text: str) -> str:
    """`text`, translated where it is one of the sentences."""
    for sentence in REFUSALS:
        found = _pattern(sentence).fullmatch(text)
        if found is not None:
            return gettext(sentence, **{name: _value(value) for name, value in found.groupdict().items()})
    return text


@lru_cache
def _pattern(sentence: str) -> re.Pattern[str]:
    parts = re.split(r"\\{(\w+)\\}", re.escape(sentence))
    return re.compile("".join(f"(?P<{part}>.+?)" if k % 2 else part for k, part in enumerate(parts)))


def _value(text: str) -> str:
    return localized(text) if re.fullmatch(r"-?[\d.]+(e[-+]?\d+)?", text) else gettext(text)
