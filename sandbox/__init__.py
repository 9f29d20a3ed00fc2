"""The `softcradle` command, pictures, films and the window. Only this package draws."""

import os

# Without this setting, pygame prints a greeting to standard output.
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
