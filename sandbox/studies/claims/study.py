"""A study of a claim of the paper: cases that were measured with error bars, and the verdict that follows from them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from itertools import groupby


class Verdict(StrEnum):
    """What the cases of a study say about the claim."""

    HOLDS = "holds"  # in every case that is determined
    WITHIN = "holds within"  # in the paper's own case, up to a limit
    BEYOND = "fails beyond"  # not in the paper's own case, which lies beyond the limit
    UNDETERMINED = "not determined"  # in the paper's own case the error bar crosses what the claim allows


class Side(StrEnum):
    """On which side of what the claim allows a case lies, error bar and all."""

    HOLDS = "holds"
    FAILS = "fails"
    UNDETERMINED = "not determined"


@dataclass(frozen=True)
class Case:
    """A measured case.

    Attributes:
        parameters: what was varied, by name.
        variable: the number by which the cases of the study are ordered.
        value: the measured quantity; nan where nothing could be measured.
        error: largest difference of `value` from what a second method finds.
        allowed: the claim holds where the quantity is at most this.
        reason: why nothing could be measured, or empty.
    """

    parameters: Mapping[str, float]
    variable: float
    value: float
    error: float
    allowed: float
    reason: str = ""

    @property
    def side(self) -> Side:
        """Where the value lies; a value whose error bar crosses `allowed` is on neither side."""
        if not math.isfinite(self.value) or not math.isfinite(self.error):
            return Side.UNDETERMINED
        if self.value + self.error <= self.allowed:
            return Side.HOLDS
        return Side.FAILS if self.value - self.error > self.allowed else Side.UNDETERMINED


@dataclass(frozen=True)
class Study:
    """A claim, the cases it was tried at, and what follows.

    Attributes:
        name: what `softcradle claims` takes.
        statement: what the paper says.
        place: where it says so.
        quantity: what the value of a case is.
        variable: name of the number by which cases are ordered; the claim is expected to hold where it is small.
        how: how it was measured, with ranges and seeds.
        remark: what explains the result.
        own: parameters of the paper's own case.
        cases: in ascending order of the variable.
        reference: value of the paper's own case by the independent reference; nan where it was not asked.
        seconds: processor time [s] that its measurement took.
    """

    name: str
    statement: str
    place: str
    quantity: str
    variable: str
    how: str
    remark: str
    own: Mapping[str, float]
    cases: Sequence[Case]
    reference: float = math.nan
    seconds: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "cases", tuple(sorted(self.cases, key=lambda case: case.variable)))

    def on(self, side: Side) -> list[Case]:
        """The cases on that side."""
        return [case for case in self.cases if case.side is side]

    @cached_property
    def own_case(self) -> Case:
        """The case whose parameters are nearest to the paper's own."""
        return min(self.cases, key=self.distance)

    def distance(self, case: Case) -> float:
        """How far `case` is from the paper's own: the sum of the absolute logarithms of the ratios of parameters."""
        return sum(_apart(case.parameters[name], value) for name, value in self.own.items())

    @cached_property
    def limit(self) -> float | None:
        """Largest value of the variable up to which no case fails and one holds; None where the first ones do not."""
        last = None
        for variable, group in groupby(self.cases, key=lambda case: case.variable):
            sides = {case.side for case in group}
            if Side.FAILS in sides:
                break
            last = variable if Side.HOLDS in sides else last
        return last

    @cached_property
    def verdict(self) -> Verdict:
        """What the cases say; see Verdict."""
        own = self.own_case.side
        if own is Side.UNDETERMINED:
            return Verdict.UNDETERMINED
        if own is Side.FAILS:
            return Verdict.BEYOND
        return Verdict.WITHIN if self.on(Side.FAILS) else Verdict.HOLDS

    @property
    def verdict_text(self) -> str:
        """The verdict with its limit, and how many cases are not determined."""
        unknown = len(self.on(Side.UNDETERMINED))
        rest = (
            f"; {unknown} of {len(self.cases)} not determined"
            if unknown and self.verdict is not Verdict.UNDETERMINED
            else ""
        )
        return self._verdict_with_limit() + rest

    def _verdict_with_limit(self) -> str:
        if self.verdict in (Verdict.HOLDS, Verdict.UNDETERMINED):
            return str(self.verdict)
        holding, count = len(self.on(Side.HOLDS)), len(self.cases)
        if self.verdict is Verdict.WITHIN:
            inside = self.limit is not None and self.own_case.variable <= self.limit
            return (
                f"holds within {self.variable} <= {self.limit:.3g}"
                if inside
                else f"holds within {holding} of {count} cases"
            )
        return (
            f"fails beyond {self.variable} = {self.limit:.3g}"
            if self.limit is not None
            else self._fails_throughout(holding)
        )

    def _fails_throughout(self, holding: int) -> str:
        """The verdict where the claim fails in the paper's own case and has no range in which it holds."""
        first = self.cases[0].variable
        return f"fails beyond {self.variable} = {first:.3g}, the least tried" + (
            f"; holds in {holding} of {len(self.cases)}" if holding else ""
        )

    @cached_property
    def counter_example(self) -> Case | None:
        """The failing case nearest to the paper's own; None where none fails."""
        return min(self.on(Side.FAILS), key=self.distance, default=None)

    @property
    def range_text(self) -> str:
        """The range of every parameter."""
        names = self.cases[0].parameters
        spans = {name: sorted({case.parameters[name] for case in self.cases}) for name in names}
        return ", ".join(f"{name} = {_span(values)}" for name, values in spans.items())

    @property
    def measured_text(self) -> str:
        """What was found, in sentences: the paper's own case, how many cases hold, the nearest counter-example."""
        own = self.own_case
        parts = [f"{self.quantity}: {case_text(own)}; at most {own.allowed:.3g} allowed"]
        counts = [f"{len(self.on(side))} {side}" for side in Side if self.on(side)]
        parts.append(f"{len(self.cases)} cases: {', '.join(counts)}")
        if self.counter_example is not None and self.counter_example is not own:
            parts.append(f"nearest counter-example: {case_text(self.counter_example)}")
        if self.remark:
            parts.append(self.remark)
        return ". ".join(parts)


def case_text(case: Case) -> str:
    """The value of a case with its error bar, and its parameters."""
    where = ", ".join(f"{name} = {value:.4g}" for name, value in case.parameters.items())
    if case.reason:
        return f"nothing at {where} ({case.reason})"
    return f"{case.value:.4g} ± {case.error:.1g} at {where}"


def _apart(value: float, own: float) -> float:
    if value == own:
        return 0.0
    return abs(math.log(value / own)) if value > 0.0 and own > 0.0 else abs(value - own)


def _span(values: Sequence[float]) -> str:
    return f"{values[0]:.4g}" if len(values) == 1 else f"{values[0]:.4g} ... {values[-1]:.4g}"
