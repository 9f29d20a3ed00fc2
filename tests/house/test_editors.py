"""An editor, a type checker and ctags find a definition across the folders, by the links that set-up makes."""

import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

from tests.helpers.paths import ROOT

TOOLS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
(TYPED,) = TOOLS["pyright"]["extraPaths"]

pytestmark = pytest.mark.skipif(not (ROOT / TYPED / "softcradle" / "physics").is_dir(), reason="set up without make")


def test_every_tool_reads_the_same_links():
    assert TOOLS["mypy"]["mypy_path"] == TYPED
    assert {path.name: path.resolve() for path in (ROOT / TYPED / "softcradle").iterdir()} == {
        **{name: ROOT / "softcradle" / name for name in ("__init__.py", "__main__.py")},
        **{room: ROOT / room for room in ("physics", "scenes", "sandbox")},
    }


def test_a_definition_is_found_from_another_room():
    jedi = pytest.importorskip("jedi")
    text = "from softcradle.physics.chain import Chain\nfrom softcradle.scenes.catalogue import load\nChain, load\n"
    project = jedi.Project(ROOT, sys_path=[str(ROOT / TYPED)], smart_sys_path=False)
    here = jedi.InterpreterEnvironment()
    script = jedi.Script(text, path=ROOT / "sandbox" / "new.py", environment=here, project=project)
    found = [script.goto(3, column, follow_imports=True)[0] for column in (0, 7)]
    places = [("Chain", ROOT / "physics" / "chain.py"), ("load", ROOT / "scenes" / "catalogue.py")]
    assert [(one.name, Path(one.module_path).resolve()) for one in found] == places


@pytest.mark.skipif(shutil.which("ctags") is None, reason="there is no ctags")
def test_tags_lead_to_it(tmp_path):
    subprocess.run(["ctags", "-R", "--languages=Python", "-f", str(tmp_path / "tags"), TYPED], cwd=ROOT, check=True)
    tags = (tmp_path / "tags").read_text(encoding="utf-8", errors="replace").splitlines()
    (line,) = [line for line in tags if line.startswith("Chain\t") and "\tc" in line]
    assert (ROOT / line.split("\t")[1]).resolve() == ROOT / "physics" / "chain.py"
