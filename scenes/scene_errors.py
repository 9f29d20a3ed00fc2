"""Problems of a scene file as sentences, each with the file, the key, the allowed values and the actual value."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import ValidationError
from pydantic_core import ErrorDetails

# Requirements for pydantic's types of errors, in terms of TOML. The messages of pydantic use terms of Python.
DEMANDS = {
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "string_type": "must be text in quotes",
    "tuple_type": "must be a list in [ ]",
    "model_type": "must be a table",
    "too_short": "must not be empty",
}


class SceneError(ValueError):
    """Error for a missing or invalid scene. `problems` contains one sentence for each problem; the message is the first
    one.
    """

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__(problems[0])
        self.problems = tuple(problems)

    def __reduce__(self) -> tuple[type[SceneError], tuple[tuple[str, ...]]]:
        """Return the problems, from which pickle rebuilds the error in another process."""
        return type(self), (self.problems,)


def scene_error(file: str, error: ValidationError) -> SceneError:
    """Return a SceneError with the problems that pydantic found in `file`."""
    return SceneError([f"{file}: {_sentence(detail)}" for detail in error.errors(include_url=False)])


def _sentence(detail: ErrorDetails) -> str:
    place, message = _place(detail["loc"]), detail["msg"]
    if detail["type"] == "missing":
        parent, _, key = place.rpartition(".")
        return f"{parent or 'the scene'}: key {key!r} is missing"
    if detail["type"] in ("scene", "value_error"):
        sentence = message.removeprefix("Value error, ")
        parent, _, key = place.rpartition(".")
        if sentence.startswith(f"{key} must be "):  # The sentence already contains the key.
            place = parent
        return f"{place}{': ' if place else ''}{sentence}"
    demand = DEMANDS.get(detail["type"]) or message.replace("Input should", "must").replace("String should", "must")
    return f"{place} {demand}, not {_shown(detail['input'])}"


def _place(location: tuple[int | str, ...]) -> str:
    """Return a place in the file such as `lanes[0].contact.alpha`. Tags of alternatives, in brackets, are not keys of
    the file.
    """
    path = ""
    for part in location:
        if isinstance(part, int):
            path += f"[{part}]"
        elif not part.startswith("("):
            path += f".{part}" if path else part
    return path


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
