"""A claim of the paper as something to measure, and its measurement: every case by one method and again by a second."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike
from softcradle.sandbox.studies.claims.study import Case, Study
from softcradle.sandbox.studies.paper import MEASURING, REFERENCE, SECOND, NotSolvedError, Parameters, Solver

Measure = Callable[[Parameters, Solver], float]


@dataclass(frozen=True, kw_only=True)
class Claim:
    """What the paper says, and how to find out.

    Attributes:
        name, statement, place, quantity, variable, how, remark, own: as in Study.
        measure: the quantity at the parameters of a case, by a Solver.
        cases: parameters of all cases.
        order: the variable of a case, from its parameters.
        allowed: the claim holds where the quantity is at most this.
        chosen: as in Study.
        first: the method that measures.
        second: the method that error bars come from.
        refer: whether the independent reference measures the paper's own case, too.
    """

    name: str
    statement: str
    place: str
    quantity: str
    measure: Measure
    cases: Sequence[Parameters]
    own: Parameters
    variable: str
    order: Callable[[Parameters], float]
    allowed: float
    how: str
    remark: str = ""
    second: Solver = field(default=SECOND)
    first: Solver = field(default=MEASURING)
    refer: bool = True
    chosen: bool = True

    def study(self) -> Study:
        """Measure all cases, and the paper's own by the reference."""
        return self.study_of([self.case(parameters) for parameters in self.cases], self.reference())

    def study_of(self, cases: Sequence[Case], reference: float = math.nan, seconds: float = 0.0) -> Study:
        """The study of cases that are measured; the reference's value widens the error bar of the paper's own."""
        study = Study(
            self.name, self.statement, self.place, self.quantity, self.variable, self.how, self.remark, self.own, cases,
            self.chosen, reference, seconds,
        )  # fmt: skip
        return _with_reference(study) if self.refer else study

    def reference(self) -> float:
        """The value of the paper's own case by the independent reference; nan where that is not asked."""
        if not self.refer:
            return math.nan
        blank = [Case(each, self.order(each), math.nan, math.nan, self.allowed) for each in self.cases]
        return self.value(self.study_of(blank).own_case.parameters, REFERENCE)[0]

    def case(self, parameters: Parameters) -> Case:
        """The quantity at `parameters` and its error bar."""
        value, reason = self.value(parameters, self.first)
        other, _ = self.value(parameters, self.second) if not reason else (math.nan, reason)
        reason = reason or ("" if math.isfinite(other) else "the second method found nothing")
        return Case(dict(parameters), self.order(parameters), value, abs(value - other), self.allowed, reason)

    def value(self, parameters: Parameters, solver: Solver) -> tuple[float, str]:
        """The quantity by that method, and why there is none (nan) or empty."""
        try:
            value = float(self.measure(parameters, solver))
        except NotSolvedError as error:
            return math.nan, str(error)
        return value, "" if math.isfinite(value) else "the quantity does not exist"


def _with_reference(study: Study) -> Study:
    """`study` with the reference's value in the error bar of the paper's own case."""
    own = study.own_case
    error = max(own.error, abs(own.value - study.reference)) if math.isfinite(study.reference) else own.error
    return replace(study, cases=[replace(case, error=error) if case is own else case for case in study.cases])


def grid(**values: ArrayLike) -> list[Parameters]:
    """Parameters of all combinations of the named values, several or one of each."""
    found: list[dict[str, float]] = [{}]
    for name, column in values.items():
        found = [{**case, name: float(value)} for case in found for value in np.atleast_1d(column)]
    return list(found)
