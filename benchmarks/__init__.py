"""Measurements of speed and accuracy: ``python -m benchmarks`` or ``make bench``. They are not part of the installed
package.
"""
