"""The contact of a scene file: a short table such as ``{law = "power", f0 = 1.0, alpha = "1/10"}``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Tag
from softcradle.scenes.scene_table import Loss, NotNegative, Positive, Table, meant, problem

from softcradle import physics

# The keys of a law beside `law` are the parameters of its constructor.
CONSTRUCTORS: dict[str, Callable[..., physics.Contact]] = {
    "power": physics.power_law,
    "draft_gear": physics.draft_gear,
    "hertz": physics.hertz,
    "hooke": physics.hooke,
    "step": physics.step_force,
    "preloaded": physics.Contact,
}


class Law(Table):
    """A contact law by name; its other keys are its numbers, of which `loss` (0: elastic) may be left out."""

    law: str
    loss: Loss = 0.0

    def contact(self) -> physics.Contact:
        """The contact that the table describes."""
        return CONSTRUCTORS[self.law](**self.model_dump(exclude={"law"}))


class Power(Law):
    """``f0 * overlap**alpha``, Eq. (2); f0 [N / m**alpha]."""

    law: Literal["power"]
    f0: Positive
    alpha: Positive


class DraftGear(Law):
    """A spring `stiffness` [N/m] precompressed by `precompression` [m] behind a piston, Eq. (C1)."""

    law: Literal["draft_gear"]
    stiffness: Positive
    precompression: NotNegative


class Hertz(Law):
    """Elastic spheres, ``stiffness * overlap**1.5``; stiffness [N / m**1.5]."""

    law: Literal["hertz"]
    stiffness: Positive


class Hooke(Law):
    """One-sided linear spring; stiffness [N/m]."""

    law: Literal["hooke"]
    stiffness: Positive


class Step(Law):
    """The limit alpha -> 0: `f0` [N] at any overlap."""

    law: Literal["step"]
    f0: Positive


class Preloaded(Law):
    """``preload + stiffness * overlap**exponent``, the law that all others are cases of."""

    law: Literal["preloaded"]
    preload: NotNegative
    stiffness: Positive
    exponent: Positive


def _tag(value: Any) -> str:
    return f"({value['law'] if isinstance(value, Mapping) else value.law})"


def _require_law(value: Any) -> Any:
    """Refuse what names no law, before the law decides which keys belong to it."""
    if isinstance(value, Law):
        return value
    if not isinstance(value, Mapping):
        raise problem(f'must be a table such as {{law = "power", f0 = 1.0, alpha = 0.1}}, not {value!r}')
    if "law" not in value:
        raise problem(f"key 'law' is missing; allowed: {', '.join(CONSTRUCTORS)}")
    law = value["law"]
    if not isinstance(law, str) or law not in CONSTRUCTORS:
        raise problem(f"unknown law {law!r}{meant(str(law), CONSTRUCTORS)}")
    return value


ContactTable = Annotated[
    Annotated[Power, Tag("(power)")]
    | Annotated[DraftGear, Tag("(draft_gear)")]
    | Annotated[Hertz, Tag("(hertz)")]
    | Annotated[Hooke, Tag("(hooke)")]
    | Annotated[Step, Tag("(step)")]
    | Annotated[Preloaded, Tag("(preloaded)")],
    Discriminator(_tag),
    BeforeValidator(_require_law),
]
