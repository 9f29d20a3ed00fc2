"""The window: a gallery of scenes, and the pages on which they are played with. The only user of pygame's display."""
