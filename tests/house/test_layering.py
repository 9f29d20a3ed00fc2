"""Imports point one way: physics <- scenes <- sandbox; heavy packages stay where the design puts them."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LAYERS = ("physics", "scenes", "sandbox")
MODULES = sorted(path.relative_to(ROOT).as_posix() for layer in LAYERS for path in (ROOT / layer).rglob("*.py"))

# package: the modules (or folders, ending in /) that may import it
PEERS = "sandbox/studies/precision/peers/"
HOMES = {
    # compiled callbacks ask numba for more than jit; peers share no kernel with what they are compared to
    "numba": ("physics/numerics/", "physics/pymunk_contacts/compiled_law.py", PEERS),
    "pymunk": (
        "physics/pymunk_contacts/soft_contact.py",
        "physics/pymunk_contacts/compiled_force.py",
        "physics/pymunk_contacts/post_step.py",
        "physics/pymunk_contacts/soft_chain.py",
        "physics/pymunk_contacts/space_forces.py",
        "physics/pymunk_contacts/runner.py",
        "sandbox/",
    ),
    # the reference, special functions of closed forms, the search for the nearest contact, and peers of the charts
    "scipy": (
        "physics/reference/runner.py",
        "physics/analysis/closed_forms.py",
        "physics/analysis/matching.py",
        PEERS,
    ),
    "pygame": ("sandbox/",),
    "pygame_gui": ("sandbox/",),
    "matplotlib": ("sandbox/",),
    "av": ("sandbox/",),
    "PIL": ("sandbox/",),
    "rich": ("sandbox/",),
    "pydantic": ("scenes/",),
    "CyRK": (PEERS,),
    "heyoka": (PEERS,),
    "numbalsoda": (PEERS,),
    "sksundae": (PEERS,),
    "diffrax": (PEERS,),
    "jax": (PEERS,),
}


def imported(path: str) -> set[str]:
    """Top-level packages and full module names that a file imports anywhere, inside functions too."""
    found: set[str] = set()
    for node in ast.walk(ast.parse((ROOT / path).read_text(), path)):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively"
            found.add(node.module or "")
    return found | {name.partition(".")[0] for name in found}


def test_there_are_modules_in_every_layer():
    for layer in LAYERS:
        assert any(module.startswith(f"{layer}/") for module in MODULES)


@pytest.mark.parametrize("module", MODULES)
def test_imports_point_down(module):
    above = LAYERS[LAYERS.index(module.partition("/")[0]) + 1 :]
    assert not imported(module) & set(above)


@pytest.mark.parametrize("module", MODULES)
def test_packages_stay_at_home(module):
    for package in imported(module) & set(HOMES):
        assert module.startswith(HOMES[package]), f"{module} imports {package}"


def test_the_reference_shares_no_kernel():
    for module in ("physics/reference/runner.py", "physics/reference/phases.py", "physics/analysis/closed_forms.py"):
        assert not [name for name in imported(module) if name.startswith("softcradle.physics.numerics")]


def test_peers_share_no_kernel_with_what_they_are_compared_to():
    for path in (ROOT / "sandbox/precision/peers").glob("*.py"):
        names = imported(path.relative_to(ROOT).as_posix())
        assert not [name for name in names if name.startswith("softcradle.physics.numerics")]


@pytest.mark.parametrize(
    ("code", "absent"),
    [
        ("from softcradle import physics", ("numpy", "numba", "scipy", "pymunk", "pygame")),
        ("from softcradle import physics; physics.METHODS", ("numpy", "numba", "scipy", "pymunk", "pygame")),
        ("from softcradle import physics; physics.Chain", ("numba", "scipy", "pymunk", "pygame")),
        ("import softcradle.physics.simulation", ("numba", "scipy", "pymunk", "pygame")),
        (
            "import softcradle.physics.fixed_step.runner",
            ("pymunk", "pygame"),
        ),  # numba itself takes scipy where it is installed
        ("import softcradle.physics.reference.runner", ("numba", "pymunk", "pygame")),
    ],
)
def test_imports_are_light(code, absent):
    program = f"{code}; import sys; print([name for name in {absent!r} if name in sys.modules])"
    found = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
