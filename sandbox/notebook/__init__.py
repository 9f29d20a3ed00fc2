"""Notebook views of trajectories, scenes and chains: figures, films, tables in HTML, and the window."""
