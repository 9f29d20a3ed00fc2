"""Independent reference solution, with which tests compare the other methods.

SciPy integrates the motion between the located contact switches. The reference solution does not use any kernel of the
other methods.
"""
