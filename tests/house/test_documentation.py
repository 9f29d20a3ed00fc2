"""Tests of the documentation. Examples, notebooks and the commands of the README must run. Sphinx must build the
documentation without a warning.
"""

import doctest
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from pkgutil import resolve_name

import pytest
from numpydoc.validate import validate
from softcradle.sandbox.cli.main import COMMANDS, main

from softcradle import scenes
from tests.helpers.paths import ROOT

pytestmark = pytest.mark.slow

PAGES = sorted((ROOT / "docs").glob("*.md"))
TEXTS = {page.name: page.read_text(encoding="utf-8") for page in PAGES}
# Pages of the documentation that embed or link interactive pages.
LIVE = ("index.html", "teachers.html", "scenes.html")
FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
FENCED = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", [page for page in PAGES if ">>> " in TEXTS[page.name]], ids=lambda page: page.name)
def test_examples_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # The examples write their files to this folder.
    failed, tried = doctest.testfile(str(page), module_relative=False, optionflags=FLAGS)
    assert failed == 0 < tried


def command_lines():
    """Yield the page and the text of every command in shell blocks and between backticks."""
    for name, text in TEXTS.items():
        blocks = [line for kind, body in FENCED.findall(text) if kind == "sh" for line in body.splitlines()]
        spans = re.findall(r"`(softcradle [^`\n]+)`", text)
        yield from ((name, line) for line in [*blocks, *spans] if line.startswith("softcradle "))


@pytest.mark.parametrize(("page", "line"), list(command_lines()))
def test_commands_and_scenes_exist(page, line):
    _, command, *words = shlex.split(line, comments=True)
    assert command in {known.name for known in COMMANDS}
    if command in ("run", "render", "compare") and words and re.fullmatch(r"[a-z-]+", words[0]):
        assert words[0] in scenes.names()


README = (ROOT / "README.md").read_text(encoding="utf-8")
ALL = TEXTS | {"README.md": README}
BLOCKS = [(name, body) for name, text in ALL.items() for kind, body in FENCED.findall(text) if kind == "python"]


@pytest.mark.usefixtures("own_folder")
@pytest.mark.parametrize(("page", "body"), BLOCKS, ids=[page for page, _ in BLOCKS])
def test_python_blocks_run(page, body, tmp_path, monkeypatch):
    """Run each Python block in its own folder. The block must write exactly the files that it names."""
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    (tmp_path / "out").mkdir()
    exec(compile(body, page, "exec"), {"__name__": "an example"})
    written = {path.name for path in tmp_path.rglob("*") if path.is_file() and "cache" not in path.parts}
    assert written == set(re.findall(r"[\w-]+\.(?:npz|html|pdf|csv)", body))


# Checks of numpydoc that are left out. These checks concern line breaks and information that the type hints contain.
LEFT_OUT = "GL01", "GL02", "GL03", "SA01", "EX01", "ES01", "RT01", "SS05", "SS06", "PR07"


@pytest.mark.parametrize("name", re.findall(r"auto(?:class|function):: (\S+)", TEXTS["api.md"]))
def test_docstrings_are_in_the_style_of_numpy(name):
    """Validate public docstrings with numpydoc. The sections of a docstring must be known, complete and in the right
    order. The text must consist of sentences.
    """
    found = resolve_name(name)
    members = re.search(rf":: {re.escape(name)}\n   :members: (.*)", TEXTS["api.md"])
    for one in (found, *(getattr(found, member) for member in (members[1].split(", ") if members else ()))):
        assert not re.search(r"^\s+(Args|Arguments|Attributes|Returns|Raises|:param .*):", one.__doc__, re.MULTILINE)
    if re.search(r"^\s+(Parameters|Attributes|Raises)\n\s+-+$", found.__doc__, re.MULTILINE):
        wrong = dict(validate(f"{found.__module__}.{found.__name__}")["errors"])
        # If users only read the attributes of a class, its docstring does not need the section Parameters.
        if "Parameters\n" not in found.__doc__:
            wrong.pop("PR01", None)
        assert {code: said for code, said in wrong.items() if code not in LEFT_OUT} == {}


def test_it_is_built_without_a_warning(tmp_path):
    """Build the documentation with warnings as errors. Messages about compiling kernels on standard error do not count
    as warnings.
    """
    for name in ("sphinx", "furo", "myst_parser", "latex2mathml", "sphinx_gallery"):
        pytest.importorskip(name, reason="the extra [docs] is not installed")
    words = ("--fail-on-warning", "--keep-going", "-q", "-b", "html", "-w", str(tmp_path / "warnings.txt"), "docs")
    build = [sys.executable, "-m", "sphinx", *words, str(tmp_path)]
    done = subprocess.run(build, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (tmp_path / "warnings.txt").read_text(encoding="utf-8") == ""
    assert done.returncode == 0
    made = {page.stem for page in tmp_path.glob("*.html")}
    assert made >= {page.stem for page in PAGES}
    gallery = {script.stem for script in (ROOT / "examples" / "gallery").glob("plot_*.py")}
    assert {page.stem for page in (tmp_path / "gallery").glob("plot_*.html")} == gallery != set()
    assert len(list((tmp_path / "_images").glob("sphx_glr_plot_*.png"))) >= len(gallery)
    live = {page.stem for page in (tmp_path / "_static" / "live").glob("*.html") if page.stat().st_size > 50_000}
    linked = {page: re.findall(r"_static/live/([\w-]+)\.html", (tmp_path / page).read_text()) for page in LIVE}
    assert live == set(scenes.names()) == set(linked["scenes.html"])
    assert set().union(*linked.values()) <= live
    assert all("<iframe" in (tmp_path / page).read_text() for page in LIVE[:2])


LINES = [line.partition("  #")[0].strip() for line in re.findall(r"^    (?=\S)(.+)$", README, re.MULTILINE)]
ELSEWHERE = ("softcradle claims",)  # Commands that run whole studies. Other tests run these studies.
# Commands that are not in the README but are run as well. The commands write to the folder out/.
UNNAMED = ("softcradle maps power-law --points 4x3", "softcradle chart one-on-4 --ours")
TOUR = [*(line for line in LINES if line.startswith("softcradle") and line not in ELSEWHERE), *UNNAMED]


@pytest.mark.usefixtures("own_folder")
@pytest.mark.parametrize("line", TOUR)
def test_a_command_of_the_readme_runs(line, tmp_path, monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.setattr("softcradle.sandbox.window.app.App.run", lambda app: app.close())
    Path("out").mkdir()
    arguments = shlex.split(line)[1:]
    assert main([*arguments, *(["1b"] if "figures" in arguments else [])]) == 0  # Draw only one figure.
    assert {path.name for path in tmp_path.iterdir()} - {"cache"} == {"out"}


NOTEBOOKS = sorted((ROOT / "examples").glob("*.ipynb"))


@pytest.mark.own_process  # The test starts the Jupyter kernel of the notebook.
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_outputs_and_runs(path, tmp_path, monkeypatch):
    nbclient, nbformat, _ = map(pytest.importorskip, ("nbclient", "nbformat", "ipykernel"))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    notebook = nbformat.read(path, as_version=4)
    assert not [cell for cell in notebook.cells if cell.get("outputs") or cell.get("execution_count")]
    client = nbclient.NotebookClient(notebook, timeout=1800, resources={"metadata": {"path": str(tmp_path)}})
    client.execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert any("text/html" in output.get("data", {}) or "image/png" in output.get("data", {}) for output in shown)
    assert not [output for output in shown if output.output_type == "error" or output.get("name") == "stderr"]
