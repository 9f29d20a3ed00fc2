"""Independent reference solution, with which tests compare the other methods.

It integrates with SciPy between the located contact switches. It does not use any kernel of the other methods.
"""
