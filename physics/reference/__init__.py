"""What the rest is checked against, sharing no kernel with it: SciPy's integrators between located switches."""
