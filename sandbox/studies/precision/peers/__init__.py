"""Other integrators on the same collisions: a module each, left out where its package is not installed.

Each has what an expert would give it: overlaps as variables, a compiled right-hand side, absolute tolerances finer for
overlaps than for rates, a small first step (without it the collision would be stepped over). None can stop when a
collision is over, so each runs to its known end. None has contacts that touch, so draft gears chatter.
"""
