"""Sessions: scenes that are being played. A session is the model behind the window. It does not depend on pygame.

The physics of a session does not depend on wall time.

    session = Session(scenes.load("one-on-four"))
    session.play()
    session.tick(1 / 60)                 # once per drawn frame, with the wall time since the last frame
    session.lanes[0].state               # the state to draw
    session.apply(SetMass(0, 1, 2.0))    # every edit is an Input; an invalid one raises ValueError
    session.scrub_frame(60)              # any frame of the history; playing from it starts a new branch
    session.save_recording("mine.npz")   # Replay.load("mine.npz").run() is True if all states agree bitwise
"""
