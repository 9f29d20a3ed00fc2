"""The `softcradle` command, the pictures, the films and the window; the only package that draws."""

import os

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")  # pygame would print a greeting to standard output
