"""The gallery of scenes."""
