"""Tests of an installation without optional packages.

A command that needs a missing package must name the extra that installs it. All other commands must work.
"""

import pytest
from softcradle.physics.extras import EXTRA_OF, needed_for
from softcradle.sandbox.languages.translation import compiled_catalogue

from tests.helpers.own_process import python
from tests.helpers.paths import ROOT

MAIN = "from softcradle.sandbox.cli.main import main\nsys.exit(main({arguments!r}))"
PYMUNK_GAME = """
from softcradle import hertz
from tests.helpers.spaces import chain_row, pair, run
space, balls, _ = chain_row(hertz(100), beads=3)
run(space, 1 / 60, 90)
assert balls[-1].velocity.x > 0.5
assert not pair(law=hertz(100))[2].native
"""
METHODS = """
from softcradle import METHODS, hertz, one_on, simulate
for method in METHODS:
    found = simulate(one_on(2, hertz(1.0)), [1, 0, 0], method=method.name, samples=3)
    assert abs(found.momentum[-1] - 1.0) < 1e-9, method.name
"""


def run(without, program):
    program = f"import sys\nfor name in {without!r}: sys.modules[name] = None\n{program}"
    return python("-c", program, check=False, PYTHONPATH=str(ROOT))


@pytest.mark.parametrize(
    ("package", "arguments", "extra"),
    [
        ("av", ["render", "one-on-four", "-o", "x.mp4"], "film"),
        ("pygame", ["render", "one-on-four", "-o", "x.png"], "film"),
        ("pygame", ["play"], "window"),
        ("pygame_gui", ["play"], "window"),
        ("matplotlib", ["chart"], "figures"),
        pytest.param("matplotlib", ["figures", "1b"], "figures", marks=pytest.mark.slow),
        ("zarr", ["sweep", str(ROOT / "examples" / "softness-and-size.toml")], "sweep"),
    ],
)
def test_a_missing_extra_is_a_sentence(package, arguments, extra, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    done = run((package,), MAIN.format(arguments=arguments))
    what = "a sweep that is kept as .zarr" if package == "zarr" else f"softcradle {arguments[0]}"
    expected = f"{what} needs {package}, which is not installed: pip install 'softcradle[{extra}]'"
    assert done.stderr.splitlines()[-1] == f"softcradle: {expected}"
    assert done.returncode == 2
    assert list(tmp_path.iterdir()) == []


CORE = "scenes", "run one-on-four --method verlet --step 1e-2", "check mixed", "page one-on-four -o page.html"


@pytest.mark.parametrize("program", [PYMUNK_GAME, *(MAIN.format(arguments=words.split()) for words in CORE)])
def test_games_and_commands_of_the_core_need_no_extra(program, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # Catalogues of messages that were edited since the installation can only be read with Babel.
    edited = not all(map(compiled_catalogue, ("de", "fr")))
    done = run(tuple(name for name in EXTRA_OF if name != "babel" or not edited), program)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_every_method_runs_without_numba():
    done = run(("numba",), METHODS)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("pip install 'softcradle[fast]'") == 1


def test_other_missing_modules_are_not_hidden():
    with pytest.raises(ModuleNotFoundError, match="nowhere"), needed_for("it"):
        import nowhere  # type: ignore[import-not-found]  # noqa: F401
