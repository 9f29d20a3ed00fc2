"""Mutation testing: kernels with one small change each, and whether the tests of their room notice it."""
