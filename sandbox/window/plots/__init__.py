"""Live plots of a scene that is played."""
