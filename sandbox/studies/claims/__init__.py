"""Measurement of the paper's statements: one function for each statement, and a verdict that follows from its numbers."""
