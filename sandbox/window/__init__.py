"""The desktop window: a gallery of scenes and the pages that play them. Only this package uses pygame's display."""
