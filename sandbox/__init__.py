"""What people use: the `softcradle` command, the frames, the films and the window. The only package that draws."""

import os

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")  # or pygame greets on standard output
