"""Advice on a run: the choice of the method, limits of its time step, and warnings about unusual input."""
