"""The story of a motion: what has happened and who goes where, as values, with one definition of each term.

Window, terminal, films, lessons, notebooks and pages report these values. Pages read the bounds from `assets/page/story.js`,
which `make story` writes.
"""
