"""Rules of a motion that is computed while it plays, in the window and on pages: frames, steps, and the hand.

`page_story.py` gives pages these numbers.
"""

from softcradle.physics.advice.auto_method import LIVE_STEPS

# Frames of the motion per second of wall time. At 60 pictures per second, each picture takes two.
FRAME_RATE = 120
# Cost of a step of the method `conserving` [us per contact].
CONSERVING_COST = 0.3
# Largest cost of a frame with a chosen step [us]. A picture needs two frames and the time to draw it.
FRAME_COST = 1500.0
# Steps per shortest contact of the method `conserving`.
CONTACT_STEPS = LIVE_STEPS
# Angular frequency of the spring between the hand and a bead [1/s of wall time]. The bead follows within a sixth of a second.
HAND_FREQUENCY = 12.0
# Largest speed that the hand gives a bead, in closing speeds. Faster soft beads would pass through each other.
HAND_SPEED = 2.0
