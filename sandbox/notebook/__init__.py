"""Views of trajectories, scenes and chains in a notebook: figures, films, HTML tables, and the window."""
