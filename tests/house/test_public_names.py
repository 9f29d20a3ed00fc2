"""The public names of `physics`: exactly these, importable, documented."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

import pytest

from softcradle import physics

PUBLIC = [
    "Chain",
    "Contact",
    "METHODS",
    "SoftChain",
    "SoftContact",
    "State",
    "Trajectory",
    "advance",
    "cluster_on_cluster",
    "draft_gear",
    "ensemble",
    "hertz",
    "hooke",
    "one_on",
    "power_law",
    "simulate",
    "stable_step",
    "step_force",
]


def test_exactly_these():
    assert sorted(physics.__all__) == PUBLIC
    assert dir(physics) == PUBLIC


@pytest.mark.parametrize("name", PUBLIC)
def test_importable_and_documented(name):
    value = getattr(physics, name)
    assert inspect.getdoc(value)
    if callable(value):
        assert value.__name__ == name
        assert value.__module__.startswith("physics.")


def test_type_checkers_see_the_same_names():
    tree = ast.parse(Path(physics.__file__).read_text())
    declared = [
        alias.asname
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("physics.")
        for alias in node.names
    ]
    assert sorted(name for name in declared if name) == PUBLIC


def test_other_names_are_refused():
    with pytest.raises(AttributeError, match="module 'physics' has no attribute 'Chian'"):
        physics.Chian  # noqa: B018


def test_methods_are_described():
    names = [method.name for method in physics.METHODS]
    assert len(set(names)) == len(names)
    assert {"euler", "verlet", "yoshida4", "pymunk", "scipy"} <= set(names)
    for method in physics.METHODS:
        assert method.order >= 1
        assert method.summary
        assert "\n" not in method.summary
