"""The window: a gallery of scenes, and the page on which one of them is played with. The only user of pygame's display."""
