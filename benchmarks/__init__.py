"""Measurements of speed and accuracy. Run them with ``python -m benchmarks`` or ``make bench``.

They are not part of the installed package.
"""
