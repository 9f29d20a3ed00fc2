"""Measurements of speed and accuracy: ``python -m benchmarks`` or ``make bench``. No part of the installed package."""
