"""Claims of the paper as measurements. A study measures cases with error bars by two methods and gives a verdict."""

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
    """Verdict on a claim that follows from the cases of its study."""

    HOLDS = "holds"  # The claim holds in every determined case.
    WITHIN = "holds within"  # The claim holds in the paper's own case and up to a limit of the variable.
    BEYOND = "fails beyond"  # The claim fails in the paper's own case, which lies beyond the limit of the variable.
    UNDETERMINED = "not determined"  # The error bar of the paper's own case crosses the allowed value.


class CaseOutcome(StrEnum):
    """Position of a case and its error bar relative to the allowed value."""

    HOLDS = "holds"
    FAILS = "fails"
    UNDETERMINED = "not determined"


@dataclass(frozen=True)
class Case:
    """One measured case of a claim.

    Attributes:
        parameters: varied parameters by name.
        variable: number by which the cases of the study are sorted.
        value: measured quantity; NaN if it could not be measured.
        error: largest difference between `value` and the result of a second method.
        allowed: largest value of the quantity for which the claim holds.
        reason: text that explains why the quantity could not be measured, or empty.
    """

    parameters: Mapping[str, float]
    variable: float
    value: float
    error: float
    allowed: float
    reason: str = ""

    @property
    def side(self) -> CaseOutcome:
        """Position of the value relative to `allowed`. The position is undetermined if the error bar crosses `allowed`."""
        if not math.isfinite(self.value) or not math.isfinite(self.error):
            return CaseOutcome.UNDETERMINED
        if self.value + self.error <= self.allowed:
            return CaseOutcome.HOLDS
        return CaseOutcome.FAILS if self.value - self.error > self.allowed else CaseOutcome.UNDETERMINED


@dataclass(frozen=True)
class Statement:
    """A statement of the paper and the quantity that tests it.

    Attributes:
        name: argument of `softcradle claims`.
        statement: text of the statement.
        place: section or figure of the paper that contains the statement.
        quantity: description of the value of a case.
        variable: name of the number by which cases are sorted; the claim is expected to hold if it is small.
        how: description of the measurement, with ranges and seeds.
        remark: explanation of the result.
        own: parameters of the case that the paper describes.
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
        cases: measured cases in ascending order of the variable.
        chosen: True if the allowed value is our reading of the statement. False if the statement names it.
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
        """Return the cases whose outcome is `side`."""
        return [case for case in self.cases if case.side is side]

    @cached_property
    def own_case(self) -> Case:
        """Measured case whose parameters are nearest to the parameters of the paper."""
        return min(self.cases, key=self.distance)

    def distance(self, case: Case) -> float:
        """Return the distance between the parameters of `case` and the parameters of the paper.

        The distance is the sum of the absolute logarithms of the ratios of parameters.
        """
        return sum(_apart(case.parameters[name], value) for name, value in self.own.items())

    @cached_property
    def limit(self) -> float | None:
        """Largest value of the variable up to which no case fails and at least one holds.

        The limit is None if the first cases do not hold.
        """
        last = None
        for variable, sides in self._sides:
            if CaseOutcome.FAILS in sides:
                break
            last = variable if CaseOutcome.HOLDS in sides else last
        return last

    @cached_property
    def _sides(self) -> list[tuple[float, set[CaseOutcome]]]:
        """Return the values of the variable, each with the outcomes of its cases."""
        groups = groupby(self.cases, key=lambda case: case.variable)
        return [(variable, {case.side for case in group}) for variable, group in groups]

    @cached_property
    def range_of_own(self) -> tuple[float, float]:
        """Return the range of the variable around the paper's own value in which no case fails and some cases hold.

        An end of the range is infinite if no case fails beyond it. The result is (nan, nan) if a case fails at the
        paper's own value.
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
        """Verdict that follows from the cases; see :class:`Verdict`."""
        own = self.own_case.side
        if own is CaseOutcome.UNDETERMINED:
            return Verdict.UNDETERMINED
        if own is CaseOutcome.FAILS:
            return Verdict.BEYOND
        return Verdict.WITHIN if self.on(CaseOutcome.FAILS) else Verdict.HOLDS

    @property
    def verdict_text(self) -> str:
        """Verdict as text, with its limit and the number of undetermined cases."""
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
        """Return a text with the range around the paper's own case in which no case fails.

        If there is no such range, the text gives the number of cases that hold.
        """
        low, high = self.range_of_own
        bounds = [f">= {low:.3g}"] * math.isfinite(low) + [f"<= {high:.3g}"] * math.isfinite(high)
        if low == high or not bounds:
            return f"{len(self.on(CaseOutcome.HOLDS))} of {len(self.cases)} cases"
        return f"{self.variable} {' and '.join(bounds)}"

    def _fails_throughout(self, holding: int) -> str:
        """Return the verdict for a claim that fails in the paper's own case and does not hold in any range."""
        first = self.cases[0].variable
        return f"fails beyond {self.variable} = {first:.3g}, the least tried" + (
            f"; holds in {holding} of {len(self.cases)}" if holding else ""
        )

    @cached_property
    def counter_example(self) -> Case | None:
        """Failing case whose parameters are nearest to the parameters of the paper; None if no case fails."""
        return min(self.on(CaseOutcome.FAILS), key=self.distance, default=None)

    @property
    def bar_text(self) -> str:
        """Text that gives the allowed values at which the verdict would change. The text is empty if the paper names
        the value.
        """
        own = self.own_case
        if not self.chosen or own.side is CaseOutcome.UNDETERMINED:
            return ""
        # A case fails if the allowed value is below its entry of `lowest`.
        lowest = [case.value - case.error for case in self.cases]
        most = max(value for value in lowest if math.isfinite(value))
        low, high = own.value - own.error, own.value + own.error
        within = f", holds within from {high:.3g}" if high < most else ""
        return f"by the bar: fails beyond below {low:.3g}{within}, holds from {max(most, high):.3g}"

    @property
    def range_text(self) -> str:
        """Range of each parameter as text."""
        names = self.cases[0].parameters
        spans = {name: sorted({case.parameters[name] for case in self.cases}) for name in names}
        return ", ".join(f"{name} = {_span(values)}" for name, values in spans.items())

    @property
    def measured_text(self) -> str:
        """Sentences that describe the paper's own case, the number of cases that hold and the nearest counter-example."""
        own = self.own_case
        parts = [f"{self.quantity}: {case_text(own)}; at most {own.allowed:.3g} allowed"]
        counts = [f"{len(self.on(side))} {side}" for side in CaseOutcome if self.on(side)]
        parts.append(f"{len(self.cases)} cases: {', '.join(counts)}")
        if self.counter_example is not None and self.counter_example is not own:
            parts.append(f"nearest counter-example: {case_text(self.counter_example)}")
        parts += [text for text in (self.bar_text, self.remark) if text]
        return ". ".join(parts)


