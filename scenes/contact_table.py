"""The contact of a scene file, a table such as ``{law = "power_law", f0 = 1.0, alpha = "1/10"}``, and that of a Contact."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, SerializeAsAny, create_model
from softcradle.scenes.contact_kinds import KIND_BY_NAME, KINDS, ContactKind
from softcradle.scenes.toml_table import Loss, Table, problem, suggestion

from softcradle import physics


class Law(Table):
    """A contact law by name; its other keys are its numbers. `loss` may be left out: 0, elastic."""

    law: str
    loss: Loss = 0.0

    def contact(self) -> physics.Contact:
        """The contact that the table describes."""
        return KIND_BY_NAME[self.law].constructor(**self.model_dump(exclude={"law"}))


def _model(kind: ContactKind) -> type[Law]:
    numbers: dict[str, Any] = {name: (values, ...) for name, values in kind.numbers.items()}
    return create_model(kind.law, __base__=Law, **numbers)


MODELS = {kind.law: _model(kind) for kind in KINDS}


def read_law(table: Any) -> Law:
    """The law that a table of a scene file describes. Its name is checked first, because it decides on the other keys."""
    if isinstance(table, Law):
        return table
    if not isinstance(table, Mapping):
        raise problem(f'must be a table such as {{law = "power_law", f0 = 1.0, alpha = 0.1}}, not {table!r}')
    laws = [kind.law for kind in KINDS]
    if "law" not in table:
        raise problem(f"key 'law' is missing; allowed: {', '.join(laws)}")
    law = table["law"]
    if not isinstance(law, str) or law not in KIND_BY_NAME:
        raise problem(f"unknown law {law!r}{suggestion(str(law), laws)}")
    name = KIND_BY_NAME[law].law
    return MODELS[name].model_validate({**table, "law": name})


ContactTable = Annotated[SerializeAsAny[Law], BeforeValidator(read_law)]


def law_of(contact: physics.Contact, accuracy: float = 0.0) -> Law:
    """The law of the most special kind that gives `contact`; its preload may differ by a relative error of `accuracy`."""
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
    """The precompression [m] that gives `preload`, of several the shortest to write; None where rounding excludes all."""
    quotient = preload / stiffness
    near = (quotient, math.nextafter(quotient, 0.0), math.nextafter(quotient, math.inf))
    fitting = [length for length in near if math.isclose(stiffness * length, preload, rel_tol=accuracy)]
    return min(fitting, key=lambda length: len(repr(length)), default=None)
