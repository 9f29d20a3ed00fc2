"""The folder of compiled kernels on the disk."""

from __future__ import annotations

import os
import re
import shutil
import sys
from pathlib import Path
from time import time

import platformdirs
from softcradle.physics.source_digest import digest_of, kernel_sources

UNUSED = 14 * 86400.0  # seconds after which the kernels of another version are dropped: they take tens of megabytes


def cache_folder() -> Path:
    """Where the compiled kernels of exactly this source are kept; NUMBA_CACHE_DIR moves it.

    Its name follows every kernel source: numba itself notices only the file a kernel stands in, not its callees.
    """
    base = os.environ.get("NUMBA_CACHE_DIR") or platformdirs.user_cache_dir("softcradle", appauthor=False)
    return Path(base) / "kernels" / digest_of(kernel_sources())


def target() -> str:
    """What machine code is made for: processor, numba, Python."""
    import numba
    from llvmlite import binding

    processor = numba.config.CPU_NAME or binding.get_host_cpu_name()
    return f"{processor}-{numba.__version__}-{sys.implementation.cache_tag}".replace(".", "_")


def drop_unused(used: Path) -> None:
    """Remove the folders beside `used` from which no kernel has been loaded for long; what cannot be removed stays."""
    for folder in used.parent.iterdir():
        if folder == used or not re.fullmatch("[0-9a-f]{16}", folder.name):
            continue
        newest = max((path.stat().st_mtime for path in (folder, *folder.iterdir())), default=0.0)
        if time() - newest > UNUSED:
            shutil.rmtree(folder, ignore_errors=True)
