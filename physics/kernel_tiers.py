"""Kernels in two versions: compiled machine code, and the same source as plain Python. Plain Python is used until the
machine code is available.

Compiling the kernels takes up to about a minute, once per machine. Plain Python gives bitwise the same results without
this delay, but it is some hundred times slower. Therefore a run starts in plain Python, while a background process
compiles into the cache on disk. A run that is too long for plain Python waits for the machine code. With the
environment variable SOFTCRADLE_COMPILE=first, the kernels are compiled before the first run, in the same process.
"""

from __future__ import annotations

import logging
import os
import subprocess
import sys
import threading
from collections.abc import Callable
from functools import cache, cached_property
from pathlib import Path
from time import monotonic, sleep, time
from typing import Any, TypeVar
from zlib import crc32

import numpy as np
from softcradle.physics.numerics.float_bits import COMPILED, INSTALLED
from softcradle.physics.numerics.kernel_cache import cache_folder, drop_unused, target
from softcradle.physics.numerics.plain_kernels import plain

Kernel = TypeVar("Kernel", bound=Callable[..., Any])

# Largest work in plain Python before a process waits for machine code, in fixed steps times contacts. This work takes
# about three seconds.
PLAIN_WORK = 80_000
LOOKING = 0.25  # Time between two checks for machine code [s]
YIELDING = 10  # Niceness of a process that compiles while a window draws frames. This niceness keeps the frames smooth.
# Program of the background process that compiles
PROGRAM = "import os; getattr(os, 'nice', int)({}); from {} import TIERS; TIERS[{!r}].compile_and_unlock()"
HEARTBEAT = 5.0  # Time [s] after which the process that compiles updates its lock file, as a sign of life
# Time [s] without a sign of life after which the process counts as dead. A process with high niceness can be delayed
# for long.
LONGEST_SILENCE = 600.0
TOLD_AFTER = 60.0  # Waiting time [s] after which a message is logged
WAITING = (
    "waiting for kernels (%s) that process %d compiles, for %.0f s so far: other work on this machine slows it down; "
    "Ctrl+C is harmless"
)

FIRST = "compiling for this machine, about a minute for a method; the next start loads it from the disk"
SLOW = "numba is not installed: methods run as plain Python, a hundred times slower; pip install 'softcradle[fast]'"

logger = logging.getLogger("softcradle")


@cache
def tell_once(what: str) -> None:
    """Log the message `what`, but only once per process."""
    logger.warning(what)


