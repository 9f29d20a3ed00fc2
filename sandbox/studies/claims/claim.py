"""A claim of the paper as something to measure, and its measurement: every case by one method and again by a second."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike
from softcradle.sandbox.studies.claims.solver import MEASURING, REFERENCE, SECOND, NotSolvedError, Solver
from softcradle.sandbox.studies.claims.study import Case, Study

Parameters = Mapping[str, float]
Measure = Callable[[Parameters, Solver], float]


@dataclass(frozen=True)
class Claim:
    """What the paper says, and how to find out.

    Attributes:
        name, statement, place, quantity, variable, how, remark, own: as in Study.
        measure: the quantity at the parameters of a case, by a Solver.
        cases: parameters of all cases.
        order: the variable of a case, from its parameters.
        allowed: the claim holds where the quantity is at most this.
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

    def study(self) -> Study:
        """Measure all cases, and the paper's own by the reference."""
        found = [self.case(parameters) for parameters in self.cases]
        study = Study(
            self.name, self.statement, self.place, self.quantity, self.variable, self.how, self.remark, self.own, found
        )
        if not self.refer:
            return study
        reference, _ = self.value(study.own_case.parameters, REFERENCE)
        return _with_reference(study, reference)

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


def _with_reference(study: Study, reference: float) -> Study:
    """`study` with the reference's value, which widens the error bar of the paper's own case."""
    own = study.own_case
    error = max(own.error, abs(own.value - reference)) if math.isfinite(reference) else own.error
    cases = [replace(case, error=error) if case is own else case for case in study.cases]
    return replace(study, cases=cases, reference=reference)


def grid(**values: ArrayLike) -> list[Parameters]:
    """Parameters of all combinations of the named values, several or one of each."""
    found: list[dict[str, float]] = [{}]
    for name, column in values.items():
        found = [{**case, name: float(value)} for case in found for value in np.atleast_1d(column)]
    return list(found)
