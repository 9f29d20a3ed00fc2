"""Conversion between contacts and their tables in scene files, such as ``{law = "power_law", f0 = 1.0, alpha =
"1/10"}``.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Mapping
from typing import Annotated, Any, NoReturn, Self

from pydantic import BeforeValidator, SerializeAsAny, StrictBool, ValidationError, create_model, model_validator
from softcradle.physics.checked_input import shown
from softcradle.physics.messages import Message
from softcradle.scenes.contact_kinds import KIND_BY_NAME, KINDS, ContactKind
from softcradle.scenes.other_names import SAME_LAWS
from softcradle.scenes.toml_table import (
    Loss,
    NotNegative,
    Positive,
    Table,
    details_again,
    problem,
    sentence_details,
    unknown_law,
)

from softcradle import physics


class AnyLaw(Table):
    """Table of a contact between two beads. The key `law` contains the name of its contact law."""

    law: str

    def contact(self) -> physics.Contact | physics.Coupler:
        """Return the contact that the table describes, for use in a Chain."""
        raise NotImplementedError


class Law(AnyLaw):
    """Table of a contact law. The keys other than `law` are the parameters of the law.

    The default of `loss` is 0, which means an elastic contact.
    """

    loss: Loss = 0.0

    def contact(self) -> physics.Contact:
        """Return the contact that the table describes."""
        return KIND_BY_NAME[self.law].constructor(**{name: value for name, value in self if name != "law"})

    def __reduce__(self) -> tuple[Callable[[Any], Law], tuple[dict[str, Any]]]:
        """Return the table for pickle. Another process creates the object from the table.

        The model classes of laws cannot be pickled directly, because a module does not contain them by name.
        """
        return read_law, (self.model_dump(exclude_unset=True),)


def _model(kind: ContactKind) -> type[Law]:
    numbers: dict[str, Any] = {name: (values, ...) for name, values in kind.numbers.items()}
    return create_model(kind.law, __base__=Law, **numbers)


MODELS = {kind.law: _model(kind) for kind in KINDS}


def read_law(table: Any) -> Law:
    """Return the contact law that a table of a scene file describes.

    The name of the law is checked first, because it determines the other keys.
    """
    found = _read(table, [kind.law for kind in KINDS])
    assert isinstance(found, Law)
    return found


def _read(table: Any, laws: list[str]) -> AnyLaw:
    """Return the contact that a table describes. The name of its law must be one of `laws`."""
    if isinstance(table, AnyLaw):
        return table
    if not isinstance(table, Mapping):
        raise problem(
            Message(
                "contact_table",
                'must be a table such as {{law = "power_law", f0 = 1.0, alpha = 0.1}}, not {given}',
                given=shown(table),
            )
        )
    if "law" not in table:
        raise problem(Message("no_law", "key 'law' is missing; allowed: {laws}", laws=", ".join(laws)))
    law = table["law"]
    if law == COUPLER and COUPLER in laws:
        return CouplerTable.model_validate(table)
    if not isinstance(law, str) or law not in KIND_BY_NAME:
        _raise_unknown_law(law, table, laws)
    name = KIND_BY_NAME[law].law
    return MODELS[name].model_validate({**table, "law": name})


def _raise_unknown_law(law: Any, table: Mapping[str, Any], laws: list[str]) -> NoReturn:
    """Raise the error for an unknown law.

    If the intended law can be guessed, also raise the errors of its parameters.
    """
    meant = SAME_LAWS.get(str(law).lower()) or next(iter(difflib.get_close_matches(str(law), laws, n=1)), "")
    known = str(law).lower() in SAME_LAWS
    called = Message("same_law", "unknown law {law!r}: it is called {meant!r}", law=law, meant=meant)
    sentence = called if known else unknown_law(law, laws)
    found = [sentence_details(sentence, table)]
    try:
        if meant:
            _read({**table, "law": meant}, laws)
    except ValidationError as error:
        found += [details_again(detail) for detail in error.errors(include_url=False)]
    raise ValidationError.from_exception_data("contact", found)


class CouplerTable(AnyLaw):
    """Table of a train coupler, see :class:`softcradle.Coupler`. A coupler pushes, has slack, pulls, and becomes solid
    at full travel.

    Attributes:
        push: table of the contact law for pushing.
        pull: table of the contact law for pulling. By default the coupler does not pull.
        slack: distance between pushing and pulling [m].
        travel: compression of a gear at which it becomes solid [m]. It requires `stop`.
        stop: stiffness added to the law of the gear beyond the travel [N/m]. It requires `travel`.
        coupled: true if the coupler is coupled at the start. By default it is coupled unless the gap is larger than
            the slack.
    """

    push: GearTable
    pull: GearTable | None = None
    slack: NotNegative = 0.0
    travel: Positive | None = None
    stop: NotNegative = 0.0
    coupled: StrictBool | None = None

    def contact(self) -> physics.Coupler:
        """Return the coupler that the table describes."""
        pull, travel = (
            None if self.pull is None else self.pull.contact(),
            math.inf if self.travel is None else self.travel,
        )
        return physics.Coupler(self.push.contact(), pull, self.slack, travel, self.stop, self.coupled)

    @model_validator(mode="after")
    def _check(self) -> Self:
        self.contact()
        return self


COUPLER = "coupler"
GearTable = Annotated[SerializeAsAny[Law], BeforeValidator(read_law)]
ContactTable = Annotated[
    SerializeAsAny[AnyLaw], BeforeValidator(lambda table: _read(table, [*(kind.law for kind in KINDS), COUPLER]))
]


def table_of(contact: physics.Contact | physics.Coupler, accuracy: float = 0.0) -> AnyLaw:
    """Return the table of a contact (see :func:`law_of`) or of a coupler."""
    if isinstance(contact, physics.Contact):
        return law_of(contact, accuracy)
    pull = None if contact.pull is None else law_of(contact.pull, accuracy)
    travel = None if math.isinf(contact.travel) else contact.travel
    push = law_of(contact.push, accuracy)
    return CouplerTable(
        law=COUPLER,
        push=push,
        pull=pull,
        slack=contact.slack,
        travel=travel,
        stop=contact.stop,
        coupled=contact.coupled,
    )


def law_of(contact: physics.Contact, accuracy: float = 0.0) -> Law:
    """Return the table of a contact law. The table uses the most special kind of contact that describes `contact`.

    `accuracy` is the allowed relative error of the preload.
    """
    preload, stiffness, exponent = contact.preload, contact.stiffness, contact.exponent
    precompression = _precompression(preload, stiffness, accuracy) if stiffness and exponent == 1.0 else None
    if stiffness == 0.0:
        table: dict[str, Any] = {"law": "step_force", "f0": preload}
    elif preload == 0.0 and exponent in (1.0, 1.5):
        table = {"law": "hooke" if exponent == 1.0 else "hertz", "stiffness": stiffness}
    elif preload == 0.0:
        table = {"law": "power_law", "f0": stiffness, "alpha": exponent}
    elif precompression is not None:
        table = {"law": "draft_gear", "stiffness": stiffness, "precompression": precompression}
    else:
        table = {"law": "preloaded", "preload": preload, "stiffness": stiffness, "exponent": exponent}
    return read_law(table | {"loss": contact.loss})


def _precompression(preload: float, stiffness: float, accuracy: float) -> float | None:
    """Return the precompression [m] that gives `preload` with the given `stiffness`.

    If several values fit, return the one with the shortest text. Return None if rounding excludes every value.
    """
    quotient = preload / stiffness
    near = (quotient, math.nextafter(quotient, 0.0), math.nextafter(quotient, math.inf))
    fitting = [length for length in near if math.isclose(stiffness * length, preload, rel_tol=accuracy)]
    return min(fitting, key=lambda length: len(repr(length)), default=None)