def case_text(case: Case) -> str:
    """Return a text with the value of a case, its error bar and its parameters."""
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
        measure: function that computes the quantity from the parameters of a case and a MethodFineness.
        cases: parameters of all cases.
        order: function that computes the variable of a case from its parameters.
        allowed: largest value of the quantity for which the claim holds.
        chosen: True if `allowed` is our reading of the statement; see JudgedClaim.
        first: method that measures the quantity.
        second: method that measures it again for the error bars.
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
        """Return the study of measured cases.

        If `reference` is given, it widens the error bar of the paper's own case.
        """
        stated = {field.name: getattr(self, field.name) for field in fields(Statement)}
        study = JudgedClaim(**stated, cases=cases, chosen=self.chosen, reference=reference, seconds=seconds)
        return _with_reference(study) if self.refer else study

    def reference(self) -> float:
        """Return the value of the paper's own case by the independent reference, or NaN if `refer` is False."""
        if not self.refer:
            return math.nan
        blank = [self.measured(each) for each in self.cases]
        return self.value(self.study_of(blank).own_case.parameters, REFERENCE)[0]

    def measured(
        self, parameters: Parameters, value: float = math.nan, error: float = math.nan, reason: str = ""
    ) -> Case:
        """Return a case with its parameters and the measured quantity."""
        return Case(dict(parameters), self.order(parameters), value, error, self.allowed, reason)

    def case(self, parameters: Parameters) -> Case:
        """Measure the quantity and its error bar for `parameters`."""
        value, reason = self.value(parameters, self.first)
        other, _ = self.value(parameters, self.second) if not reason else (math.nan, reason)
        reason = reason or ("" if math.isfinite(other) else "the second method found nothing")
        return self.measured(parameters, value, abs(value - other), reason)

    def value(self, parameters: Parameters, solver: MethodFineness) -> tuple[float, str]:
        """Measure the quantity with `solver`.

        Return the value and a text. If the value is NaN, the text contains the reason.
        """
        try:
            value = float(self.measure(parameters, solver))
        except NotSolvedError as error:
            return math.nan, str(error)
        return value, "" if math.isfinite(value) else "the quantity does not exist"


def _with_reference(study: JudgedClaim) -> JudgedClaim:
    """Return `study` with the value of the reference included in the error bar of the paper's own case."""
    own = study.own_case
    error = max(own.error, abs(own.value - study.reference)) if math.isfinite(study.reference) else own.error
    return replace(study, cases=[replace(case, error=error) if case is own else case for case in study.cases])


def grid(**values: ArrayLike) -> list[Parameters]:
    """Return the parameters of all combinations of the named values. Each name has one value or several."""
    columns = [np.atleast_1d(column).tolist() for column in values.values()]
    return [dict(zip(values, map(float, case), strict=True)) for case in product(*columns)]
