"""Sections of the gallery: which scenes are shown together, and which ones a search finds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from softcradle.sandbox.languages import N_
from softcradle.sandbox.window.hanging.page import HANGING_NAME


class Section(NamedTuple):
    """A title and the names of scenes below it."""

    title: str
    names: tuple[str, ...]


SECTIONS = (
    Section(N_("Start here"), ("hertz-cradle", "one-on-four", "steel-and-soft", "train-shunting")),
    Section(
        N_("The paper"),
        (
            *("one-on-four-softer", "one-on-ten", "two-on-two", "three-on-five", "galilean", "mixed"),
            *("hooke-interface", "weak-contact", "prestressed", "driven-cluster", "stiff-springs"),
            *("experiment-one-on-three", "experiment-two-on-two"),
        ),
    ),
    Section(
        N_("Draft gears"), ("draft-gear-one-on-three", "locked-pistons", "beads-against-gear", "draft-gear-two-on-two")
    ),
    Section(N_("Cradles"), (HANGING_NAME, "hooke-cradle")),
    Section(N_("Trains"), ("train-solid", "train-cut", "train-starting", "train-braking")),
)
REST = N_("More")  # title above scenes that no section names
MINE = N_("My scenes")  # title above files that were opened or saved last
FOUND = N_("Found")  # title above what a search has found


def sections_of(names: Sequence[str], mine: Sequence[str] = ()) -> list[Section]:
    """The sections of those scenes, files of one's `mine` after the first; scenes of none come last."""
    listed = {name for section in SECTIONS for name in section.names} | set(mine)
    rest = Section(REST, tuple(name for name in names if name not in listed))
    order = (SECTIONS[0], Section(MINE, tuple(mine)), *SECTIONS[1:], rest)
    chosen = [Section(title, tuple(name for name in own if name in names)) for title, own in order]
    return [section for section in chosen if section.names]


def found(captions: Mapping[str, Sequence[str]], search: str) -> list[str]:
    """Names of the scenes whose captions, the title first, contain every word of the search; those in whose title they all
    are come first, then those with words that begin so."""
    words = search.lower().split()

    def rank(name: str) -> tuple[bool, bool]:
        title, text = captions[name][0].lower(), " ".join(captions[name]).lower()
        return not all(word in title for word in words), not all(f" {word}" in f" {text}" for word in words)

    texts = {name: f"{name} {' '.join(caption)}".lower() for name, caption in captions.items()}
    return sorted((name for name, text in texts.items() if all(word in text for word in words)), key=rank)
