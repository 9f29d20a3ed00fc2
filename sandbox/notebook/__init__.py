"""What a notebook shows of trajectories, scenes and chains: figures, films, tables in HTML; and the window, opened from one."""
