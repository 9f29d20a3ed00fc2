"""Error messages about problems in a scene file.

Each message contains the file, the key, the allowed values and the actual value.
"""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import ValidationError
from pydantic_core import ErrorDetails
from softcradle.physics.checked_input import shown
from softcradle.physics.messages import N_, Message, message_of

# Messages that replace those of pydantic, by type of error. The messages use terms of TOML instead of Python.
DEMANDS = {
    "float_type": ("must_be_number", N_("{place} must be a number, not {given}")),
    "int_type": ("must_be_whole", N_("{place} must be a whole number, not {given}")),
    "bool_type": ("must_be_bool", N_("{place} must be true or false, not {given}")),
    "string_type": ("must_be_text", N_("{place} must be text in quotes, not {given}")),
    "tuple_type": ("must_be_list", N_("{place} must be a list in [ ], not {given}")),
    "model_type": ("must_be_table", N_("{place} must be a table, not {given}")),
    "string_too_short": ("must_not_be_empty", N_("{place} must not be empty")),
    "too_short": ("must_not_be_empty", N_("{place} must not be empty")),
    "finite_number": ("must_be_finite", N_("{place} must be a finite number, not {given}")),
    "greater_than": ("must_be_greater", N_("{place} must be greater than {gt:g}, not {given}")),
    "greater_than_equal": ("must_be_at_least", N_("{place} must be greater than or equal to {ge:g}, not {given}")),
    "less_than": ("must_be_less", N_("{place} must be less than {lt:g}, not {given}")),
    "less_than_equal": ("must_be_at_most", N_("{place} must be less than or equal to {le:g}, not {given}")),
}


WHOLE = Message("whole_scene", "the scene")  # Place in messages about a problem that concerns a whole scene.


class SceneError(ValueError):
    """Error for a missing or invalid scene.

    `problems` contains one message for each problem. The text of the error is the first message.
    """

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__(problems[0])
        self.problems = tuple(problems)

    def __reduce__(self) -> tuple[type[SceneError], tuple[tuple[str, ...]]]:
        """Return the problems for pickle, which creates the error again in another process."""
        return type(self), (self.problems,)


def at(place: str, problem: str) -> Message:
    """Return the message of a problem together with its place: a file or a key."""
    return Message("at", "{place}: {problem}", place=place, problem=problem)


def scene_error(file: str, error: ValidationError, whole: str = WHOLE) -> SceneError:
    """Return a SceneError with the problems that pydantic found in `file`.

    `whole` is the place that a message names if its problem concerns the whole file.
    """
    return SceneError([at(file, _sentence(detail, whole)) for detail in error.errors(include_url=False)])


def _sentence(detail: ErrorDetails, whole: str) -> str:
    place, context = _place(detail["loc"]), detail.get("ctx", {})
    parent, _, key = place.rpartition(".")
    if detail["type"] == "missing":
        missing = Message("missing_key", "key {key!r} is missing", key=key)
        parent = parent or whole
        return at(parent, missing) if parent else missing
    if detail["type"] in ("scene", "value_error"):
        sentence = context["sentence"] if detail["type"] == "scene" else message_of(context["error"])
        # The sentence already contains the key.
        if isinstance(sentence, Message) and sentence.values.get("what") == key:
            place = parent
        return at(place, sentence) if place else sentence
    if detail["type"] not in DEMANDS:  # Use pydantic's own message, which is in English.
        return at(place, detail["msg"]) if place else detail["msg"]
    code, template = DEMANDS[detail["type"]]
    return Message(code, template, place=place, given=shown(detail["input"]), **context)


def _place(location: tuple[int | str, ...]) -> str:
    """Return the text of a place in the file, such as `lanes[0].contact.alpha`.

    pydantic marks alternatives by tags in brackets. The tags are left out, because they are not keys of the file.
    """
    path = ""
    for part in location:
        if isinstance(part, int):
            path += f"[{part}]"
        elif not part.startswith("("):
            path += f".{part}" if path else part
    return path
