"""Soft contacts in a pymunk Space: SoftContact, SoftChain, and the method that moves a chain as bodies."""
