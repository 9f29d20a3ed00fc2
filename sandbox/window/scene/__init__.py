"""The page on which a scene is played."""
