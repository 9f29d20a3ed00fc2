"""Comparison of the same collision in several chains. The result is a film, a page, or a table of numbers."""
