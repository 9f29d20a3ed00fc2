"""The public names of softcradle: exactly these, importable, documented, the same from `softcradle.physics`."""

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


def test_importable_and_documented():
    for name in PUBLIC:
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


def test_no_module_has_a_public_name():
    """Python binds a module to its package on import: `physics.ensemble` would be the module, once that is imported."""
    assert [name for name in PUBLIC if (ROOT / "physics" / f"{name}.py").exists()] == []
