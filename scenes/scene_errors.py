"""What is wrong with a scene file, said in one sentence a problem: file, key, what is allowed, what it is instead."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import ValidationError
from pydantic_core import ErrorDetails

# pydantic speaks of Python, a scene file of TOML
PLAIN = {
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "string_type": "must be text in quotes",
    "tuple_type": "must be a list in [ ]",
    "model_type": "must be a table",
}


class SceneError(ValueError):
    """A scene that cannot be had. `problems` holds one sentence each; the message is the first of them."""

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__(problems[0])
        self.problems = tuple(problems)


def scene_error(file: str, error: ValidationError) -> SceneError:
    """The SceneError for what pydantic found in `file`."""
    return SceneError([f"{file}: {_sentence(detail)}" for detail in error.errors(include_url=False)])


def _sentence(detail: ErrorDetails) -> str:
    place, message = _place(detail["loc"]), detail["msg"]
    if detail["type"] == "missing":
        parent, _, key = place.rpartition(".")
        return f"{parent or 'the scene'}: key {key!r} is missing"
    if detail["type"] in ("scene", "value_error"):
        return f"{place}{': ' if place else ''}{message.removeprefix('Value error, ')}"
    demand = PLAIN.get(detail["type"]) or message.replace("Input should", "must").replace("String should", "must")
    return f"{place} {demand}, not {_shown(detail['input'])}"


def _place(location: tuple[int | str, ...]) -> str:
    """`lanes[0].contact.alpha`; the tags of alternatives, in brackets, are no keys of the file."""
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
