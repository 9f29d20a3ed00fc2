"""Work against precision: cases with known outcomes, our methods and other integrators, and the time each needs for an error.

cases           ->  the collisions, each with its true outcome
measurement     ->  our methods under one call, which other integrators share (benchmarks/peers); error and time of every setting
table, chart    ->  what the points say, as rows and as a picture
"""
