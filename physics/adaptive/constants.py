"""Tuning constants of the adaptive methods `radau`, `dop853` and `accurate`.

Each comment says what the value is a fraction of, and why it has this value. The factors by which a constant can change
before the errors or the cost change were measured; see docs/measured/constants.md.
"""

from __future__ import annotations

# Errors, as velocities [m/s]
# Error bound of one step, as a fraction of the tolerance. The errors of all steps then
# add up to less than the tolerance. A velocity below the same fraction of this bound counts as zero. Measured: 100
# times the value keeps the errors within the estimate; below a third of it the cost grows by more than a quarter.
TOLERANCE_PART = 0.1
# Precision of the stages in Newton's iteration, as a fraction of the error bound of a step. Rates at an event and
# errors below this fraction of the bound count as zero. The error of the iteration must stay invisible in the error
# estimate.
NEWTON_PART = 0.01
# Relative round-off: a force, an acceleration, a rate or a step below this fraction of the largest of its kind counts
# as zero. About 450 times the machine precision, because such numbers are sums of many terms.
ROUND_OFF = 1e-13
# Newton's iteration stops when every force correction is below this fraction of a reference force. The reference force
# is the largest force in the step. For soft contacts without preload, whose forces differ by many orders of magnitude,
# it is the largest force of the contact itself, but at least this fraction of the largest force of all.
FORCE_PRECISION = 1e-3
# Largest error of dop853 for a force that varies as |t - t_o|**a with a > 1, as a fraction of its impulse. The nodes of
# a step miss this part of the force. BEGINS: the force begins with the step. ENDS: the force ends in the first half, or
# in the second half of the step. NEARS: the force ends after the step; if the step covers the fraction x of the time
# until then, the error is about NEARS * x**15.
BEGINS, ENDS, NEARS = 2e-4, (0.25, 0.01), 1e-4
# The same fraction if a contact nearly opens within the step, if a force law has a kink in the step, or if a force ends
# within a step of radau.
KINK = 0.01
# A contact nearly opens within a step if its smallest overlap is below this fraction of the larger overlap at the ends
# of the step.
GRAZE = 0.1
# Factor in the error of a contact in a step of radau: fine error times min(1, RATIO * fine error / coarse error). The
# ratio extrapolates the fine estimate, which is of lower order than the method. Never more than the fine error.
RATIO = 3.0

# Closing speed above which an impact counts as full-speed, as a fraction of the speed that the tolerance is relative
# to. Impacts at full speed take a bounded number of steps each, so a run follows them beyond the usual budget.
# Chattering contacts close more and more slowly.
FULL_SPEED = 0.01

# Delay after an event at which forces are evaluated to decide which contacts and beads at rest start to move. Unit: the
# time in which the largest force changes a velocity by the value that counts as zero. See the header of
# `corner_action`.
MOMENT = 10.0

# Lengths of steps
# Safety factor: the fraction of an allowed step length that is tried. 0.9 is the usual value of step size controllers
# (Hairer, Norsett & Wanner, Solving ODEs I, II.4).
SAFETY = 0.9
# Position of the end of a force in a step that goes past it, as a fraction of the step length. In the second half of
# the step the nodes miss little of the force (see ENDS).
PAST = 0.75
# Length of the next attempt after Newton's iteration diverged, or after no step could end at an event, as a fraction of
# the rejected step.
SHRINK = 0.25
# Smallest next attempt after a step was rejected, as a fraction of that step. If an event lies even closer to the start
# of a step, the next attempt has this fraction as well, because the polynomial of a long step is inaccurate near its
# start.
LEAST_PART = 0.1
# Largest ratio of successive step lengths. Steps have to grow after the onset of a soft contact, but the error estimate
# is reliable only for moderate growth.
MOST_GROWTH = 8.0
# Growth of a step beyond what its error estimate allows: if the errors of the last two steps predict it, and for the
# next step of radau if only stiffness limits dop853.
FURTHER_GROWTH = 2.0
# First step, as a fraction of the fastest local period or crossing time. No earlier step can predict its length. Also
# the part of a step by which an event search moves on if the guard and its derivatives vanish at the start, and the
# largest distance of an event from the end of its step.
FIRST_PART = 0.01
# Largest (step length times local frequency)² of a soft contact in a step of dop853. Beyond it the explicit method is
# close to its stability limit, and radau takes the step.
STIFF = 9.0
# Measured cost of a step of dop853, relative to a step of radau. dop853 takes a step if it is at least this fraction as
# long as the step of radau.
COST_RATIO = 0.4

# Initial guesses of the stages
# Largest logarithm by which a force grows or falls in an initial guess. The factor is 3. Smaller limits cost
# more iterations; larger ones made no difference.
MOST_GUESSED = 1.1

# Searches
# Largest number of Newton iterations, and of attempts to end a step at an event. Both converge quadratically, so 15 is
# enough even for a poor guess.
MOST_TRIES = 15
# Largest number of attempts for searches that seldom need more than one, before another strategy is used.
FEW_TRIES = 4
# Largest number of subdivisions in the search for a root. A search that needs more has found a double root, at which a
# guard touches zero but does not change its sign.
MOST_MOVES = 120
# Overlap [m] beyond which Newton's iteration has diverged, and slope [N/m] beyond which the curve of a contact counts
# as vertical. It is far beyond every physical number, and its square root is a finite float.
HUGE = 1e200
# Number of contacts on both sides of an active range that are computed with it. A wave front advances by one or two
# contacts in a step.
MARGIN = 4
