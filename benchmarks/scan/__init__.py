"""The scan: seeded random chains by family, each solved by a method and by a reference that shares nothing with it."""
