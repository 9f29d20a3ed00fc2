"""The colours: Okabe and Ito's, which colour-blind people can distinguish too, and a ramp for long chains."""

from __future__ import annotations

Colour = tuple[int, int, int]

BACKGROUND: Colour = (255, 255, 255)
LANE_BACKGROUND: Colour = (247, 248, 250)
FOREGROUND: Colour = (33, 38, 45)
MUTED: Colour = (101, 109, 120)
FAINT: Colour = (196, 202, 209)
GRID: Colour = (231, 234, 238)
STEEL: Colour = (170, 178, 187)
WARNING: Colour = (190, 60, 0)
GOOD: Colour = (0, 120, 88)

OKABE_ITO: tuple[Colour, ...] = (
    (0, 114, 178),  # blue: the striker, as in Fig. 1
    (230, 159, 0),  # orange
    (0, 158, 115),  # bluish green
    (204, 97, 30),  # vermillion
    (204, 121, 167),  # reddish purple
    (86, 180, 233),  # sky blue
    (96, 96, 96),  # grey in place of yellow, which is hard to see on white
)
# From dark to light, so that neighbours in a long chain differ in lightness.
RAMP: tuple[Colour, ...] = ((72, 26, 108), (62, 74, 137), (38, 130, 142), (53, 183, 121), (190, 200, 50))


def mix(colour: Colour, other: Colour, share: float) -> Colour:
    """`colour` with `share` (0 to 1) of `other` in it."""
    rest, (red, green, blue), (a, b, c) = 1.0 - share, colour, other  # no loop: every edge of a rectangle is mixed
    return round(red * rest + a * share), round(green * rest + b * share), round(blue * rest + c * share)


def bead_colours(count: int) -> tuple[Colour, ...]:
    """The colours of `count` beads. A contact has the colour of the bead on its right, which it pushes."""
    if count <= len(OKABE_ITO):
        return OKABE_ITO[:count]
    return tuple(_ramp(i / (count - 1)) for i in range(count))


def _ramp(share: float) -> Colour:
    place = share * (len(RAMP) - 1)
    k = min(int(place), len(RAMP) - 2)
    return mix(RAMP[k], RAMP[k + 1], place - k)
