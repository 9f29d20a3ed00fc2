"""Work against precision: cases with known outcomes, our methods and other integrators, and the time each needs for an error.

cases           ->  the collisions, each with its true outcome
solvers         ->  our methods under one call, which other integrators share (benchmarks/peers)
measurement     ->  error and time of every setting
curve_analysis, precision_table, precision_chart  ->  what the points say, as rows and as a picture
"""
