"""Words of scenes in the language in use: titles and texts of scene files, and labels of lanes, those made by edits too."""

from __future__ import annotations

import re

from softcradle.sandbox.languages.translation import N_, gettext, localized

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
