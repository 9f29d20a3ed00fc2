"""Methods that choose their steps: radau, dop853, and accurate, which takes either."""
