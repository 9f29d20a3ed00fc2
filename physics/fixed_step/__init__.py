"""Methods of fixed steps: one loop, and the families of steps it takes."""
