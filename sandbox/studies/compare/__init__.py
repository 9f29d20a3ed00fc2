"""Comparison: the same collision in several chains, in motion on one clock and in numbers side by side.

choice   ->  which lanes, from the words of the command line, refused before any work
results  ->  trajectory and measures of each
tables, charts, page  ->  the same results for the terminal, as JSON, and as a page to look at
"""
