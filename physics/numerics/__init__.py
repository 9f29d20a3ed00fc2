"""Kernels that several methods share: compilation, contact laws and their resolvents, powers, and the solver of contact
forces.
"""
