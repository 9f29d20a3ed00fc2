"""Claim of the paper as a measurement; its study: cases measured by two methods, with error bars, and the verdict."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from enum import StrEnum
from functools import cached_property
from itertools import groupby, product

import numpy as np
from numpy.typing import ArrayLike
from softcradle.sandbox.studies.paper import MEASURING, REFERENCE, SECOND, MethodFineness, NotSolvedError, Parameters


class Verdict(StrEnum):
    """Verdict on a claim, from the cases of its study."""

    HOLDS = "holds"  # in every determined case
    WITHIN = "holds within"  # in the paper's own case, up to a limit
    BEYOND = "fails beyond"  # not in the paper's own case, which lies beyond the limit
    UNDETERMINED = "not determined"  # in the paper's own case, the error bar crosses the allowed value


class CaseOutcome(StrEnum):
    """Position of a case, with its error bar, relative to the allowed value."""

    HOLDS = "holds"
    FAILS = "fails"
    UNDETERMINED = "not determined"


@dataclass(frozen=True)
class Case:
    """A measured case.

    Attributes:
        parameters: varied parameters by name.
        variable: number by which the cases of the study are sorted.
        value: measured quantity; NaN if it could not be measured.
        error: largest difference of `value` from the result of a second method.
        allowed: the claim holds if the quantity is at most this.
        reason: why the quantity could not be measured, or empty.
    """

    parameters: Mapping[str, float]
    variable: float
    value: float
    error: float
    allowed: float
    reason: str = ""

    @property
    def side(self) -> CaseOutcome:
        """Position of the value; undetermined if its error bar crosses `allowed`."""
        if not math.isfinite(self.value) or not math.isfinite(self.error):
            return CaseOutcome.UNDETERMINED
        if self.value + self.error <= self.allowed:
            return CaseOutcome.HOLDS
        return CaseOutcome.FAILS if self.value - self.error > self.allowed else CaseOutcome.UNDETERMINED


@dataclass(frozen=True)
class Statement:
    """Statement of the paper, and the quantity that tests it.

    Attributes:
        name: argument of `softcradle claims`.
        statement: statement of the paper.
        place: its place in the paper.
        quantity: description of the value of a case.
        variable: name of the number by which cases are sorted; the claim is expected to hold if it is small.
        how: how it was measured, with ranges and seeds.
        remark: explanation of the result.
        own: parameters of the paper's own case.
    """

    name: str
    statement: str
    place: str
    quantity: str
    variable: str
    how: str
    remark: str
    own: Parameters


@dataclass(frozen=True)
class JudgedClaim(Statement):
    """A claim with its measured cases and the verdict.

    Attributes:
        cases: in ascending order of the variable.
        chosen: True if the allowed value is our reading of the statement, not a number or sign that it names.
        reference: value of the paper's own case by the independent reference; NaN if it was not requested.
        seconds: processor time [s] of the measurement.
    """

    cases: Sequence[Case]
    chosen: bool = True
    reference: float = math.nan
    seconds: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "cases", tuple(sorted(self.cases, key=lambda case: case.variable)))

    def on(self, side: CaseOutcome) -> list[Case]:
        """Return the cases at that position."""
        return [case for case in self.cases if case.side is side]

    @cached_property
    def own_case(self) -> Case:
        """Case whose parameters are nearest to the paper's own."""
        return min(self.cases, key=self.distance)

    def distance(self, case: Case) -> float:
        """Return the distance of `case` from the paper's own: the sum of the absolute logarithms of the ratios of
        parameters.
        """
        return sum(_apart(case.parameters[name], value) for name, value in self.own.items())

    @cached_property
    def limit(self) -> float | None:
        """Largest value of the variable up to which no case fails and one holds; None if the first cases do not hold."""
        last = None
        for variable, sides in self._sides:
            if CaseOutcome.FAILS in sides:
                break
            last = variable if CaseOutcome.HOLDS in sides else last
        return last

    @cached_property
    def _sides(self) -> list[tuple[float, set[CaseOutcome]]]:
        """Return the values of the variable, and the positions of the cases at each."""
        groups = groupby(self.cases, key=lambda case: case.variable)
        return [(variable, {case.side for case in group}) for variable, group in groups]

    @cached_property
    def range_of_own(self) -> tuple[float, float]:
        """Return the range of the variable around the paper's own value in which some cases hold and none fails; inf if
        none fails beyond.

        It is empty, (nan, nan), if a case fails at the paper's own value.
        """
        own = self.own_case.variable
        failing = [variable for variable, sides in self._sides if CaseOutcome.FAILS in sides]
        below, above = (
            max((x for x in failing if x <= own), default=-math.inf),
            min((x for x in failing if x >= own), default=math.inf),
        )
        inside = [
            variable for variable, sides in self._sides if below < variable < above and CaseOutcome.HOLDS in sides
        ]
        if not inside or own in failing:
            return math.nan, math.nan
        return (inside[0] if below > -math.inf else below), (inside[-1] if above < math.inf else above)

    @cached_property
    def verdict(self) -> Verdict:
        """Verdict that follows from the cases; see Verdict."""
        own = self.own_case.side
        if own is CaseOutcome.UNDETERMINED:
            return Verdict.UNDETERMINED
        if own is CaseOutcome.FAILS:
            return Verdict.BEYOND
        return Verdict.WITHIN if self.on(CaseOutcome.FAILS) else Verdict.HOLDS

    @property
    def verdict_text(self) -> str:
        """Verdict with its limit, and the number of undetermined cases."""
        unknown = len(self.on(CaseOutcome.UNDETERMINED))
        rest = (
            f"; {unknown} of {len(self.cases)} not determined"
            if unknown and self.verdict is not Verdict.UNDETERMINED
            else ""
        )
        return self._verdict_with_limit() + rest

    def _verdict_with_limit(self) -> str:
        if self.verdict in (Verdict.HOLDS, Verdict.UNDETERMINED):
            return str(self.verdict)
        if self.verdict is Verdict.WITHIN:
            return f"holds within {self._within()}"
        return (
            f"fails beyond {self.variable} = {self.limit:.3g}"
            if self.limit is not None
            else self._fails_throughout(len(self.on(CaseOutcome.HOLDS)))
        )

    def _within(self) -> str:
        """Return the range around the paper's own case in which no case fails, or how many cases hold."""
        low, high = self.range_of_own
        bounds = [f">= {low:.3g}"] * math.isfinite(low) + [f"<= {high:.3g}"] * math.isfinite(high)
        if low == high or not bounds:
            return f"{len(self.on(CaseOutcome.HOLDS))} of {len(self.cases)} cases"
        return f"{self.variable} {' and '.join(bounds)}"

    def _fails_throughout(self, holding: int) -> str:
        """Return the verdict if the claim fails in the paper's own case and does not hold in any range."""
        first = self.cases[0].variable
        return f"fails beyond {self.variable} = {first:.3g}, the least tried" + (
            f"; holds in {holding} of {len(self.cases)}" if holding else ""
        )

    @cached_property
    def counter_example(self) -> Case | None:
        """Failing case nearest to the paper's own; None if none fails."""
        return min(self.on(CaseOutcome.FAILS), key=self.distance, default=None)

    @property
    def bar_text(self) -> str:
        """How the verdict depends on the allowed value, if that is our choice: the bar from which each verdict follows."""
        own = self.own_case
        if not self.chosen or own.side is CaseOutcome.UNDETERMINED:
            return ""
        lowest = [case.value - case.error for case in self.cases]  # a case fails if the allowed value is lower
        most = max(value for value in lowest if math.isfinite(value))
        low, high = own.value - own.error, own.value + own.error
        within = f", holds within from {high:.3g}" if high < most else ""
        return f"by the bar: fails beyond below {low:.3g}{within}, holds from {max(most, high):.3g}"

    @property
    def range_text(self) -> str:
        """Range of every parameter."""
        names = self.cases[0].parameters
        spans = {name: sorted({case.parameters[name] for case in self.cases}) for name in names}
        return ", ".join(f"{name} = {_span(values)}" for name, values in spans.items())

    @property
    def measured_text(self) -> str:
        """Result in sentences: the paper's own case, how many cases hold, the nearest counter-example."""
        own = self.own_case
        parts = [f"{self.quantity}: {case_text(own)}; at most {own.allowed:.3g} allowed"]
        counts = [f"{len(self.on(side))} {side}" for side in CaseOutcome if self.on(side)]
        parts.append(f"{len(self.cases)} cases: {', '.join(counts)}")
        if self.counter_example is not None and self.counter_example is not own:
            parts.append(f"nearest counter-example: {case_text(self.counter_example)}")
        parts += [text for text in (self.bar_text, self.remark) if text]
        return ". ".join(parts)


