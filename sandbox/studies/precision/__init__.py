"""Work-precision chart: cases with known results, our methods and other integrators, and the time that each needs for
an error.

cases         ->  the collisions, each with its true result
measurement   ->  our methods and, through the same interface, other integrators (peers): error and time of every
  setting
table, chart  ->  the points as rows and as a picture
"""
