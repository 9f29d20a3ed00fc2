"""What source files import, and where these imports lead in a circle."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from tests.helpers.paths import module_name, source_files

Graph = Mapping[str, set[str]]


def statements(text: str) -> Iterator[tuple[str, str]]:
    """Module and name of each import anywhere in `text`: at the top, in functions, for type checkers; no name: ""."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"relative import of {node.module or '.'}"
            yield from ((node.module, alias.name) for alias in node.names)


@cache
def imported(path: Path) -> frozenset[str]:
    """The modules that a file names in imports; ``from a import b`` gives a and a.b, for b may be a module."""
    found = set(statements(path.read_text(encoding="utf-8")))
    return frozenset({module for module, _ in found} | {f"{module}.{name}" for module, name in found if name})


@cache
def import_graph() -> Graph:
    """Every module of the package, with the modules of the package that it imports.

    ``from softcradle.scenes import catalogue`` leads to `catalogue` alone: Python runs the package's own file as well, but
    if that counted, every package would be in a circle with its modules.
    """
    files = {module_name(path): path for path in source_files()}
    graph = {name: set() for name in files}
    for name, path in files.items():
        for module, attribute in statements(path.read_text(encoding="utf-8")):
            inner = f"{module}.{attribute}"
            graph[name] |= {inner if inner in files else module} & files.keys() - {name}
    return graph


def reachable(graph: Graph, start: str) -> set[str]:
    """Everything that imports lead to from `start`; `start` itself only where they lead back."""
    found, waiting = set(), [start]
    while waiting:
        new = graph[waiting.pop()] - found
        found |= new
        waiting += new
    return found


def cycles(graph: Graph) -> list[set[str]]:
    """Every group of modules in which each leads to each other (the strongly connected components of two and more)."""
    onward = {name: reachable(graph, name) for name in graph}
    groups = {frozenset(other for other in onward[name] if name in onward[other]) for name in graph}
    return sorted((set(group) for group in groups if group), key=sorted)
