"""Where the repository lies, and the source files in it."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[2]
LAYERS = ("physics", "scenes", "sandbox")  # imports point to the left only


def source_files() -> list[Path]:
    """Every source file of the package, sorted."""
    return sorted(path for folder in ("softcradle", *LAYERS) for path in (ROOT / folder).rglob("*.py"))


def module_name(path: Path) -> str:
    """The full name of the module that a source file of the package holds.

    >>> module_name(ROOT / "physics" / "adaptive" / "__init__.py")
    'softcradle.physics.adaptive'
    """
    parts = path.relative_to(ROOT).with_suffix("").parts
    if parts[0] != "softcradle":
        parts = ("softcradle", *parts)
    return ".".join(parts).removesuffix(".__init__")
