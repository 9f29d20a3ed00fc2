"""Without the packages of an extra: what needs them says how to get them, in a sentence; the rest works."""

import subprocess

import pytest
from softcradle.physics.extras import EXTRA_OF, needed_for

from tests.helpers.own_process import python
from tests.helpers.paths import ROOT

MAIN = "from softcradle.sandbox.cli.main import main\nsys.exit(main({arguments!r}))"
PYMUNK_GAME = """
import pymunk
from softcradle import SoftChain, SoftContact, hertz
space, balls = pymunk.Space(), [pymunk.Body(mass=1, moment=1) for _ in range(3)]
for i, ball in enumerate(balls):
    ball.position = i, 0
balls[0].velocity = 1, 0
space.add(*balls, *SoftChain(balls, hertz(100), touching_distances=1))
for _ in range(90):
    space.step(1 / 60)
assert sum(ball.velocity.x for ball in balls) > 0.99
assert not SoftContact(*balls[:2], (0, 0), (0, 0), 1, hertz(100)).native
"""
METHODS = """
from softcradle import METHODS, hertz, one_on, simulate
for method in METHODS:
    found = simulate(one_on(2, hertz(1.0)), [1, 0, 0], method=method.name, samples=3)
    assert abs(found.momentum[-1] - 1.0) < 1e-9, method.name
"""


def run(without: tuple[str, ...], program: str) -> subprocess.CompletedProcess[str]:
    return python("-c", f"import sys\nfor name in {without!r}: sys.modules[name] = None\n{program}", check=False)


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
    done = run(tuple(EXTRA_OF), program)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_every_method_runs_without_numba_and_says_that_it_is_slow():
    done = run(("numba",), METHODS)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("pip install 'softcradle[fast]'") == 1


def test_other_missing_modules_are_not_hidden():
    with pytest.raises(ModuleNotFoundError, match="nowhere"), needed_for("it"):
        import nowhere  # type: ignore[import-not-found]  # noqa: F401
