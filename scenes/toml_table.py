"""Base class of all tables in a scene file, and types for their numbers, which can be fractions such as "1/14"."""

import difflib
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Annotated, Any, Self, TypeVar

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    ModelWrapValidatorHandler,
    Strict,
    Tag,
    ValidationError,
    ValidationInfo,
    model_validator,
)
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError
from softcradle.physics.messages import Message
from softcradle.scenes.other_names import remedy_of

Item = TypeVar("Item")
FRACTION = re.compile(r"\s*(\d{1,9})\s*/\s*(\d{1,9})\s*")


class Table(BaseModel):
    """Immutable table of a scene file. All problems of a table are reported, not only the first one."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, validate_default=False)

    @classmethod
    def mistakes(cls, table: dict[str, Any]) -> Iterator[str]:
        """Yield a sentence for each mistake that is found before the values are checked.

        The mistake is corrected or removed in `table`. If a key is misspelt and its intended name is clear, the value
        is stored under this name. The value is then checked as well.
        """
        for key in list(table):
            if key not in cls.model_fields:
                sentence, meant = unknown_key(key, table, cls.model_fields, cls.keys_elsewhere())
                value = table.pop(key)
                if meant is not None:
                    table.setdefault(meant, value)
                yield sentence

    @classmethod
    def keys_elsewhere(cls) -> Mapping[str, str]:
        """Return the keys that belong to another table of the file. For each key, a Message describes where to write
        it.
        """
        return {}

    @model_validator(mode="wrap")
    @classmethod
    def _report_all(cls, value: Any, check: ModelWrapValidatorHandler[Self]) -> Self:
        if not isinstance(value, Mapping):
            return check(value)
        table = dict(value)
        found = [sentence_details(sentence, value) for sentence in cls.mistakes(table)]
        try:
            checked = check(table)
        except ValidationError as error:
            found += [details_again(detail) for detail in error.errors(include_url=False)]
        if found:
            raise ValidationError.from_exception_data(cls.__name__, found)
        return checked


def sentence_details(sentence: str, value: Any) -> InitErrorDetails:
    """Return the sentence of a problem in the form that pydantic uses to collect problems."""
    return InitErrorDetails(type=problem(sentence), loc=(), input=value)


def details_again(detail: ErrorDetails) -> InitErrorDetails:
    """Convert a problem that pydantic reported to a form that can be raised again."""
    kind: str | PydanticCustomError = detail["type"]
    if kind == "scene":
        kind = problem(detail["ctx"]["sentence"])
    return InitErrorDetails(type=kind, loc=detail["loc"], input=detail["input"], ctx=detail.get("ctx", {}))


def raise_problems(title: str, sentences: Iterable[str], value: Any) -> None:
    """Raise a ValidationError with all different sentences. Do nothing if `sentences` is empty."""
    found = [sentence_details(sentence, value) for sentence in dict.fromkeys(sentences)]
    if found:
        raise ValidationError.from_exception_data(title, found)


def unknown_key(
    key: str, table: Mapping[str, Any], allowed: Iterable[str], elsewhere: Mapping[str, str]
) -> tuple[str, str | None]:
    """Return a sentence about an unknown key of the table.

    Also return the key that was probably meant, or None.
    """
    if key in elsewhere:
        return Message("misplaced_key", "key {key!r} belongs {place}", key=key, place=elsewhere[key]), None
    words = list(allowed)
    remedy = remedy_of(key, table, words)
    if remedy is not None:
        remedied = Message("remedied_key", "unknown key {key!r}: {remedy}", key=key, remedy=remedy.sentence)
        return remedied, remedy.meant
    near = difflib.get_close_matches(key, words, n=1)
    sentence = Message("key", "unknown key {key!r}{suggestion}", key=key, suggestion=suggestion(key, words))
    return sentence, near[0] if near and near[0] not in table else None


def problem(sentence: str) -> PydanticCustomError:
    """Return a validation error with this sentence. The message begins with the place in the file."""
    return PydanticCustomError("scene", "{sentence}", {"sentence": sentence})


def suggestion(word: str, allowed: Iterable[str]) -> Message:
    """Return the end of a sentence about an unknown `word`. The text contains the most similar allowed word and all
    allowed words.
    """
    words = list(allowed)
    near, allowed = difflib.get_close_matches(word, words, n=1), ", ".join(words)
    if near:
        return Message("near", " (did you mean {near!r}?); allowed: {allowed}", near=near[0], allowed=allowed)
    return Message("allowed", "; allowed: {allowed}", allowed=allowed)


def unknown_law(law: object, laws: Iterable[str]) -> Message:
    """Return a sentence about an unknown contact law."""
    return Message("law", "unknown law {law!r}{suggestion}", law=law, suggestion=suggestion(str(law), laws))


def is_number(value: Any) -> bool:
    """Return True if `value` is a number or a fraction such as "1/14"."""
    if isinstance(value, str):
        return FRACTION.fullmatch(value) is not None
    return isinstance(value, int | float) and not isinstance(value, bool)


def _fraction(value: Any) -> Any:
    match = FRACTION.fullmatch(value) if isinstance(value, str) else None
    if match is None:
        return value
    if int(match[2]) == 0:
        raise problem(Message("zero_division", "must not divide by zero, not {given!r}", given=value))
    return int(match[1]) / int(match[2])


def _wall(value: Any, info: ValidationInfo) -> Any:
    """Convert null in JSON to infinity, the mass of a wall. JSON cannot represent infinity."""
    return math.inf if value is None and info.mode == "json" else value


# One value for all items, or a list of values. pydantic adds the tags to the places of problems.
# `softcradle.scenes.scene_errors` removes them.
OneOrMany = Annotated[
    Annotated[Item, Tag("(one)")] | Annotated[tuple[Item, ...], Tag("(many)")],
    Discriminator(lambda value: "(many)" if isinstance(value, list | tuple) else "(one)"),
]

# BeforeValidators run from right to left, and a constraint must follow its type. Therefore the validator that converts
# fractions is last.
Number = Annotated[float, Strict(), BeforeValidator(_fraction)]
Positive = Annotated[float, Strict(), Field(gt=0), BeforeValidator(_fraction)]
NotNegative = Annotated[float, Strict(), Field(ge=0), BeforeValidator(_fraction)]
Loss = Annotated[float, Strict(), Field(ge=0, lt=1), BeforeValidator(_fraction)]
AtLeastOne = Annotated[float, Strict(), Field(ge=1), BeforeValidator(_fraction)]
Mass = Annotated[float, Strict(), Field(gt=0, allow_inf_nan=True), BeforeValidator(_fraction), BeforeValidator(_wall)]
