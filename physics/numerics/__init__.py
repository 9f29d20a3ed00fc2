"""What all methods share inside compiled loops: jit, the contact law, its resolvent, powers, the contact solver."""
