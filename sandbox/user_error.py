"""UserError and its subclasses. A user of the command sees only UserErrors. Each one contains one sentence that helps
to correct the input, and is printed without a traceback.
"""

import difflib
from collections.abc import Iterable, Mapping, Sequence
from typing import TypeVar

Named = TypeVar("Named")

MISTAKE = 2  # Exit code if the request of the user is invalid or impossible.
# Exit code if a simulation gave up before its end. The printed and written results do not cover the complete motion.
GAVE_UP = 3
# Exit code if a sweep is complete but some points are lost, because every process that computed them died.
POINTS_LOST = 4
HUNG_UP = 129  # Exit code if the terminal was closed.
INTERRUPTED = 130
CLOSED_PIPE = 141
TERMINATED = 143


class UserError(Exception):
    """Error with one sentence for the user. The command prints ``softcradle: sentence`` on standard error and exits
    with the code 2.
    """


class GaveUpError(UserError):
    """Error of a simulation that gave up before its end. A complete result cannot be written. The command exits with
    the code 3.
    """


class StudyError(UserError, ValueError):
    """Error in the definition of a sweep. In Python code, it can also be caught as a ValueError."""


def unknown(kind: str, word: str, known: Iterable[str]) -> UserError:
    """Return the error for an unknown name. The message of the error contains the most similar known name."""
    names = list(known)
    near = difflib.get_close_matches(word, names, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return UserError(f"there is no {kind} {word!r}; {hint}there are {', '.join(names)}")


def named(kind: str, wanted: Sequence[str], known: Mapping[str, Named]) -> list[Named]:
    """Return the items of `known` with the names `wanted`. Each item is returned once. If no name is given, return all
    items. Raise UserError if a name is unknown.
    """
    wrong = next((name for name in wanted if name not in known), None)
    if wrong is not None:
        raise unknown(kind, wrong, known)
    return [known[name] for name in dict.fromkeys(wanted)] if wanted else list(known.values())


def reason(error: OSError) -> str:
    """Return the error message of the operating system in lower case."""
    return (error.strerror or str(error)).lower()
