"""Name, title and text of the hanging cradle."""

from softcradle.sandbox.languages import N_

HANGING_NAME = "hanging-cradle"
HANGING_TITLE = N_("Newton's cradle, hanging, in pymunk")
HANGING_SOURCE = N_("SoftChain, PinJoint strings, gravity")
HANGING_TEXT = N_(
    "Balls on strings in an ordinary pymunk Space, once with soft contacts between them and once with pymunk's own "
    "rigid collisions. Strings, gravity and steps are the same. With a small exponent the balls that are hit swing off "
    "nearly as one body; steel balls pass the blow on to the last; rigid ones share it in the order in which they "
    "are solved. Drag a ball and release it."
)
