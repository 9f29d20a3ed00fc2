"""Work-precision chart: the computing time that our methods and other integrators need to reach an error.

cases         ->  the collisions, each with its true result
measurement   ->  error and time of each setting, for our methods and for other integrators (peers)
table, chart  ->  the measured points as rows and as a picture
"""
