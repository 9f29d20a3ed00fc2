"""Story of a motion as values: its events, and which beads move where. Each term has a single definition here.

Window, terminal, films, lessons, notebooks and pages report these values. Pages read the bounds from `assets/page/story.js`,
which `make story` writes.
"""
