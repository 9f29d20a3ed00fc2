"""Folder on disk in which compiled kernels are cached."""

from __future__ import annotations

import os
import re
import shutil
import sys
from pathlib import Path
from time import time

import platformdirs
from softcradle.physics.source_digest import digest_of, kernel_sources

# Time in seconds after which the kernels of another version are deleted: each version takes tens of megabytes.
UNUSED = 14 * 86400.0


def cache_folder() -> Path:
    """Return the folder with the compiled kernels of exactly this source.

    The environment variable NUMBA_CACHE_DIR changes its location.

    The folder name is a digest of all kernel sources, because numba itself only notices changes in the file that
    contains the kernel, not in the functions that the kernel calls.
    """
    base = os.environ.get("NUMBA_CACHE_DIR") or platformdirs.user_cache_dir("softcradle", appauthor=False)
    return Path(base) / "kernels" / digest_of(kernel_sources())


def target() -> str:
    """Return a name of what the machine code is made for: processor, numba version and Python version."""
    import numba
    from llvmlite import binding

    processor = numba.config.CPU_NAME or binding.get_host_cpu_name()
    return f"{processor}-{numba.__version__}-{sys.implementation.cache_tag}".replace(".", "_")


def drop_unused(used: Path) -> None:
    """Delete sibling folders of `used` whose kernels have not been loaded for a long time.

    Folders that cannot be deleted are skipped.
    """
    for folder in used.parent.iterdir():
        if folder == used or not re.fullmatch("[0-9a-f]{16}", folder.name):
            continue
        # every process that uses the kernels touches a file in their folder
        newest = max((path.stat().st_mtime for path in (folder, *folder.iterdir())), default=0.0)
        if time() - newest > UNUSED:
            shutil.rmtree(folder, ignore_errors=True)
