"""The base of all tables in a scene file, which refuses unknown keys, and its types of numbers, fractions such as "1/14" too."""

import difflib
import math
import re
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, TypeVar

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Strict,
    Tag,
    ValidationInfo,
    model_validator,
)
from pydantic_core import PydanticCustomError

Item = TypeVar("Item")
FRACTION = re.compile(r"\s*(\d{1,9})\s*/\s*(\d{1,9})\s*")


class Table(BaseModel):
    """An immutable table of a scene file. An unknown key is refused with the keys that are allowed."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, validate_default=False)

    @model_validator(mode="before")
    @classmethod
    def _refuse_unknown_keys(cls, value: Any) -> Any:
        if isinstance(value, Mapping):
            for key in value:
                if key not in cls.model_fields:
                    raise problem(f"unknown key {key!r}{suggestion(str(key), cls.model_fields)}")
        return value


def problem(sentence: str) -> PydanticCustomError:
    """A refusal; `sentence` is completed by the place in the file."""
    return PydanticCustomError("scene", "{sentence}", {"sentence": sentence})


def suggestion(word: str, allowed: Iterable[str]) -> str:
    """The end of a refusal of `word`: the allowed word nearest to it, then all allowed words."""
    words = list(allowed)
    near = difflib.get_close_matches(word, words, n=1)
    return (f" (did you mean {near[0]!r}?)" if near else "") + f"; allowed: {', '.join(words)}"


def _fraction(value: Any) -> Any:
    match = FRACTION.fullmatch(value) if isinstance(value, str) else None
    if match is None:
        return value
    if int(match[2]) == 0:
        raise problem(f"must not divide by zero, not {value!r}")
    return int(match[1]) / int(match[2])


def _wall(value: Any, info: ValidationInfo) -> Any:
    """JSON has no infinity: there null is the mass of a wall."""
    return math.inf if value is None and info.mode == "json" else value


# One value for all, or a list. Tags in brackets are left out of the place in the file by softcradle.scenes.scene_errors.
OneOrMany = Annotated[
    Annotated[Item, Tag("(one)")] | Annotated[tuple[Item, ...], Tag("(many)")],
    Discriminator(lambda value: "(many)" if isinstance(value, list | tuple) else "(one)"),
]

# Validators before a number run from right to left, and a constraint follows the type that it constrains: the fraction is last.
Number = Annotated[float, Strict(), BeforeValidator(_fraction)]
Positive = Annotated[float, Strict(), Field(gt=0), BeforeValidator(_fraction)]
NotNegative = Annotated[float, Strict(), Field(ge=0), BeforeValidator(_fraction)]
Loss = Annotated[float, Strict(), Field(ge=0, lt=1), BeforeValidator(_fraction)]
AtLeastOne = Annotated[float, Strict(), Field(ge=1), BeforeValidator(_fraction)]
Mass = Annotated[float, Strict(), Field(gt=0, allow_inf_nan=True), BeforeValidator(_fraction), BeforeValidator(_wall)]
