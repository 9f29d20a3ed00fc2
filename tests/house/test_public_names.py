"""The public names of softcradle: exactly these, importable, documented, the same from `softcradle.physics`."""

from __future__ import annotations

import ast
import inspect
import tomllib
from pathlib import Path

import pytest

import softcradle
from softcradle import physics
from tests.helpers.paths import ROOT

PUBLIC = [
    "Chain",
    "ChainBatch",
    "Contact",
    "Coupler",
    "EnsembleEnds",
    "METHODS",
    "OwnLaw",
    "SoftChain",
    "SoftContact",
    "State",
    "TimedForce",
    "Trajectory",
    "advance",
    "cluster_on_cluster",
    "draft_gear",
    "ensemble",
    "ensemble_ends",
    "hertz",
    "hooke",
    "one_on",
    "power_law",
    "simulate",
    "stable_step",
    "step_force",
    "warm",
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
        assert value.__module__.startswith("softcradle.physics.")
        assert getattr(softcradle, name) is value


@pytest.mark.parametrize("package", [softcradle, physics])
def test_type_checkers_see_the_same_names(package):
    tree = ast.parse(Path(package.__file__).read_text(encoding="utf-8"))
    declared = [
        alias.asname
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("softcradle.physics")
        for alias in node.names
    ]
    assert sorted(name for name in declared if name) == PUBLIC


@pytest.mark.parametrize("package", [softcradle, physics])
def test_other_names_are_refused(package):
    with pytest.raises(AttributeError, match=f"^module '{package.__name__}' has no attribute 'Chian'$"):
        package.Chian  # noqa: B018


def test_a_star_import_gives_the_public_names():
    names: dict[str, object] = {}
    exec("from softcradle import *", names)  # an import of this kind is for the top of a module alone
    assert sorted(names.keys() - {"__builtins__"}) == sorted([*PUBLIC, "play", "sweep"])


def test_the_version_is_that_of_the_project():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert softcradle.__version__ == project["version"]
    assert dir(softcradle) == sorted([*PUBLIC, "__version__", "play", "sweep"])


@pytest.mark.parametrize("name", PUBLIC)
def test_no_module_has_a_public_name(name):
    """Python binds a module to its package on import: `physics.ensemble` would be the module, once that is imported."""
    assert not (ROOT / "physics" / f"{name}.py").exists()


def test_methods_are_described():
    names = [method.name for method in physics.METHODS]
    assert len(set(names)) == len(names)
    assert {"euler", "verlet", "yoshida4", "pymunk", "scipy"} <= set(names)
    for method in physics.METHODS:
        assert method.order >= 1
        assert method.summary
        assert "\n" not in method.summary


def public_definitions(name: str) -> list[ast.FunctionDef]:
    """The function of that name, or the methods of the class, without private ones."""
    value = getattr(physics, name)
    if not callable(value):
        return []
    tree = ast.parse(inspect.getsource(value))
    nodes = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    return [node for node in nodes if not node.name.startswith("_") or node.name == "__init__"]


@pytest.mark.parametrize("name", PUBLIC)
def test_public_signatures_say_what_they_take(name):
    for definition in public_definitions(name):
        given = definition.args
        arguments = [*given.posonlyargs, *given.args, *given.kwonlyargs]
        annotations = [definition.returns, *(argument.annotation for argument in arguments)]
        texts = [ast.unparse(annotation) for annotation in annotations if annotation is not None]
        assert not [text for text in texts if "Any" in text], definition.name


@pytest.mark.parametrize("name", ["SoftContact", "SoftChain"])
def test_help_shows_a_cradle(name):
    text = inspect.getdoc(getattr(softcradle, name)) or ""
    assert "A cradle in ten lines" in text
    assert f">>> from softcradle import {name}, hertz" in text
    assert ">>> for _ in range(" in text
