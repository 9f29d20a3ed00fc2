"""Imports point one way: physics <- scenes <- sandbox, and so between the rooms of each; none leads in a circle."""

from __future__ import annotations

import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from tests.helpers.imports import cycles, import_graph, imported
from tests.helpers.paths import LAYERS, ROOT, module_name, source_files

# A room is a folder, or a file that lies in none; each imports from itself and from those before it alone.
PHYSICS = (
    *("version", "source_digest", "atomic_files", "checked_input", "extras", "notebook_views", "status"),
    *(
        "contact",
        "coupler",
        "own_law_energy",
        "own_law",
        "timed_force",
        "chain",
        "scales",
        "default_step",
        "state",
        "methods",
        "problem",
    ),
    *(
        "numerics",
        "compile_log",
        "kernel_tiers",
        "kernel_records",
        "python_checkpoints",
        "fixed_step",
        "adaptive",
        "reference",
        "pymunk_contacts",
        "timed_force_runner",
        "dispatch",
    ),
    *(
        "trajectory_file",
        "trajectory_tables",
        "trajectory",
        "advice",
        "simulation",
        "ensemble_runs",
        "batch",
        "warm_up",
        "analysis",
    ),
)
SANDBOX = (
    *(
        "resources",
        "user_error",
        "console",
        "output_files",
        "languages",
        "scene_runs",
        "trajectory_summary",
        "motion_words",
        "motion",
        "sweeps",
    ),
    *("draw", "film", "page", "session", "studies", "window", "notebook", "cli"),
)
ROOMS = (
    *(f"physics.{room}" for room in PHYSICS),
    *("physics", "scenes", "sandbox"),  # `physics` and `sandbox` alone are the files __init__.py of the two
    *(f"sandbox.{room}" for room in SANDBOX),
    *("softcradle", "__main__"),
)
SAME_BASENAME = {
    "__init__.py": "Python's name for the file of a package",
    "__main__.py": "Python's name for what `python -m` runs",
    "runner.py": "each family of methods has one, which is where the family is called",
}

PEERS = "sandbox/studies/precision/peers/"
HOMES = {  # package: the files, or folders ending in /, that may import it
    # compiled callbacks need more of numba than jit; peers share no kernel with what they are compared to
    "numba": ("physics/numerics/", "physics/pymunk_contacts/compiled_law.py", "physics/compile_log.py", PEERS),
    "llvmlite": ("physics/numerics/",),
    "pymunk": (
        "physics/pymunk_contacts/contact_constraint.py",
        "physics/pymunk_contacts/compiled_force.py",
        "physics/pymunk_contacts/post_step.py",
        "physics/pymunk_contacts/soft_chain.py",
        "physics/pymunk_contacts/space_forces.py",
        "physics/pymunk_contacts/runner.py",
        "sandbox/studies/stability/rigid_cradle.py",
        "sandbox/window/hanging/",
    ),
    # the reference, special functions of closed forms, the search for the nearest contact, and peers of the charts
    "scipy": (
        "physics/reference/",
        "physics/analysis/closed_forms.py",
        "physics/analysis/matching.py",
        "sandbox/studies/verify/",
        # sample points, and the version that they depend on
        "sandbox/sweeps/",
        PEERS,
    ),
    "pygame": (
        "sandbox/draw/",
        "sandbox/film/",
        "sandbox/window/",
        "sandbox/notebook/film_view.py",
        "sandbox/cli/commands/play.py",
    ),
    "pygame_gui": ("sandbox/window/",),
    "matplotlib": (
        "sandbox/studies/",
        "sandbox/notebook/figure_view.py",
        # the type of what plot() returns
        "physics/notebook_views.py",
        "physics/trajectory.py",
        "scenes/scene_schema.py",
    ),
    "pandas": ("physics/trajectory_tables.py", "physics/trajectory.py"),
    "xarray": (
        "physics/trajectory_tables.py",
        "physics/trajectory.py",
        "sandbox/sweeps/",
        "sandbox/cli/commands/sweep.py",
    ),
    "zarr": ("sandbox/sweeps/",),
    "h5netcdf": ("sandbox/sweeps/",),
    "h5py": ("sandbox/sweeps/dataset_files.py",),
    "distributed": ("sandbox/sweeps/",),
    "av": ("sandbox/film/",),
    "PIL": ("sandbox/film/",),
    "argcomplete": ("sandbox/cli/",),
    "rich": ("sandbox/console.py", "sandbox/cli/", "sandbox/film/", "sandbox/studies/"),
    "pydantic": ("scenes/", "sandbox/sweeps/"),
    "threadpoolctl": ("physics/reference/one_thread.py",),
    "tomli_w": ("scenes/",),
    "CyRK": (PEERS,),
    "heyoka": (PEERS,),
    "numbalsoda": (PEERS,),
    "sksundae": (PEERS,),
    "diffrax": (PEERS,),
    "jax": (PEERS,),
}
HEAVY = ("numpy", "numba", "scipy", "pymunk", "pygame", "matplotlib", "av", "PIL", "pydantic")

FILES = sorted(path.relative_to(ROOT).as_posix() for path in source_files())


def room(module: str) -> str:
    """The room of a module: sandbox.draw of softcradle.sandbox.draw.text; the whole layer `scenes` is one."""
    parts = module.removeprefix("softcradle.").split(".")
    return "scenes" if parts[0] == "scenes" else ".".join(parts[:2])


