"""The independent reference: SciPy's integrators on a right-hand side that shares no kernel with what it checks."""
