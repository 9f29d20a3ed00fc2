"""StudyError: what is wrong with a sweep that was asked for, in a sentence."""

from __future__ import annotations

from softcradle.sandbox.user_error import UserError


class StudyError(UserError, ValueError):
    """One sentence on what to change; the command prints it, and in Python it is a ValueError."""
