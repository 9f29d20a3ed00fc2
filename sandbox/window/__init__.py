"""The desktop window: a gallery of scenes and the pages that play them. Only this package opens a window with pygame."""
