"""What the paper states, measured: one function a statement, and a verdict that follows from its numbers."""
