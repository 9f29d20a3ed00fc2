"""Methods with adaptive steps: radau, dop853, and accurate, which uses one of these two."""
