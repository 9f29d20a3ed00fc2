"""Maps of rigid-like behaviour: the velocity spread of a struck cluster over two parameters, by sweeps."""
