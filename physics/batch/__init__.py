"""Very many short chains at once: explicit steps of several chains in vector code, the rest without Python for each chain."""
