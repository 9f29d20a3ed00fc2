"""Two tiers of the kernels that Python calls: machine code, and the same source as plain Python until that is at hand.

Machine code is made once a machine, which takes up to a minute or so. Plain Python gives the same digits at once, some hundred
times slower. So a run begins in plain Python while a process behind compiles into the cache on the disk; what is too long for
plain Python waits for it. SOFTCRADLE_COMPILE=first compiles before the first run, in its own process.
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

# fixed steps times contacts that a process runs as plain Python, about three seconds, before it waits
PLAIN_WORK = 80_000
LOOKING = 0.25  # seconds between two looks whether machine code has come
YIELDING = 10  # niceness of a process that compiles behind frames, which are to be drawn in time
# of that process
PROGRAM = "import os; getattr(os, 'nice', int)({}); from {} import TIERS; TIERS[{!r}].compile_and_unlock()"
HEARTBEAT = 5.0  # seconds between two signs of life of a process that compiles
# Seconds without a sign of life after which it is given up: one that yields to others may be heard of late.
LONGEST_SILENCE = 600.0
TOLD_AFTER = 60.0  # seconds of waiting, after which that is said
WAITING = (
    "waiting for kernels (%s) that process %d compiles, for %.0f s so far: other work on this machine slows it down; "
    "Ctrl+C is harmless"
)

FIRST = "compiling for this machine, about a minute for a method; the next start loads it from the disk"
SLOW = "numba is not installed: methods run as plain Python, a hundred times slower; pip install 'softcradle[fast]'"

logger = logging.getLogger("softcradle")


@cache
def tell_once(what: str) -> None:
    """Say it once in a process."""
    logger.warning(what)


class KernelTiers:
    """Kernels that are compiled together, and which of their tiers is to be called.

    Attributes:
        name: of the files that tell of them.
        spent: fixed steps times contacts, or what costs as much, run as plain Python so far, live frames left out.
    """

    def __init__(self, name: str, module: str, call_all: Callable[[], None]) -> None:
        """`call_all` calls every kernel once; a process that compiles finds this object as TIERS[name] of `module`."""
        self.name, self.module, self.call_all = name, module, call_all
        self.spent = 0.0
        self._loaded, self._looked = not COMPILED, -LOOKING
        self._first = os.environ.get("SOFTCRADLE_COMPILE") == "first"
        self._process: _Detached | None = None
        self._loader: threading.Thread | None = None
        self._here = threading.local()  # of the thread that loads: its calls run machine code
        if not INSTALLED:
            tell_once(SLOW)

    # ---- which tier

    def of(self, kernel: Kernel, work: float = 0.0) -> Kernel:
        """The tier of `kernel` for a run of `work`, counted as `spent`, of which plain Python does no more than it should."""
        self.load_made()
        if not self.in_memory:
            self.compile_behind()
            if self.spent + work <= PLAIN_WORK:
                return quiet(kernel)
            tell_once(FIRST)
            self.wait()
            self._loaded = True
        return kernel if COMPILED else quiet(kernel)

    def of_frame(self, kernel: Kernel) -> Kernel:
        """The tier of `kernel` for a frame of live use, which waits for nothing: machine code is loaded on a thread."""
        if self._first:
            self.load()
        if self.in_memory:
            return kernel if COMPILED else quiet(kernel)
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
        """Whether kernels are called as they are: with machine code in memory, or compiled by nothing."""
        return self._loaded or getattr(self._here, "forced", False)

    @property
    def on_disk(self) -> bool:
        """Whether the machine code has been made."""
        return COMPILED and self._made.exists()

    def load(self) -> None:
        """Load the machine code; where there is none it is compiled, in a process behind, because that hears signals."""
        if self.in_memory:
            return
        if not self.on_disk:
            tell_once(FIRST)
            logger.info("compiling the kernels of %s", self.name)
            try:
                if not self._first:
                    self.wait()
            except BaseException:
                self._stop()
                raise
        self._here.forced = True
        try:
            self.call_all()
        finally:
            self._here.forced = False
        self._loaded = True
        try:
            self._made.parent.mkdir(parents=True, exist_ok=True)
            self._made.touch()  # each time: kernels that are used are kept
        except OSError:
            logger.info("%s: compiled kernels cannot be kept", self._made.parent)

    def load_made(self) -> None:
        """Load the machine code if it has been made, or is to be made first, and is not in memory."""
        if not self.in_memory and (self._first or self.on_disk):
            self.load()

    def compile_behind(self, niceness: int = 0) -> bool:
        """Begin to compile in a process of its own, unless one does already; whether one does."""
        if self._process is not None:
            return self._process.poll() is None
        return _is_alive(self._lock) or self._begin(niceness)

    def _begin(self, niceness: int = 0) -> bool:
        """Begin to compile in a process of its own; whether that went."""
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
                process_group=0,  # which no Ctrl+C reaches, but in our session: where these share the processors, niceness counts
            )
            self._lock.write_text(f"{self._process.pid} {niceness}")
            threading.Thread(target=self._process.wait, name="reap compiler", daemon=True).start()  # no zombie is left
        except OSError:  # no room, or no right to write: this process compiles for itself when it has to
            return False
        return True

    def compile_and_unlock(self) -> None:
        """What the process behind does."""
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
            except OSError:  # the lock is gone: all is compiled
                return

    def wait(self) -> None:
        """Wait until no process compiles these kernels any more."""
        # one that yields hardly goes on where others take all processors
        if self.compile_behind() and _holder(self._lock)[1] > 0:
            self._begin()
        began = told = monotonic()
        while self.compile_behind() and not self.on_disk:
            sleep(0.05)
            if monotonic() - told > TOLD_AFTER:
                told = monotonic()
                logger.warning(WAITING, self.name, _holder(self._lock)[0], told - began)

    def _stop(self) -> None:
        """End the process behind, if it is one of ours."""
        if self._process is not None and self._process.poll() is None:
            self._process.kill()
            self._lock.unlink(missing_ok=True)

    @cached_property
    def _made(self) -> Path:
        """A file that is there when the machine code is, which numba keeps for this very folder of sources."""
        place = crc32(str(Path(__file__).resolve().parent).encode())
        return cache_folder() / f"{self.name}.{target()}.{place:08x}.made"

    @cached_property
    def _lock(self) -> Path:
        """A file with the number of the process that compiles, and its niceness."""
        return self._made.with_suffix(".compiling")


class _Detached(subprocess.Popen[bytes]):
    """A process that may outlive this one, which is no reason for a warning."""

    def __del__(self) -> None:
        """Let it run on."""


# ---- plain Python


@cache
def quiet(kernel: Any) -> Any:
    """The kernel as plain Python, to be called from outside: it warns no more of infinite results than machine code does."""
    return np.errstate(all="ignore")(plain(kernel))


# ---- machine code


def entry_of(kernel: Any, arguments: tuple[Any, ...]) -> Any:
    """Where the machine code of `kernel` for arguments like these begins, for `called_at`; the kernel itself as plain Python."""
    if not COMPILED:
        return kernel
    import numba

    kinds = tuple(map(numba.typeof, arguments))
    kernel.compile(kinds)
    found = kernel.overloads[kinds]
    return found.library.get_pointer_to_function(found.fndesc.llvm_func_name)


# ---- this machine


def _search_path() -> str:
    """Where the process behind finds this package, whatever folder it runs in."""
    here = str(Path(str(sys.modules["softcradle"].__file__)).parent.parent)
    return os.pathsep.join([here, *filter(None, [os.environ.get("PYTHONPATH")])])


def _holder(lock: Path) -> tuple[int, int]:
    """The number of the process that compiles and its niceness, as `lock` tells; (0, 0) where there is none."""
    try:
        number, niceness = lock.read_text().split()
        return int(number), int(niceness)
    except (OSError, ValueError):
        return 0, 0


def _is_alive(lock: Path) -> bool:
    """Whether the process that `lock` names still compiles: it is there, and gave a sign of life."""
    number = _holder(lock)[0]
    try:
        silence = time() - lock.stat().st_mtime
        if os.name == "posix" and number:
            os.kill(number, 0)
    except OSError:
        return False
    return number > 0 and silence < LONGEST_SILENCE
