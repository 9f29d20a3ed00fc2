"""Where numbers were measured: processor, cores and the versions that decide them, in one line."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = ("softcradle", "numba", "numpy", "scipy", "pymunk")


def machine_stamp(packages: Sequence[str] = ()) -> str:
    """Processor and cores, system, Python and the versions of PACKAGES and `packages` as far as they are installed."""
    found = [f"{name} {installed}" for name in (*PACKAGES, *packages) if (installed := _version(name))]
    cores = os.cpu_count() or 1
    hardware = f"{processor()}, {cores} core{'s' * (cores > 1)}"
    return "; ".join([hardware, f"{platform.system()}, Python {platform.python_version()}", ", ".join(found)])


def processor() -> str:
    """Name of the processor; on Linux that of /proc/cpuinfo, for Python knows the architecture alone there."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return next(iter(names), "") or platform.processor() or platform.machine()


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
