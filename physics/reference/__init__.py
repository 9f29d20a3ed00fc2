"""Independent reference solution for tests of the other methods. It integrates with SciPy between located switches and
shares no kernel with them.
"""
