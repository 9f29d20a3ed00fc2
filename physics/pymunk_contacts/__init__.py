"""Soft contacts in a pymunk Space: SoftContact, SoftChain, and the method that simulates a chain with pymunk bodies."""
