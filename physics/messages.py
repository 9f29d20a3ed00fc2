"""Error messages as codes with values, so that a program can test the code and a window can translate the sentence.

The English sentence of a message is its template with the values filled in. `str(error)` is therefore readable in
Python and in a terminal. The window fills the same values into the translation of the template.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any


class Message(str):
    """English sentence with its code, its template, and the values in it by name.

    ``str(message)`` is the message itself, so code and values are not lost if an error is raised again with the text of
    another one. A value can be a Message as well.

    >>> message = Message("depth", "depth must be at least {least:g}, not {given:g}", least=1e-16, given=1e-20)
    >>> print(message)
    depth must be at least 1e-16, not 1e-20
    >>> message.code, message.values["least"]
    ('depth', 1e-16)
    """

    code: str
    template: str
    values: Mapping[str, Any]

    def __new__(cls, code: str, template: str, /, **values: Any) -> Message:
        """Return the message whose `template` is filled with `values`."""
        # NumPy scalars become plain numbers. This module does not import NumPy, so that commands start fast.
        plain = {name: value.item() if hasattr(value, "item") else value for name, value in values.items()}
        made = super().__new__(cls, template.format(**plain))
        made.code, made.template, made.values = code, template, plain
        return made

    def __str__(self) -> str:
        return self

    def __reduce__(self) -> tuple[Callable[..., Message], tuple[str, str, dict[str, Any]]]:
        """Return the parts, from which pickle makes the message again in another process."""
        return _message, (self.code, self.template, dict(self.values))


def _message(code: str, template: str, values: dict[str, Any]) -> Message:
    """Return a message; a function for pickle, which passes no keywords."""
    return Message(code, template, **values)


class InputError(ValueError):
    """ValueError with a code and values: ``InputError(code, template, **values)``, or ``InputError(message)``.

    >>> from softcradle import Contact
    >>> try:
    ...     _ = Contact(preload=1.0, stiffness=1.0, exponent=99.0)
    ... except ValueError as error:
    ...     print(error.code, error.values["given"])
    exponent 99.0
    """

    def __init__(self, code: str, template: str = "", /, **values: Any) -> None:
        super().__init__(Message(code, template, **values) if template else code)

    @property
    def message(self) -> Message:
        """The message with code, template and values."""
        found: Message = self.args[0]
        return found

    @property
    def code(self) -> str:
        """Short name of the problem, the same in every language and version."""
        return self.message.code

    @property
    def values(self) -> Mapping[str, Any]:
        """The values in the sentence by name."""
        return self.message.values


def message_of(error: BaseException) -> str:
    """Return the message of an error: a Message if the error has one, otherwise its text."""
    found = error.args[0] if len(error.args) == 1 else None
    return found if isinstance(found, Message) else str(error)


def N_(text: str) -> str:  # noqa: N802 - the name that gettext uses for it
    """Return `text` unchanged. It is marked as a value `what` of messages, which is translated with its sentence."""
    return text
