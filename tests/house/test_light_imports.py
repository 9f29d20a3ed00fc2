"""Imports are light: what a command or a script does not use is not loaded."""

import subprocess
import sys

import pytest

from tests.helpers.paths import ROOT

HEAVY = ("numpy", "numba", "scipy", "pymunk", "pygame", "matplotlib", "av", "PIL", "pydantic")


@pytest.mark.parametrize(
    ("code", "absent"),
    [
        ("from softcradle import physics", HEAVY),
        ("import softcradle; softcradle.METHODS", HEAVY),
        ("import softcradle.sandbox.cli.main", HEAVY),
        ("from softcradle.physics import Chain", [name for name in HEAVY if name != "numpy"]),
        ("import softcradle.physics.simulation", [name for name in HEAVY if name != "numpy"]),
        ("import softcradle.physics.fixed_step.runner", ("pymunk", "pygame")),  # numba itself takes scipy where it is
        ("import softcradle.physics.reference.runner", ("numba", "pymunk", "pygame")),
        ("import softcradle.scenes", [name for name in HEAVY if name not in {"numpy", "pydantic"}]),
        ("import softcradle.sandbox.session.session", [name for name in HEAVY if name not in {"numpy", "pydantic"}]),
    ],
)
def test_imports_are_light(code, absent):
    program = f"{code}; import sys; print([name for name in {tuple(absent)!r} if name in sys.modules])"
    found = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
