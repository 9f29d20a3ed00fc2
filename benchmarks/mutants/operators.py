"""The mutants of a source: each has one constant, comparison, operator, condition, `min`, `max` or result changed."""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

SWAPPED: dict[type[ast.AST], type[ast.AST]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.BitOr: ast.BitAnd,
    ast.BitAnd: ast.BitOr,
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.And: ast.Or,
    ast.Or: ast.And,
    ast.Break: ast.Continue,
    ast.Continue: ast.Break,
}
EXACT = (ast.Eq, ast.NotEq, ast.Is, ast.IsNot)  # comparisons whose change is their negation
EXTREMES = {"min": "max", "max": "min"}
SMALL = 0.01  # a constant below is a tolerance: it grows a thousandfold, where others grow by one


@dataclass(frozen=True)
class Mutant:
    """One change of a source.

    Attributes:
        line: its number, from 1.
        before, after: what stood there and stands there now.
        start, end: of the change, in letters from the beginning.
    """

    line: int
    before: str
    after: str
    start: int
    end: int

    def apply(self, source: str) -> str:
        """The changed source."""
        return source[: self.start] + self.after + source[self.end :]


def mutants_of(source: str) -> list[Mutant]:
    """All mutants of `source`, in the order of its text. Docstrings, annotations, decorators and imports are left alone."""
    lines = source.splitlines(keepends=True)
    starts = [0, *accumulate(map(len, lines))]

    def place(line: int, column: int) -> int:
        return starts[line - 1] + len(lines[line - 1].encode()[:column].decode())  # columns of ast count bytes

    found = []
    for node, changed in (pair for code in _code(ast.parse(source)) for pair in _changes(code)):
        start, end = place(node.lineno, node.col_offset), place(node.end_lineno, node.end_col_offset)
        after = ast.unparse(changed)
        enclosed = isinstance(changed, ast.expr) and not isinstance(changed, ast.Constant | ast.Call)
        found.append(Mutant(node.lineno, source[start:end], f"({after})" if enclosed else after, start, end))
    return sorted(found, key=lambda mutant: (mutant.start, mutant.end, mutant.after))


def _code(node: ast.AST) -> Iterator[Any]:
    """The expressions and statements in `node` that compute something."""
    for name, value in ast.iter_fields(node):
        if name in ("decorator_list", "annotation", "returns"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if not isinstance(child, ast.AST) or isinstance(child, ast.Import | ast.ImportFrom | ast.JoinedStr):
                continue
            if isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant):
                continue
            if isinstance(child, ast.expr | ast.stmt):
                yield child
            yield from _code(child)


def _changes(node: Any) -> Iterator[tuple[Any, ast.AST]]:
    """What is changed in `node`, itself or its condition, and what it becomes."""
    if isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield node, ast.Constant(not node.value)
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        yield node, ast.Constant(_nudged(node.value))
    elif isinstance(node, ast.BinOp | ast.AugAssign | ast.BoolOp) and type(node.op) in SWAPPED:
        yield node, _with(node, "op", SWAPPED[type(node.op)]())
    elif isinstance(node, ast.Compare):
        for k, operator in enumerate(node.ops):
            if type(operator) in SWAPPED:
                yield node, _with(node, "ops", [*node.ops[:k], SWAPPED[type(operator)](), *node.ops[k + 1 :]])
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
        yield node, node.operand
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in EXTREMES:
        yield node, _with(node, "func", ast.Name(EXTREMES[node.func.id]))
    elif isinstance(node, ast.Return) and isinstance(node.value, ast.Name | ast.BinOp):
        yield node, ast.Return(ast.UnaryOp(ast.USub(), node.value))
    elif isinstance(node, ast.Break | ast.Continue):
        yield node, SWAPPED[type(node)]()
    elif isinstance(node, ast.If | ast.While | ast.IfExp) and not _is_exact(node.test):
        yield node.test, ast.UnaryOp(ast.Not(), node.test)


def _is_exact(test: ast.expr) -> bool:
    """Whether a condition is a comparison that is negated by its own change."""
    return isinstance(test, ast.Compare) and isinstance(test.ops[0], EXACT)


def _nudged(value: float) -> float:
    return 1000.0 * value if value != 0 and abs(value) < SMALL else value + 1


def _with(node: Any, field: str, value: object) -> Any:
    changed = copy.copy(node)
    setattr(changed, field, value)
    return changed
