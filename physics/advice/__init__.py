"""Which method, how fine a step, and how far to trust it."""
