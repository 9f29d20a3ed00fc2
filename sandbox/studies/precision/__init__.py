"""Work against precision: cases with known outcomes, our methods and other integrators, and the time each needs for an error.

cases           ->  the collisions, each with its true outcome
solvers, peers  ->  our methods, and other integrators, under one call
measurement     ->  error and time of every setting
curve_analysis, precision_table, precision_chart  ->  what the points say, as rows and as a picture
"""
