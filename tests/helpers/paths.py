"""Where the repository lies, and what is found in it."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
ONLY_PLAIN = "pytestmark = only_plain"  # in files of tests that call kernels one by one
LAYERS = ("physics", "scenes", "sandbox")  # imports point to the left only


def plain_files() -> list[Path]:
    """Every file of tests that runs where kernels are plain Python alone: compiled, each kernel would be for its test."""
    files = (ROOT / "tests" / "physics").rglob("test_*.py")
    return sorted(path for path in files if f"\n{ONLY_PLAIN}\n" in path.read_text(encoding="utf-8"))
