"""Comparison: the same collision in several chains, in one film and in numbers side by side: sides, results, report."""
