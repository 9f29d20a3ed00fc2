"""Live plots of the scene on screen."""
