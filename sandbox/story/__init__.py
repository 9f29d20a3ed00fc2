"""Description of a motion as values: its events, and the beads that move together. Each term is defined only here.

The window, terminal, films, lessons, notebooks and pages report these values. Pages contain the limits and words that
`page_story.py` returns.
"""
