"""Notes of what is compiled, on standard error: a line that it begins and, on a terminal, one that follows the kernels."""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

from softcradle.sandbox.console import is_quiet

ERASE_LINE = "\r\x1b[K"


class CompileNotes(logging.Handler):
    """Shows the records of the logger `softcradle`."""

    def __init__(self, stream: TextIO) -> None:
        super().__init__(logging.INFO)
        self._stream, self._follows = stream, stream.isatty()

    def emit(self, record: logging.LogRecord) -> None:
        """Write the record: a line for a warning; on a terminal, progress that the next one replaces."""
        if record.levelno >= logging.WARNING:
            self._stream.write(f"softcradle: {record.getMessage()}\n")
        elif self._follows:
            self._stream.write(f"{ERASE_LINE}{record.getMessage()}")
        self._stream.flush()

    def close(self) -> None:
        """Erase the last progress."""
        if self._follows:
            self._stream.write(ERASE_LINE)
        super().close()


@contextmanager
def compilation_shown() -> Iterator[None]:
    """Show what is compiled while the block runs, unless quiet."""
    logger, notes = logging.getLogger("softcradle"), CompileNotes(sys.stderr)
    level, passed_on = logger.level, logger.propagate
    logger.addHandler(logging.NullHandler() if is_quiet() else notes)
    logger.setLevel(logging.INFO)
    logger.propagate = False
    try:
        yield
    finally:
        logger.removeHandler(notes)
        notes.close()
        logger.setLevel(level)
        logger.propagate = passed_on
