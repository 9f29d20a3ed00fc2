"""Standard output and error: characters that their encoding lacks, and a full disk behind them."""

from __future__ import annotations

import codecs
import os
import sys
import unicodedata

PLAIN = {
    "\N{SUPERSCRIPT MINUS}": "-",
    "\N{SUBSCRIPT MINUS}": "-",
    "\N{MINUS SIGN}": "-",
    "\N{CHECK MARK}": "*",
    "\N{MIDDLE DOT}": "*",
    "\N{MULTIPLICATION SIGN}": "x",
}


def use_plain_characters() -> None:
    """Let both streams write plain characters in place of those that their encoding lacks."""
    codecs.register_error("softcradle-plain", _plain)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="softcradle-plain")


def _plain(error: UnicodeError) -> tuple[str, int]:
    """The end of an encoding error: its characters in ASCII, and where to go on."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(map(_plain_character, error.object[error.start : error.end])), error.end


def _plain_character(character: str) -> str:
    """`character` in ASCII: a digit for a subscript, the name of a Greek letter, else a question mark."""
    decomposed = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    name = unicodedata.name(character, "")
    greek = name.rpartition(" ")[2].lower() if name.startswith("GREEK") else "?"
    return PLAIN.get(character) or decomposed or greek


def flush_output() -> None:
    """Write what is still in the memory of standard output. Raises OSError where it cannot be written."""
    if sys.stdout is not None:  # as it is where the caller has closed it
        sys.stdout.flush()


def discard_output() -> None:
    """Send what standard output still holds to nowhere: Python would try to write it once more at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