def case_text(case: Case) -> str:
    """Return the value of a case with its error bar, and its parameters."""
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


CaseMeasure = Callable[[Parameters, MethodFineness], float]


@dataclass(frozen=True, kw_only=True)
class Claim(Statement):
    """A statement with the functions that measure it.

    Attributes:
        measure: computes the quantity at the parameters of a case with a MethodFineness.
        cases: parameters of all cases.
        order: computes the variable of a case from its parameters.
        allowed: the claim holds if the quantity is at most this.
        chosen: as in JudgedClaim.
        first: method of the measurement.
        second: method of the error bars.
        refer: True if the independent reference also measures the paper's own case.
    """

    remark: str = ""
    measure: CaseMeasure
    cases: Sequence[Parameters]
    order: Callable[[Parameters], float]
    allowed: float
    first: MethodFineness = MEASURING
    second: MethodFineness = SECOND
    refer: bool = True
    chosen: bool = True

    def study_of(self, cases: Sequence[Case], reference: float = math.nan, seconds: float = 0.0) -> JudgedClaim:
        """Return the study of measured cases; the reference's value widens the error bar of the paper's own case."""
        stated = {field.name: getattr(self, field.name) for field in fields(Statement)}
        study = JudgedClaim(**stated, cases=cases, chosen=self.chosen, reference=reference, seconds=seconds)
        return _with_reference(study) if self.refer else study

    def reference(self) -> float:
        """Return the value of the paper's own case by the independent reference; NaN if it is not requested."""
        if not self.refer:
            return math.nan
        blank = [self.measured(each) for each in self.cases]
        return self.value(self.study_of(blank).own_case.parameters, REFERENCE)[0]

    def measured(
        self, parameters: Parameters, value: float = math.nan, error: float = math.nan, reason: str = ""
    ) -> Case:
        """Return the case of these parameters with its measurement."""
        return Case(dict(parameters), self.order(parameters), value, error, self.allowed, reason)

    def case(self, parameters: Parameters) -> Case:
        """Measure the quantity at `parameters` and its error bar."""
        value, reason = self.value(parameters, self.first)
        other, _ = self.value(parameters, self.second) if not reason else (math.nan, reason)
        reason = reason or ("" if math.isfinite(other) else "the second method found nothing")
        return self.measured(parameters, value, abs(value - other), reason)

    def value(self, parameters: Parameters, solver: MethodFineness) -> tuple[float, str]:
        """Measure the quantity with that method; if it is NaN, the text is the reason."""
        try:
            value = float(self.measure(parameters, solver))
        except NotSolvedError as error:
            return math.nan, str(error)
        return value, "" if math.isfinite(value) else "the quantity does not exist"


def _with_reference(study: JudgedClaim) -> JudgedClaim:
    """Return `study` with the reference's value included in the error bar of the paper's own case."""
    own = study.own_case
    error = max(own.error, abs(own.value - study.reference)) if math.isfinite(study.reference) else own.error
    return replace(study, cases=[replace(case, error=error) if case is own else case for case in study.cases])


def grid(**values: ArrayLike) -> list[Parameters]:
    """Return the parameters of all combinations of the named values (one or several for each name)."""
    columns = [np.atleast_1d(column).tolist() for column in values.values()]
    return [dict(zip(values, map(float, case), strict=True)) for case in product(*columns)]
