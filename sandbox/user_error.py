"""UserError, the only exception that a user sees: one sentence that helps to correct the input, without a traceback."""

import difflib
from collections.abc import Iterable, Mapping, Sequence
from typing import TypeVar

Named = TypeVar("Named")

MISTAKE = 2  # The request of the user is invalid or impossible.
GAVE_UP = 3  # A run gave up before its end, so the printed and written results do not cover the whole motion.
POINTS_LOST = 4  # A sweep is complete, but at some points every process died.
HUNG_UP = 129  # The terminal was closed.
INTERRUPTED = 130
CLOSED_PIPE = 141
TERMINATED = 143


class UserError(Exception):
    """Error with one sentence for the user. The command prints ``softcradle: sentence`` on stderr and exits with code
    2.
    """


class GaveUpError(UserError):
    """Error for a run that gave up before its end, so that no complete result can be written. The command exits with
    code 3.
    """


class StudyError(UserError, ValueError):
    """Error in the definition of a sweep. In Python it is also a ValueError."""


def unknown(kind: str, word: str, known: Iterable[str]) -> UserError:
    """Return the error for an unknown name, with the closest known name."""
    names = list(known)
    near = difflib.get_close_matches(word, names, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return UserError(f"there is no {kind} {word!r}; {hint}there are {', '.join(names)}")


def named(kind: str, wanted: Sequence[str], known: Mapping[str, Named]) -> list[Named]:
    """Return the items of `known` with the `wanted` names, each once; all items if no name is given. Raise UserError."""
    wrong = next((name for name in wanted if name not in known), None)
    if wrong is not None:
        raise unknown(kind, wrong, known)
    return [known[name] for name in dict.fromkeys(wanted)] if wanted else list(known.values())


def reason(error: OSError) -> str:
    """Return the message of the operating system in lower case."""
    return (error.strerror or str(error)).lower()
