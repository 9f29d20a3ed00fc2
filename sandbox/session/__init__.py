"""Sessions: scenes that are being played with. The model behind the window: no pygame, no wall clock in the physics.

session = Session(scenes.load("one-on-four"))
session.play()
session.tick(1 / 60)                       # once a picture, with the wall time since the last one
session.lanes[0].state                     # what to draw
session.apply(SetMass(0, 1, 2.0))          # every edit is an Input; a ValueError says what is wrong
session.scrub_frame(60)                    # any frame of the history; playing on from it is a new branch
session.save_recording("mine.npz")         # Replay.load("mine.npz").run() is True where every digit is the same
"""

from softcradle.sandbox.session.inputs import AddBead as AddBead
from softcradle.sandbox.session.inputs import Drag as Drag
from softcradle.sandbox.session.inputs import Drop as Drop
from softcradle.sandbox.session.inputs import Input as Input
from softcradle.sandbox.session.inputs import Lock as Lock
from softcradle.sandbox.session.inputs import Place as Place
from softcradle.sandbox.session.inputs import RemoveBead as RemoveBead
from softcradle.sandbox.session.inputs import Resume as Resume
from softcradle.sandbox.session.inputs import SetContact as SetContact
from softcradle.sandbox.session.inputs import SetDrive as SetDrive
from softcradle.sandbox.session.inputs import SetFriction as SetFriction
from softcradle.sandbox.session.inputs import SetGap as SetGap
from softcradle.sandbox.session.inputs import SetKind as SetKind
from softcradle.sandbox.session.inputs import SetMass as SetMass
from softcradle.sandbox.session.inputs import SetMethod as SetMethod
from softcradle.sandbox.session.inputs import SetSlow as SetSlow
from softcradle.sandbox.session.inputs import SetStep as SetStep
from softcradle.sandbox.session.inputs import SetVelocity as SetVelocity
from softcradle.sandbox.session.replay import Replay as Replay
from softcradle.sandbox.session.session import Session as Session
