"""The constants of the steps of `radau`, `dop853` and `accurate`, in one table: what each is, and parts of what.

How far each can move before errors or work tell was measured: docs/measured/constants.md.
"""

from __future__ import annotations

# Errors, as velocities
TOLERANCE_PART = 0.1  # of the tolerance: the error bound of each step; of this bound: a velocity that does not count
# of a step's error bound: the precision of its stages; a smaller error, or rate at d = 0, counts as none
NEWTON_PART = 0.01
ROUND_OFF = 1e-13  # of the largest of its kind: less than this of a force, an acceleration, a rate or a step is none
# no correction of a force is larger at the end of Newton's iteration: of the largest force in the step; of a soft contact without
# preload of its own largest, or of this part of the largest of all
FORCE_PRECISION = 1e-3
# of its impulse, what dop853 misses at the most of a force like |t - t_o|**a, a > 1: one that begins with the step; one that ends
# in its first half, in its second; about the part x of the time until it ends, over x**15
BEGINS, ENDS, NEARS = 2e-4, (0.25, 0.01), 1e-4
KINK = 0.01  # and of one whose law has a bend, or that all but ends, in the step; with radau, of one that ends
GRAZE = 0.1  # of the larger overlap at the ends of a step: a contact with less between is all but open there
RATIO = 3.0  # the error of a contact is its fine error times this times fine over coarse error, 1 at the most

# Part of the tolerance's speed scale above which a contact closes at full speed. Such impacts take a bounded number of steps each
# and are followed beyond the usual budget; chattering contacts close more and more slowly.
FULL_SPEED = 0.01

# times the velocity that counts as none: forces that decide which rows at rest give way are taken so much later
MOMENT = 10.0

# Lengths of steps
SAFETY = 0.9  # of a length that something allows: what is tried
PAST = 0.75  # of a step that goes past the end of a force: where that is to be
SHRINK = 0.25  # of a step whose stages do not converge: the next try
LEAST_PART = 0.1  # of a step rejected: the next try is no shorter; of a step whose polynomial is coarse near its start: its start
MOST_GROWTH = 8.0  # of a step over the one before
# taken on trust: beyond that of the error, and of radau's step where stiffness alone limits dop853
FURTHER_GROWTH = 2.0
# of the fastest local period or crossing, or of a step: the first part, where nothing tells how far to go
FIRST_PART = 0.01
STIFF = 9.0  # (step times local frequency)², above which a soft contact is left to radau
COST_RATIO = 0.4  # time of a step of dop853 over one of radau

# Guesses of stages
MOST_GUESSED = 1.1  # logarithm of the growth of a force in a guess, or of its fall, at the most

# Searches
MOST_TRIES = 15  # iterations of Newton, and tries to end a step at an event
FEW_TRIES = 4  # tries of what seldom needs more than one, before another way is taken
MOST_MOVES = 120  # of the search for a root: one that takes more has met a root that only touches zero
HUGE = 1e200  # an overlap [m] beyond which Newton's iteration has diverged; a slope beyond which a contact counts as touching
MARGIN = 4  # contacts around those that push, or whose stages still change: a wave front runs one or two a step
