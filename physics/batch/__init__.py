"""Very many short chains at once: arrays with a row a chain, and kernels that move one row after the other."""
