"""UserError, the one exception that a user sees: a sentence about what to change, without a traceback."""

from __future__ import annotations


class UserError(Exception):
    """One sentence for the user; the command prints it as ``softcradle: sentence`` on stderr and exits with code 2."""
