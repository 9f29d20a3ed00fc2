"""A golden record of the engine: what every method answers on many chains, bit for bit, to hold a refactoring against.

    python -m benchmarks.golden record FILE.json.gz
    python -m benchmarks.golden check FILE.json.gz [--only KEY-SUBSTRING]

The file holds the problems themselves as well as the answers, so that `check` needs neither the catalogue nor the generator
of random chains. It is a record for one machine and is not committed: another Python, numba, numpy, pymunk, libm or
processor rounds in other places, so `check` then finds runs that are not bit-equal though nothing is wrong.

A run that takes more than its limit of processor time is recorded as slow, and is not checked.
"""
