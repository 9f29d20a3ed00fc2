"""Rules of a motion that is computed while it is shown, in the window and on pages. The rules concern the frames, the
time steps and the hand that drags a bead.

Pages get these numbers from `page_story.py`.
"""

from softcradle.physics.advice.auto_method import LIVE_STEPS

# Number of motion frames per second of wall time. With 60 pictures per second, each picture shows two frames.
FRAME_RATE = 120
# Computing time of one step of the method `conserving` [us per contact].
CONSERVING_COST = 0.3
# Largest computing time of a frame if the user has chosen the time step [us]. A picture needs the time of two frames
# and the time for drawing.
FRAME_COST = 1500.0
# Number of steps of the method `conserving` during the shortest contact.
CONTACT_STEPS = LIVE_STEPS
# Angular frequency of the spring between the hand and a dragged bead [1/s of wall time]. The bead follows the hand
# within a sixth of a second.
HAND_FREQUENCY = 12.0
# Largest speed that the hand can give to a bead, as a multiple of the closing speed. Faster soft beads would pass
# through each other.
HAND_SPEED = 2.0