class KernelTiers:
    """Group of kernels that are compiled together. The class chooses between their two versions.

    Attributes:
        name: name of the group, which is part of the file names on disk.
        spent: work done in plain Python so far, except in live frames. The unit of work is one fixed step of one
            contact.
    """

    def __init__(self, name: str, module: str, call_all: Callable[[], None]) -> None:
        """Create the group. `call_all` calls every kernel once.

        A background process that compiles the kernels finds this object as TIERS[name] in `module`.
        """
        self.name, self.module, self.call_all = name, module, call_all
        self.spent = 0.0
        self._loaded, self._looked = not COMPILED, -LOOKING
        self._first = os.environ.get("SOFTCRADLE_COMPILE") == "first"
        self._process: _Detached | None = None
        self._loader: threading.Thread | None = None
        self._here = threading.local()  # State of the thread that loads the kernels. Its calls run machine code.
        if not INSTALLED:
            tell_once(SLOW)

    # ---- choice of the version

    def of(self, kernel: Kernel, work: float = 0.0) -> Kernel:
        """Return the version of `kernel` for a run of size `work`.

        If plain Python would take too long, wait for the machine code.
        """
        self.load_made()
        if not self.in_memory:
            # Use plain Python as long as its total work is small. Otherwise wait for the machine code.
            self.compile_behind()
            if self.spent + work <= PLAIN_WORK:
                return quiet(kernel)
            tell_once(FIRST)
            self.wait()
            self._loaded = True
        return kernel if COMPILED else quiet(kernel)

    def of_frame(self, kernel: Kernel) -> Kernel:
        """Return the version of `kernel` for a frame of live use, without waiting. A thread loads the machine code
        meanwhile.
        """
        if self._first:
            self.load()
        if self.in_memory:
            return kernel if COMPILED else quiet(kernel)
        # Check regularly if machine code exists. If so, load it in a thread while the window continues to draw frames.
        if self._loader is None and monotonic() - self._looked > LOOKING:
            self._looked = monotonic()
            if self.on_disk:
                self._loader = threading.Thread(target=self.load, name="load kernels", daemon=True)
                self._loader.start()
            else:
                self.compile_behind(YIELDING)
        return quiet(kernel)

    # ---- machine code

    @property
    def in_memory(self) -> bool:
        """True if kernels can be called directly, because their machine code is in memory or numba is not installed."""
        return self._loaded or getattr(self._here, "forced", False)

    @property
    def on_disk(self) -> bool:
        """True if the machine code exists in the cache on disk."""
        return COMPILED and self._made.exists()

    def load(self) -> None:
        """Load the machine code. If it does not exist, compile it in a background process.

        A background process is used because it can be interrupted.
        """
        if self.in_memory:
            return
        # Compile in another process and wait for it. An interrupt of this process ends the other one.
        if not self.on_disk:
            tell_once(FIRST)
            logger.info("compiling the kernels of %s", self.name)
            try:
                if not self._first:
                    self.wait()
            except BaseException:
                self._stop()
                raise
        # Calling each kernel once loads it from the cache, or compiles it.
        self._here.forced = True
        try:
            self.call_all()
        finally:
            self._here.forced = False
        self._loaded = True
        try:
            self._made.parent.mkdir(parents=True, exist_ok=True)
            # Update the time of the file at each use. Kernels that are in use are not deleted from the cache.
            self._made.touch()
        except OSError:
            logger.info("%s: compiled kernels cannot be kept", self._made.parent)

    def load_made(self) -> None:
        """Load the machine code if it is not in memory yet, but exists on disk or must be compiled first."""
        if not self.in_memory and (self._first or self.on_disk):
            self.load()

    def compile_behind(self, niceness: int = 0) -> bool:
        """Compile in a background process, and return True if such a process runs.

        If a process already compiles these kernels, no other process is started.
        """
        if self._process is not None:
            return self._process.poll() is None
        return _is_alive(self._lock) or self._begin(niceness)

    def _begin(self, niceness: int = 0) -> bool:
        """Start a background process that compiles. Return True on success."""
        if getattr(sys, "frozen", False) or not sys.executable:
            return False
        try:
            self._lock.parent.mkdir(parents=True, exist_ok=True)
            self._process = _Detached(
                [sys.executable, "-c", PROGRAM.format(niceness, self.module, self.name)],
                env={**os.environ, "PYTHONPATH": _search_path(), "SOFTCRADLE_COMPILE": "first"},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                # Ctrl+C does not reach the new process group. The process stays in the same session, because niceness
                # may only act within a session.
                process_group=0,
            )
            self._lock.write_text(f"{self._process.pid} {niceness}")
            # A thread waits for the end of the process, so that it does not become a zombie.
            threading.Thread(target=self._process.wait, name="reap compiler", daemon=True).start()
        # The disk is full, or the permission to write is missing. This process compiles later, when it needs the
        # machine code.
        except OSError:
            return False
        return True

    def compile_and_unlock(self) -> None:
        """Compile the kernels and remove the lock. This is the main function of the background process."""
        threading.Thread(target=self._live, name="heartbeat", daemon=True).start()
        try:
            self.load()
            drop_unused(self._made.parent)
        finally:
            self._lock.unlink(missing_ok=True)

    def _live(self) -> None:
        while True:
            sleep(HEARTBEAT)
            try:
                os.utime(self._lock)
            except OSError:  # The lock file is gone, because everything is compiled.
                return

    def wait(self) -> None:
        """Wait until no process compiles these kernels."""
        # A process with high niceness makes little progress while other processes use all cores. Start one without
        # niceness.
        if self.compile_behind() and _holder(self._lock)[1] > 0:
            self._begin()
        began = told = monotonic()
        # Check repeatedly, because the process may belong to another program.
        while self.compile_behind() and not self.on_disk:
            sleep(0.05)
            if monotonic() - told > TOLD_AFTER:
                told = monotonic()
                logger.warning(WAITING, self.name, _holder(self._lock)[0], told - began)

    def _stop(self) -> None:
        """End the background process if it was started by this process."""
        if self._process is not None and self._process.poll() is None:
            self._process.kill()
            self._lock.unlink(missing_ok=True)

    @cached_property
    def _made(self) -> Path:
        """Path of a file that exists if the machine code exists.

        numba stores the machine code for the current source folder only.
        """
        place = crc32(str(Path(__file__).resolve().parent).encode())
        return cache_folder() / f"{self.name}.{target()}.{place:08x}.made"

    @cached_property
    def _lock(self) -> Path:
        """Path of a file that contains the process number and the niceness of the process that compiles."""
        return self._made.with_suffix(".compiling")


class _Detached(subprocess.Popen[bytes]):
    """Child process that may live longer than its parent, without a ResourceWarning."""

    def __del__(self) -> None:
        """Do nothing, so that the process continues."""


# ---- plain Python


@cache
def quiet(kernel: Any) -> Any:
    """Return the kernel as plain Python. Like machine code, it does not warn about infinite results."""
    return np.errstate(all="ignore")(plain(kernel))


# ---- machine code


def entry_of(kernel: Any, arguments: tuple[Any, ...]) -> Any:
    """Return the address of the machine code of `kernel` for arguments of these types, for use by `called_at`.

    In plain Python, return the kernel itself.
    """
    if not COMPILED:
        return kernel
    import numba

    kinds = tuple(map(numba.typeof, arguments))
    kernel.compile(kinds)
    found = kernel.overloads[kinds]
    return found.library.get_pointer_to_function(found.fndesc.llvm_func_name)


# ---- this machine


def _search_path() -> str:
    """Return a PYTHONPATH with which the background process can import this package from any folder."""
    here = str(Path(str(sys.modules["softcradle"].__file__)).parent.parent)
    return os.pathsep.join([here, *filter(None, [os.environ.get("PYTHONPATH")])])


def _holder(lock: Path) -> tuple[int, int]:
    """Return the process number and the niceness of the process that compiles, read from the file `lock`.

    Return (0, 0) if no process compiles.
    """
    try:
        number, niceness = lock.read_text().split()
        return int(number), int(niceness)
    except (OSError, ValueError):
        return 0, 0


def _is_alive(lock: Path) -> bool:
    """Return True if the process named in `lock` still compiles.

    The process must exist, and must have updated the file recently.
    """
    number = _holder(lock)[0]
    try:
        silence = time() - lock.stat().st_mtime
        # Signal 0 only checks that the process exists. Signal 0 does not affect the process.
        if os.name == "posix" and number:
            os.kill(number, 0)
    except OSError:
        return False
    return number > 0 and silence < LONGEST_SILENCE