def edges() -> set[tuple[str, str]]:
    """Every import of one module of the package by another, without the package's name."""
    graph = import_graph()
    return {(name.removeprefix("softcradle."), to.removeprefix("softcradle.")) for name in graph for to in graph[name]}


def circles() -> list[set[str]]:
    return [{name.removeprefix("softcradle.") for name in circle} for circle in cycles(import_graph())]


def test_no_circle():
    assert [sorted(found) for found in circles()] == []


def test_circles_are_found():
    graph = {"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": {"e"}, "e": {"d"}, "f": {"a"}}
    assert cycles(graph) == [{"a", "b", "c"}, {"d", "e"}]


def test_every_room_has_its_place():
    found = {room(module_name(path)) for path in source_files()}
    assert found == set(ROOMS)
    assert len(set(ROOMS)) == len(ROOMS)


@pytest.mark.parametrize(("layer", "order"), [("physics", PHYSICS), ("sandbox", SANDBOX)])
def test_the_architecture_page_has_this_order(layer, order):
    cells = re.findall(r"^\| (`.*?) \|", (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8"), re.MULTILINE)
    named = re.findall(rf"`{layer}/(\w+)", " ".join(cells))
    assert tuple(dict.fromkeys(named)) == order


def test_imports_follow_the_order_of_rooms():
    against = {(name, to) for name, to in edges() if ROOMS.index(room(to)) > ROOMS.index(room(name))}
    assert sorted(against) == []


@pytest.mark.parametrize("file", FILES)
def test_packages_stay_at_home(file):
    for package in {name.partition(".")[0] for name in imported(ROOT / file)} & HOMES.keys():
        assert file.startswith(HOMES[package]), f"{file} imports {package}"


@pytest.mark.parametrize(("package", "home"), [(package, home) for package in HOMES for home in HOMES[package]])
def test_homes_are_lived_in(package, home):
    found = [file for file in FILES if file.startswith(home)]
    assert any(name.partition(".")[0] == package for file in found for name in imported(ROOT / file))


@pytest.mark.parametrize("file", [file for file in FILES if file.startswith(("physics/reference/", PEERS))])
def test_what_checks_the_kernels_shares_none(file):
    assert not [name for name in imported(ROOT / file) if name.startswith("softcradle.physics.numerics")]


def test_closed_forms_share_no_kernel():
    names = imported(ROOT / "physics" / "analysis" / "closed_forms.py")
    assert not [name for name in names if name.startswith("softcradle.physics.numerics")]


def test_one_basename_is_one_thing():
    counts = Counter(Path(file).name for file in FILES)
    assert {name for name, count in counts.items() if count > 1} <= SAME_BASENAME.keys()


# Bare names: in a checkout `import physics` finds a second copy of every module; in an installed wheel, a stranger's.
BARE = re.compile(
    r"""^\W*(?:from|import)\ (?:physics|scenes|sandbox)(?:\.[\w.]+)?(?:\ import\b|\ as\b|\ *$)  # a statement, prompted or not
      | (?:-m\ |"-m",\ ["'])(?:physics|scenes|sandbox)\b                                       # python -m sandbox
      | ["'](?:physics|scenes|sandbox)(?:\.[a-z_]\w*)+["']                                     # a module by its name
    """,
    re.MULTILINE | re.VERBOSE,
)
TEXTS = sorted(
    path.relative_to(ROOT).as_posix()
    for pattern in ("*.md", "Makefile", "pyproject.toml", ".ci/*", "docs/*.md", "benchmarks/*.py", "tests/**/*.py")
    for path in ROOT.glob(pattern)
)


@pytest.mark.parametrize("file", sorted({*FILES, *TEXTS} - {"tests/house/test_layering.py"}))
def test_no_bare_name(file):
    text = (ROOT / file).read_text(encoding="utf-8")
    assert BARE.findall(text) == []
    if file.endswith(".py"):
        assert not {name.partition(".")[0] for name in imported(ROOT / file)} & set(LAYERS)


def test_bare_names_are_found():
    bad = ["import physics", ">>> from scenes import load", '    "from physics.chain import Chain"']
    bad += ["import sandbox as s", "python -m sandbox.cli", 'run("-m", "sandbox")', 'import_module("physics.chain")']
    good = ["from softcradle.physics import Chain", "import the physics", "from physics to scenes", '"physics/a.py"']
    assert [text for text in bad if not BARE.search(text)] == []
    assert [text for text in good if BARE.search(text)] == []


@pytest.mark.parametrize(
    ("code", "absent"),
    [
        ("from softcradle import physics", HEAVY),
        ("import softcradle; softcradle.METHODS", HEAVY),
        ("import softcradle.sandbox.cli.main", HEAVY),
        ("from softcradle.physics import Chain", [name for name in HEAVY if name != "numpy"]),
        ("import softcradle.physics.simulation", [name for name in HEAVY if name != "numpy"]),
        ("import softcradle.physics.fixed_step.runner", ("pymunk", "pygame")),  # numba itself takes scipy where it is
        ("import softcradle.physics.reference.scipy_runner", ("numba", "pymunk", "pygame")),
        ("import softcradle.scenes", [name for name in HEAVY if name not in {"numpy", "pydantic"}]),
        ("import softcradle.sandbox.session.session", [name for name in HEAVY if name not in {"numpy", "pydantic"}]),
    ],
)
def test_imports_are_light(code, absent):
    program = f"{code}; import sys; print([name for name in {tuple(absent)!r} if name in sys.modules])"
    found = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
