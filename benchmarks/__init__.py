"""Measurements of speed and accuracy. Run them with ``python -m benchmarks`` or ``make bench``.

The measurements are not part of the installed package.
"""
