"""Where the repository lies, and the source files in it."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
ONLY_PLAIN = "pytestmark = only_plain"  # in files of tests that call kernels one by one
LAYERS = ("physics", "scenes", "sandbox")  # imports point to the left only


def source_files() -> list[Path]:
    return sorted(path for folder in ("softcradle", *LAYERS) for path in (ROOT / folder).rglob("*.py"))


def plain_files() -> list[Path]:
    """Every file of tests that runs where kernels are plain Python alone: compiled, each kernel would be for its test."""
    files = (ROOT / "tests" / "physics").rglob("test_*.py")
    return sorted(path for path in files if f"\n{ONLY_PLAIN}\n" in path.read_text(encoding="utf-8"))


def module_name(path: Path) -> str:
    """The full name of the module that a source file of the package holds.

    >>> module_name(ROOT / "physics" / "adaptive" / "__init__.py")
    'softcradle.physics.adaptive'
    """
    parts = path.relative_to(ROOT).with_suffix("").parts
    if parts[0] != "softcradle":
        parts = ("softcradle", *parts)
    return ".".join(parts).removesuffix(".__init__")
