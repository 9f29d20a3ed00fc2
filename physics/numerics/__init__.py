"""Kernels that several methods share: compilation, contact laws and their resolvents, powers, the solver of contact forces."""
