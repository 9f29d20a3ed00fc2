"""Fixed-step methods: one step loop and the kinds of steps that it can take."""
