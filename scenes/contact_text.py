"""Conversion between contacts and one line of text, such as ``power_law(1, 1/10)``, for example on a command line."""

import re
import tomllib
from typing import Any

from pydantic import TypeAdapter, ValidationError
from softcradle.physics.chain import Joint
from softcradle.physics.messages import Message
from softcradle.scenes.contact_kinds import KIND_BY_NAME, KINDS, ContactKind
from softcradle.scenes.contact_table import AnyLaw, CouplerTable, GearTable, Law, table_of
from softcradle.scenes.scene_errors import SceneError, at, scene_error
from softcradle.scenes.toml_table import unknown_law

from softcradle import physics

TABLE: TypeAdapter[Law] = TypeAdapter(GearTable)
CALL = re.compile(r"\s*([A-Za-z_]+)\s*\((.*)\)\s*")
ACCURACY = 1e-6  # Relative accuracy of numbers that are written with six digits.


def contact_from(text: str) -> Law:
    """Return the contact law that `text` describes, such as ``power_law(1, 1/10)``.

    Parameters may be named, as in ``draft_gear(stiffness=5, precompression=0.2)``. The names of laws are the same as in
    Python or in scene files.

    Raises:
        SceneError: `text` does not describe a contact. The error message is one sentence.

    >>> contact_from("power_law(1, alpha=1/10)").contact() == physics.power_law(1.0, 0.1)
    True
    """
    match = CALL.fullmatch(text)
    if match is None:
        raise SceneError(
            [
                Message(
                    "contact_text",
                    "{what} must be a law with its numbers, such as power_law(1, 1/10)",
                    what=_named(text),
                )
            ]
        )
    if match[1] not in KIND_BY_NAME:
        laws = [kind.law for kind in KINDS]
        raise SceneError([at(_named(text), unknown_law(match[1], laws))])
    table = {"law": match[1], **_numbers(text, match[1], match[2])}
    try:
        return TABLE.validate_python(table)
    except ValidationError as error:
        raise SceneError(scene_error(_named(text), error, whole="").problems[:1]) from None


def _named(text: str) -> Message:
    """Return the name of the contact for use in messages."""
    return Message("contact_name", "contact {text!r}", text=text)


def _numbers(text: str, law: str, arguments: str) -> dict[str, Any]:
    """Return the parameters in the text `arguments`, by name.

    `law` is the name of the law, and `text` is the whole call for error messages.
    """
    names = list(KIND_BY_NAME[law].numbers)
    found: dict[str, Any] = {}
    words = [word.strip() for word in arguments.split(",")] if arguments.strip() else []
    for position, word in enumerate(words):
        key, equals, number = (part.strip() for part in word.rpartition("="))
        if not equals and position >= len(names):
            numbers = ", ".join(names)
            allowed = Message(
                "law_numbers", "the numbers of {law} are {numbers}, and loss=...", law=law, numbers=numbers
            )
            raise SceneError([at(_named(text), allowed)])
        name = key if equals else names[position]
        if name in found or name == "law":
            raise SceneError([at(_named(text), Message("number_twice", "{key} is given twice", key=name))])
        found[name] = _number(number)
    return found


def _number(text: str) -> Any:
    """Return a number, read according to the rules of TOML.

    A fraction or any other text is returned as text. The table of the law checks it later.
    """
    try:
        value = tomllib.loads(f"x = {text}")["x"]
    except (ValueError, RecursionError):
        return text
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


def contact_text(contact: AnyLaw | Joint) -> str:
    """Return the contact as one line of text, with numbers of six digits.

    :func:`contact_from` can read this text, except for couplers and user-defined laws.

    >>> contact_text(physics.draft_gear(770.0, 0.0177))
    'draft_gear(770, 0.0177)'
    """
    if isinstance(contact, AnyLaw):
        law = contact
    elif isinstance(contact, physics.Contact | physics.Coupler):
        law = table_of(contact, ACCURACY)
    else:  # a user-defined law
        return f"{contact.name}(overlap)"
    if isinstance(law, CouplerTable):
        gears = {"push": law.push, "pull": law.pull}
        lengths = {"slack": law.slack, "travel": law.travel, "stop": law.stop}
        words = [f"{name}={contact_text(gear)}" for name, gear in gears.items() if gear is not None]
        return f"{law.law}({', '.join([*words, *(f'{name}={value:.6g}' for name, value in lengths.items() if value)])})"
    assert isinstance(law, Law)
    kind: ContactKind = KIND_BY_NAME[law.law]
    numbers = [f"{getattr(law, name):.6g}" for name in kind.numbers]
    if law.loss:
        numbers.append(f"loss={law.loss:.6g}")
    return f"{kind.law}({', '.join(numbers)})"
