"""Compiled inner loops: scalar loops over plain arrays with caller-owned work arrays. Numba is imported here alone."""
