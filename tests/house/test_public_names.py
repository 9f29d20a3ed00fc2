"""Tests of the public names. The list of names must be exact, and each name must be importable and documented. Examples
must run, and imports must be fast.
"""

import ast
import doctest
import inspect
import tomllib
from importlib import import_module
from pathlib import Path

import pytest

import softcradle
from softcradle import physics
from tests.helpers.own_process import python
from tests.helpers.paths import LAYERS, ROOT

PUBLIC = [
    "Chain", "ChainBatch", "Contact", "Coupler", "EnsembleEnds", "METHODS", "OwnLaw", "SoftChain", "SoftContact", "State",
    "TimedForce", "Trajectory", "advance", "cluster_on_cluster", "draft_gear", "ensemble", "ensemble_ends", "hertz", "hooke",
    "one_on", "power_law", "simulate", "stable_step", "step_force", "warm",
]  # fmt: skip


def test_exactly_these_are_importable_and_documented():
    assert sorted(physics.__all__) == dir(physics) == PUBLIC
    names: dict[str, object] = {}
    # `import *` is allowed only at module level. Inside a function, `exec` is needed.
    exec("from softcradle import *", names)
    assert sorted(names.keys() - {"__builtins__"}) == sorted([*PUBLIC, "fit", "open_film", "play", "sweep"])
    assert dir(softcradle) == sorted([*PUBLIC, "__version__", "fit", "open_film", "play", "sweep"])
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert softcradle.__version__ == project["version"]
    for name in PUBLIC:
        # A module with the same name as a public object would replace the object in the package when the module is
        # imported.
        assert not (ROOT / "physics" / f"{name}.py").exists()
        value = getattr(physics, name)
        assert inspect.getdoc(value)
        if callable(value):
            assert value.__name__ == name
            assert value.__module__.startswith("softcradle.physics.")
            assert getattr(softcradle, name) is value


@pytest.mark.parametrize("package", [softcradle, physics])
def test_type_checkers_see_the_public_names(package):
    nodes = ast.walk(ast.parse(Path(package.__file__).read_text(encoding="utf-8")))
    imports = [node for node in nodes if isinstance(node, ast.ImportFrom)]
    ours = [node for node in imports if (node.module or "").startswith("softcradle.physics")]
    assert sorted(alias.asname for node in ours for alias in node.names if alias.asname) == PUBLIC
    with pytest.raises(AttributeError, match=f"^module '{package.__name__}' has no attribute 'Chian'$"):
        package.Chian  # noqa: B018


HEAVY = ("numpy", "numba", "scipy", "pymunk", "pygame", "matplotlib", "av", "PIL", "pydantic")


@pytest.mark.parametrize(
    ("code", "absent"),
    [
        ("import softcradle; softcradle.METHODS", HEAVY),
        ("import softcradle.sandbox.cli.main", HEAVY),
        ("import softcradle.physics.simulation", [name for name in HEAVY if name != "numpy"]),
        # The test does not look for SciPy, because Numba imports SciPy if it is installed.
        ("import softcradle.physics.fixed_step.runner", ("pymunk", "pygame")),
        ("import softcradle.physics.reference.runner", ("numba", "pymunk", "pygame")),
        ("import softcradle.sandbox.session.session", [name for name in HEAVY if name not in {"numpy", "pydantic"}]),
    ],
)
def test_imports_are_light(code, absent):
    program = f"{code}; import sys; print([name for name in {tuple(absent)!r} if name in sys.modules])"
    assert python("-c", program, cwd=ROOT).stdout.strip() == "[]"


FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
FILES = [
    path for layer in LAYERS for path in (ROOT / layer).rglob("*.py") if ">>> " in path.read_text(encoding="utf-8")
]
MODULES = [
    "softcradle",
    *sorted(".".join(("softcradle", *path.relative_to(ROOT).with_suffix("").parts)) for path in FILES),
]


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name):
    failed, tried = doctest.testmod(import_module(name), optionflags=FLAGS)
    assert failed == 0 < tried
