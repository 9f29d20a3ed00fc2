"""The `softcradle` command, pictures, films and the window. This is the only package that draws."""

import os

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")  # Otherwise pygame prints a greeting to standard output.
