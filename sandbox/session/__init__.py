"""Sessions: scenes that are being played. This is the model behind the window, without pygame and without wall clock in
the physics.

session = Session(scenes.load("one-on-four")) session.play()
session.tick(1 / 60)                       # once for each picture, with the wall time since the last one
session.lanes[0].state                     # the state to draw
session.apply(SetMass(0, 1, 2.0))          # every edit is an Input; a ValueError says why it is refused
session.scrub_frame(60)                    # any frame of the history; playing on from it starts a new branch
session.save_recording("mine.npz")         # Replay.load("mine.npz").run() is True if every state is bitwise the same
"""
