"""Comparison: the same collision in several chains, in one film and in numbers side by side.

sides               ->  which lanes, from the words of the command line; refused before any run
comparison_results  ->  trajectory and measures of each side
comparison_tables, comparison_plots, html_report  ->  the same results on the terminal, as charts, and as a page
comparison_outputs  ->  the files
"""
