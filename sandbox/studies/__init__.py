"""Studies: tests of the paper's claims, figures, comparisons, parameter maps, the work-precision chart and the
experiment.
"""
