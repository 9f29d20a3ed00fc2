"""UserError, the one exception that a user sees: a sentence about what to change, without a traceback."""

import difflib
from collections.abc import Iterable, Mapping, Sequence
from typing import TypeVar

Named = TypeVar("Named")

MISTAKE = 2  # what the user asked for cannot be done
GAVE_UP = 3  # a run gave up before its end: what was printed and written is not the whole motion
POINTS_LOST = 4  # a sweep is done, but at some of its points every process died
HUNG_UP = 129  # the terminal was closed
INTERRUPTED = 130
CLOSED_PIPE = 141
TERMINATED = 143


class UserError(Exception):
    """One sentence for the user; the command prints it as ``softcradle: sentence`` on stderr and exits with code 2."""


class GaveUpError(UserError):
    """A run gave up before its end, so that there is nothing whole to write; the command exits with code 3."""


class StudyError(UserError, ValueError):
    """What is wrong with a sweep that was asked for; in Python it is a ValueError."""


def unknown(kind: str, word: str, known: Iterable[str]) -> UserError:
    """The refusal of a name that nothing has."""
    names = list(known)
    near = difflib.get_close_matches(word, names, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return UserError(f"there is no {kind} {word!r}; {hint}there are {', '.join(names)}")


def named(kind: str, wanted: Sequence[str], known: Mapping[str, Named]) -> list[Named]:
    """Those of the `known` that are wanted by name, each once, all for none. Raises UserError."""
    wrong = next((name for name in wanted if name not in known), None)
    if wrong is not None:
        raise unknown(kind, wrong, known)
    return [known[name] for name in dict.fromkeys(wanted)] if wanted else list(known.values())


def reason(error: OSError) -> str:
    """Why the system refused, in its own words."""
    return (error.strerror or str(error)).lower()
