"""Search for free values of a scene.

A fit uses least squares against measured data or stated numbers. A design reaches a goal such as the least force.
"""
