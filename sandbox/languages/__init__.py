"""The languages of the window: English in the code, the others in a catalogue each, LC_MESSAGES/softcradle.po."""

from softcradle.sandbox.languages.refusals import error_words, refusal_words
from softcradle.sandbox.languages.translation import (
    ENGLISH,
    LANGUAGES,
    N_,
    NP_,
    VARIABLES,
    Language,
    _,
    english,
    gettext,
    label_words,
    language,
    language_of_environment,
    localized,
    ngettext,
    pgettext,
    scene_words,
    use_language,
)

__all__ = [
    "ENGLISH",
    "LANGUAGES",
    "NP_",
    "N_",
    "VARIABLES",
    "Language",
    "_",
    "english",
    "error_words",
    "gettext",
    "label_words",
    "language",
    "language_of_environment",
    "localized",
    "ngettext",
    "pgettext",
    "refusal_words",
    "scene_words",
    "use_language",
]
