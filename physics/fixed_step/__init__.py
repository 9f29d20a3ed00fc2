"""Methods with fixed steps: one loop over the steps, and the different kinds of steps."""
