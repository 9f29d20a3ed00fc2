"""Sessions: scenes that are being played with. The model behind the window: no pygame, no wall clock in the physics.

session = Session(scenes.load("one-on-four"))
session.play()
session.tick(1 / 60)                       # once a picture, with the wall time since the last one
session.lanes[0].state                     # what to draw
session.apply(SetMass(0, 1, 2.0))          # every edit is an Input; a ValueError says what is wrong
session.scrub_frame(60)                    # any frame of the history; playing on from it is a new branch
session.save_recording("mine.npz")         # Replay.load("mine.npz").run() is True where every digit is the same
"""
