"""Tests of a full disk. Every function that writes a file must report the error in one sentence and leave no file.

The tests imitate a full disk by a limit of 400 bytes per file.
"""

import pytest

from tests.helpers.own_process import python

pytestmark = pytest.mark.slow  # These tests are slow because each of them starts a new Python process.

resource = pytest.importorskip("resource", reason="this system has no limit of file sizes")

COARSE = ("--method", "verlet", "--step", "1/50")
SMALL = ("--size", "160x90", "--fps", "2")
OUTPUTS = {
    "one picture": ("render", "one-on-four", *SMALL, *COARSE, "-o", "x.png"),
    "folder of pictures": ("render", "one-on-four", *SMALL, *COARSE, "-o", "frames/"),
    "kymograph": ("render", "one-on-four", *COARSE, "-o", "x.kymograph.png"),
    "mp4": ("render", "one-on-four", *SMALL, *COARSE, "-o", "x.mp4"),
    "gif": ("render", "one-on-four", *SMALL, *COARSE, "-o", "x.gif"),
    "page": ("render", "one-on-four", *COARSE, "-o", "x.html"),
    "csv": ("run", "one-on-four", *COARSE, "-o", "x.csv"),
    "npz": ("run", "one-on-four", *COARSE, "-o", "x.npz"),
    "numbers of a comparison": ("compare", "one-on-four", "--contact", "hertz(1)", *COARSE, "-o", "x.json"),
}
LIMIT = 400  # Largest size of a file [bytes].


@pytest.mark.parametrize("arguments", OUTPUTS.values(), ids=OUTPUTS)
def test_a_full_disk_is_noticed(arguments, tmp_path):
    quick = {"NUMBA_DISABLE_JIT": "1", "SDL_VIDEODRIVER": "dummy", "PYTHONDONTWRITEBYTECODE": "1"}
    limited = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT, LIMIT))}
    done = python("-m", "softcradle", *arguments, check=False, cwd=tmp_path, **quick, **limited)
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    assert len([line for line in done.stderr.splitlines() if line and "warning" not in line]) == 1, done.stderr
    assert "cannot write" in done.stderr
    assert "too large" in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".png", ".pdf", ".svg"])
def test_figures_on_a_full_disk(suffix, tmp_path):
    program = f"""
import resource
from pathlib import Path
from softcradle.sandbox.studies.plot_style import new_figure, save_figure
figure, axes = new_figure()
axes.plot([0, 1], [0, 1])
save_figure(figure, Path("whole{suffix}"))
resource.setrlimit(resource.RLIMIT_FSIZE, ({LIMIT}, {LIMIT}))
save_figure(figure, Path("part{suffix}"))
"""
    assert python("-c", program, check=False, cwd=tmp_path).stderr.lower().endswith("file too large\n")
