"""Soft contacts in a pymunk Space: SoftContact, SoftChain, and the method that simulates a chain by pymunk bodies."""
