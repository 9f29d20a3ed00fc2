"""Advice on a simulation: choice of the method, limits of the time step, and warnings about unusual input."""
