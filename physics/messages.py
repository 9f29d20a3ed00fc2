"""Error messages with a code and values. A program can test the code, and a window can translate the sentence.

The English sentence of a message is its template, filled with the values. `str(error)` is therefore readable in Python
and in a terminal. The window fills the same values into the translated template.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any


class Message(str):
    """English sentence with its code, its template, and a dictionary of the values in it.

    ``str(message)`` is the message itself. If an error is raised again with the text of another error, code and values
    are therefore preserved. A value can itself be a Message.

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
        # NumPy scalars become plain numbers. This module does not import NumPy, which keeps the start of commands fast.
        plain = {name: value.item() if hasattr(value, "item") else value for name, value in values.items()}
        made = super().__new__(cls, template.format(**plain))
        made.code, made.template, made.values = code, template, plain
        return made

    def __str__(self) -> str:
        return self

    def __reduce__(self) -> tuple[Callable[..., Message], tuple[str, str, dict[str, Any]]]:
        """Return the parts of the message for pickle, which rebuilds the message in another process."""
        return _message, (self.code, self.template, dict(self.values))


def _message(code: str, template: str, values: dict[str, Any]) -> Message:
    """Return a message. Pickle calls this function, because it cannot pass keyword arguments."""
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
        """Short name of the problem. The code is the same in every language and version."""
        return self.message.code

    @property
    def values(self) -> Mapping[str, Any]:
        """Values in the sentence, by name."""
        return self.message.values


def message_of(error: BaseException) -> str:
    """Return the message of an error. The result is a Message if the error contains one, otherwise plain text."""
    found = error.args[0] if len(error.args) == 1 else None
    return found if isinstance(found, Message) else str(error)


def N_(text: str) -> str:  # noqa: N802 - the name that gettext uses for it
    """Return `text` unchanged.

    The call marks a text for translation. Such a text is used as the value `what` of a message.
    """
    return text
