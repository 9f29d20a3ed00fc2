"""`jit`: numba's njit with a disk cache that an edit of any kernel empties; plain Python where numba is not to be had."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import platformdirs
from softcradle.physics.source_digest import digest_of, kernel_sources

Kernel = TypeVar("Kernel", bound=Callable[..., object])


def cache_folder() -> Path:
    """Where the compiled kernels of exactly this source are kept; NUMBA_CACHE_DIR moves it.

    Its name follows every kernel source: numba itself notices only the file a kernel stands in, not its callees.
    """
    base = os.environ.get("NUMBA_CACHE_DIR") or platformdirs.user_cache_dir("softcradle", appauthor=False)
    return Path(base) / "kernels" / digest_of(kernel_sources())


try:
    import numba
except ImportError:  # no wheel for this machine: the same functions run as plain Python

    def jit(function: Kernel) -> Kernel:
        """The function itself, uncompiled."""
        return function

    inlined = fused = jit

else:
    COUNTED = (
        False  # references to arrays: kernels make no array, and counting references to views took half of the time
    )
    _FOLDER = str(cache_folder())

    def _compiled(function: Kernel, **options: object) -> Kernel:
        before = numba.config.CACHE_DIR
        numba.config.CACHE_DIR = _FOLDER  # read while decorating; other users of numba keep their own folder
        try:
            compiled: Kernel = numba.njit(cache=True, nogil=True, error_model="numpy", _nrt=COUNTED, **options)(
                function
            )
        finally:
            numba.config.CACHE_DIR = before
        return compiled

    def jit(function: Kernel) -> Kernel:
        """Compile `function` on its first call; keep the result on disk under the digest of all kernel sources.

        Kernels touch nothing of Python's, so other threads run on beside them.
        """
        return _compiled(function)

    def inlined(function: Kernel) -> Kernel:
        """`jit`, put into its caller: a call that passes whole records costs as much as a step of a few contacts.

        Python cannot call it; code for that would take a tenth of the time to compile.
        """
        return _compiled(function, forceinline=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)

    def fused(function: Kernel) -> Kernel:
        """`jit`, put into its caller; products and sums may be fused to one operation, and its loops become vector code."""
        return _compiled(function, forceinline=True, fastmath={"contract"})
