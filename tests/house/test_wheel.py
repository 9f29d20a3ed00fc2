"""Tests of the wheel. The wheel must contain one top-level name and all files. The installed package must work next to
a user's folder with the name `physics`.
"""

import os
import re
import subprocess
import sys
import sysconfig
import tarfile
import venv
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest

from hatch_build import addresses
from tests.helpers.own_process import python
from tests.helpers.paths import LAYERS, ROOT

pytestmark = pytest.mark.slow

PIP = (sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet")
BUILD = (*PIP, "wheel", "--no-deps", "--no-index", "--no-build-isolation", "--wheel-dir")

ASSETS = (
    "theme.json",
    "icon.png",
    "Inter-Regular.otf",
    "Inter-SemiBold.otf",
    "page.min.js",
    "page/page.css",
    "page/kernels.wasm",
)

# The user's game contains folders with the same names as the folders of the package.
GAME = """
import physics, sandbox, scenes
assert [module.OF for module in (physics, sandbox, scenes)] == ["the game"] * 3
from softcradle import SoftContact, one_on, power_law, simulate
import softcradle.physics, softcradle.scenes, softcradle.sandbox
print(simulate(one_on(1, power_law(1.0, 1.0)), [1, 0], method="verlet").final_velocity.round(3) + 0.0)
"""

# This program imports every module of the package that needs only the core dependencies. The program prints the paths
# of modules and assets.
EVERY_FILE = f"""
import importlib, pkgutil, softcradle
from softcradle.sandbox.files import resource
print(*map(resource, {ASSETS}), sep="\\n")
names = [found.name for found in pkgutil.walk_packages(softcradle.__path__, "softcradle.")]
for name in names:
    if not name.endswith(("_peer", ".__main__")):
        print(importlib.import_module(name).__file__)
"""


def test_addresses_that_are_not_known_are_left_out():
    unknown = {"repository": "", "site": "", "doi": ""}
    assert addresses(unknown) == {}
    known = addresses({"repository": "https://example.org/r", "site": "https://example.org", "doi": "10.1/2"})
    assert known == {
        "Documentation": "https://example.org",
        "Repository": "https://example.org/r",
        "DOI": "https://doi.org/10.1/2",
    }


@dataclass(frozen=True)
class Installed:
    """The wheel, installed in its own environment, and a user's folder in which commands run."""

    python: Path
    packages: Path
    game: Path

    def run(self, *command: str | Path) -> str:
        """Return the output of a command that runs in the user's folder. The Python interpreter does not find the
        source files of the repository.
        """
        left_out = ("PYTHON", "NUMBA_", "VIRTUAL_ENV")
        kept = {key: value for key, value in os.environ.items() if not key.startswith(left_out)}
        quick = {"NUMBA_DISABLE_JIT": "1", "SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy", "PYTHONUTF8": "1"}
        environment = kept | quick | {"SOFTCRADLE_CACHE": str(self.game / "cache")}
        done = subprocess.run(command, cwd=self.game, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout


def built(source: Path, folder: Path) -> Path:
    subprocess.run([*BUILD, str(folder), str(source)], cwd=folder.parent, check=True)
    (wheel,) = folder.glob("*.whl")
    return wheel


def contents(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        return set(archive.namelist())


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built(ROOT, tmp_path_factory.mktemp("built") / "wheel")


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """Install the wheel in a new environment. The new environment uses the dependencies of the present environment, but
    not its .pth files.
    """
    home = tmp_path_factory.mktemp("installed")
    builder = venv.EnvBuilder(symlinks=os.name != "nt")
    made = builder.ensure_directories(home / "environment")
    builder.create(home / "environment")
    subprocess.run([*PIP, "--python", made.env_exe, "install", "--no-deps", "--no-index", str(wheel)], check=True)
    packages = Path(sysconfig.get_path("purelib", "venv", {"base": made.env_dir}))
    dependencies = {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}
    (packages / "dependencies.pth").write_text("\n".join(dependencies), encoding="utf-8")
    game = home / "game"
    for name in LAYERS:
        (game / name).mkdir(parents=True)
        (game / name / "__init__.py").write_text('OF = "the game"\n', encoding="utf-8")
    (game / "game.py").write_text(GAME, encoding="utf-8")
    return Installed(Path(made.env_exe), packages, game)


def test_everything_is_in_it_and_nothing_else(wheel):
    licences = {name.partition(".dist-info/licenses/")[2] for name in contents(wheel)}
    assert licences >= {"LICENSE", "assets/Inter-LICENSE.txt"}
    homes = {"softcradle": "softcradle", "assets": "softcradle/sandbox/assets"}
    homes |= {layer: f"softcradle/{layer}" for layer in LAYERS}
    expected = {
        f"{home}/{path.relative_to(ROOT / folder).as_posix()}"
        for folder, home in homes.items()
        for path in (ROOT / folder).rglob("*")
        if path.is_file()
        and "__pycache__" not in path.parts
        and path.suffix != ".po"  # The wheel contains the compiled catalogues instead.
        # The folder `peers` contains other integrators. Only the chart in the repository uses these integrators.
        and "peers" not in path.parts
    }
    assert {name for name in contents(wheel) if ".dist-info/" not in name} == expected


def test_the_description_shows_no_file_that_an_index_does_not_have(wheel):
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        text = archive.read(name).decode()
    assert "Description-Content-Type: text/markdown" in text
    headings = re.findall(r"^## .+$", (ROOT / "README.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert re.findall(r"^## .+$", text, re.MULTILINE) == headings
    assert "](" not in text  # The description contains neither links nor pictures.


def test_the_source_archive_builds_the_same_wheel(wheel, tmp_path):
    command = [sys.executable, "-m", "hatchling", "build", "--target", "sdist", "--directory", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (archive,) = tmp_path.glob("*.tar.gz")
    assert contents(built(archive, tmp_path / "wheel")) == contents(wheel)
    with tarfile.open(archive) as opened:
        names = {name.partition("/")[2] for name in opened.getnames()}
    kept = {"README.md", "hatch_build.py", "LICENSE", "CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md"}
    pages = [*(ROOT / "docs").glob("*.md"), *(ROOT / "examples").rglob("*.ipynb"), *(ROOT / "examples").rglob("*.py")]
    kept |= {path.relative_to(ROOT).as_posix() for path in pages}
    pictures = [path.relative_to(ROOT) for path in (ROOT / "docs").glob("**/*.png")]
    shown = {path.as_posix() for path in pictures if path.parts[1] not in ("_made", "gallery")}
    assert len(shown) >= 15
    assert names >= kept | shown


def test_every_module_and_asset_comes_from_the_wheel(installed):
    files = [Path(line) for line in installed.run(installed.python, "-c", EVERY_FILE).splitlines()]
    assert len(files) > 200
    assert [file for file in files if not file.is_relative_to(installed.packages / "softcradle")] == []


def test_the_wheel_works_next_to_a_folder_named_physics(installed):
    assert installed.run(installed.python, "game.py") == "[0. 1.]\n"
    printed = installed.run(installed.python, "-m", "softcradle", "run", "one-on-four")
    assert "0.5675856" in printed  # This number is the final velocity of the first bead [m/s].
    assert "accurate, tolerance 1e-08" in printed
    assert "one-on-four" in installed.run(installed.python.with_name("softcradle"), "scenes")
    program = "from softcradle.sandbox.languages import _, use_language\nuse_language('de')\nprint(ascii(_('Undo')))"
    assert installed.run(installed.python, "-c", program) == ascii("Rückgängig") + "\n"


USER_SCRIPT = """
from typing import assert_type

import numpy as np
import pymunk
import softcradle
from numpy.typing import NDArray
from softcradle import Chain, Contact, SoftChain, State, Trajectory, advance, draft_gear, one_on, power_law, simulate, warm

chain = one_on(4, power_law(f0=1.0, alpha=0.1))
result = simulate(chain, velocity=[1, 0, 0, 0, 0], samples=np.linspace(0.0, 1.0, 5))
assert_type(chain, Chain)
assert_type(result, Trajectory)
assert_type(result.final_velocity, NDArray[np.float64])
assert_type(result.contact_intervals[0][0], tuple[float, float])
assert_type(power_law(1.0, 0.1).force(0.5), float)
assert_type(power_law(1.0, 0.1).force([0.5, 1.0]), NDArray[np.float64])
assert_type(softcradle.__version__, str)
state = State.at_start(chain, [1, 0, 0, 0, 0])
advance(chain, state, 0.1)
softcradle.simulat  # type: ignore[attr-defined]
one_on("4", power_law(1.0, 0.1))  # type: ignore[arg-type]
simulate(chain, [1, 0], metod="verlet")  # type: ignore[call-arg]
bodies = [pymunk.Body(1, 1), pymunk.Body(1, 1)]
pymunk.Space().add(*bodies, *SoftChain(bodies, draft_gear(770, 0.0177), 1.0))
warm("verlet")
"""


def test_a_user_s_script_is_type_checked_against_the_wheel(installed):
    """Check a script with type errors. Each line with an ignore comment is wrong. With --strict, mypy also reports an
    ignore comment that is not needed.
    """
    pytest.importorskip("mypy")
    (installed.game / "user.py").write_text(USER_SCRIPT, encoding="utf-8")
    words = ("-m", "mypy", "--strict", "--python-executable", str(installed.python), "user.py")
    kept = {key: value for key, value in os.environ.items() if key not in ("MYPYPATH", "PYTHONPATH")}
    assert python(*words, env=kept, cwd=installed.game).stdout == "Success: no issues found in 1 source file\n"
