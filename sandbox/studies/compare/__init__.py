"""Comparison of the same collision in several chains, in one film and in numbers: sides, results, report."""
