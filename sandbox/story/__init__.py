"""Story of a motion as values: its events, and which beads move where. Each term has a single definition here.

Window, terminal, films, lessons, notebooks and pages report these values. Pages contain the bounds and
words that `page_story.py` returns.
"""
