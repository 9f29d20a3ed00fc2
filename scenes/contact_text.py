"""Contacts in one line of text, as on a command line: ``power_law(1, 1/10)``, ``draft_gear(k=770, ...)`` and back."""

from __future__ import annotations

import re
import tomllib
from typing import Any, get_args

from pydantic import TypeAdapter, ValidationError
from softcradle.scenes.contact_table import CONSTRUCTORS, ContactTable, Law
from softcradle.scenes.scene_errors import SceneError, scene_error
from softcradle.scenes.scene_table import meant

from softcradle import physics

SPELLED = {"power_law": "power", "step_force": "step"}  # the names in Python, where they differ from those in a file
LAWS: TypeAdapter[Any] = TypeAdapter(ContactTable)
MODELS = {get_args(table.model_fields["law"].annotation)[0]: table for table in Law.__subclasses__()}
CALL = re.compile(r"\s*([A-Za-z_]+)\s*\((.*)\)\s*")


def contact_from(text: str) -> Law:
    """The contact that `text` names, such as ``power_law(1, 1/10)`` or ``draft_gear(stiffness=5, precompression=0.2)``.

    Laws and their numbers are those of a scene file; a law may also have its name in Python.

    Raises:
        SceneError: it is none; one sentence.

    >>> contact_from("power_law(1, alpha=1/10)").contact() == physics.power_law(1.0, 0.1)
    True
    """
    match = CALL.fullmatch(text)
    if match is None:
        raise SceneError([f"contact {text!r} must be a law with its numbers, such as power_law(1, 1/10)"])
    law = SPELLED.get(match[1], match[1])
    if law not in CONSTRUCTORS:
        raise SceneError([f"contact {text!r}: unknown law {match[1]!r}{meant(match[1], _names())}"])
    names = _numbers_of(law)
    table: dict[str, Any] = {"law": law}
    words = [word.strip() for word in match[2].split(",")] if match[2].strip() else []
    for position, word in enumerate(words):
        key, equals, number = (part.strip() for part in word.rpartition("="))
        if not equals and position >= len(names):
            raise SceneError(
                [f"contact {text!r}: {match[1]} has {len(names)} numbers, {', '.join(names)}, and loss=..."]
            )
        name = key if equals else names[position]
        if name in table:
            raise SceneError([f"contact {text!r}: {name} is there twice"])
        table[name] = _number(number)
    try:
        found: Law = LAWS.validate_python(table)
    except ValidationError as error:
        raise SceneError([scene_error(f"contact {text!r}", error).problems[0].replace(": the scene:", ":")]) from None
    return found


def contact_text(law: Law | physics.Contact) -> str:
    """The same in writing, numbers to six digits; :func:`contact_from` reads it back.

    >>> contact_text(physics.draft_gear(770.0, 0.0177))
    'draft_gear(770, 0.0177)'
    """
    if isinstance(law, physics.Contact):
        law = law_of(law)
    spelled = {value: key for key, value in SPELLED.items()}.get(law.law, law.law)
    numbers = [f"{law.model_dump()[name]:.6g}" for name in _numbers_of(law.law)]
    if law.loss:
        numbers.append(f"loss={law.loss:.6g}")
    return f"{spelled}({', '.join(numbers)})"


def law_of(contact: physics.Contact) -> Law:
    """The scene file's table for `contact`: by the most telling name."""
    preload, stiffness, exponent = contact.preload, contact.stiffness, contact.exponent
    if stiffness == 0.0:
        table: dict[str, Any] = {"law": "step", "f0": preload}
    elif preload == 0.0:
        table = {
            1.0: {"law": "hooke", "stiffness": stiffness},
            1.5: {"law": "hertz", "stiffness": stiffness},
        }.get(exponent, {"law": "power", "f0": stiffness, "alpha": exponent})
    elif exponent == 1.0:
        table = {"law": "draft_gear", "stiffness": stiffness, "precompression": preload / stiffness}
    else:
        table = {"law": "preloaded", "preload": preload, "stiffness": stiffness, "exponent": exponent}
    found: Law = LAWS.validate_python(table | {"loss": contact.loss})
    return found


def _names() -> list[str]:
    spelled = {value: key for key, value in SPELLED.items()}
    return [spelled.get(law, law) for law in CONSTRUCTORS]


def _numbers_of(law: str) -> list[str]:
    """Names of a law's numbers, in the order of its constructor; `loss` is always named."""
    return [name for name in MODELS[law].model_fields if name not in ("law", "loss")]


def _number(text: str) -> Any:
    """A number as TOML reads it, a fraction or whatever else as its text: the table of the law judges it."""
    try:
        value = tomllib.loads(f"x = {text}")["x"]
    except tomllib.TOMLDecodeError:
        return text
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value
