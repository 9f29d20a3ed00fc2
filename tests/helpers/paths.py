"""Path of the repository, and lists of files in it."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
ONLY_PLAIN = "pytestmark = only_plain"  # Line that marks test files which call single kernels.
# Layers of the package. A layer may import only itself and the layers before it in this list.
LAYERS = ("physics", "scenes", "sandbox")


def plain_files() -> list[Path]:
    """Return the test files that run only with kernels in plain Python. With Numba, each kernel would be compiled for a
    single test.
    """
    files = (ROOT / "tests" / "physics").rglob("test_*.py")
    return sorted(path for path in files if f"\n{ONLY_PLAIN}\n" in path.read_text(encoding="utf-8"))
