"""Colours of the light theme, of the dark theme and of beads. Colour-blind people can distinguish the bead colours."""

from dataclasses import dataclass, fields, replace

Colour = tuple[int, int, int]


@dataclass
class Tones:
    """Colours of a theme.

    Attributes:
        background, lane_background: background of pages and plots, and of the lanes of beads.
        foreground, muted, faint: text and lines, from the strongest to the weakest.
        on_accent: text on a button with the accent colour.
        grid: lines of a grid and tracks of bars.
        steel: pistons, and energy stored in contacts.
        accent: controls, and items that are selected or under the pointer. No bead has this colour.
        good, fair, bad, warning: levels of badges, and warnings.
        shadow: layer that dims the page behind a dialog.
        lift: share of white in the colours of beads.
        shades: colours of a force in a space-time diagram, from zero to the largest force.
        ramp: colours along a long chain, in which neighbours differ in lightness.
    """

    background: Colour
    lane_background: Colour
    foreground: Colour
    muted: Colour
    faint: Colour
    on_accent: Colour
    grid: Colour
    steel: Colour
    accent: Colour
    good: Colour
    fair: Colour
    bad: Colour
    warning: Colour
    shadow: Colour
    lift: float
    shades: tuple[Colour, ...]
    ramp: tuple[Colour, ...]


LIGHT = Tones(
    background=(255, 255, 255),
    lane_background=(247, 248, 250),
    foreground=(33, 38, 45),
    muted=(101, 109, 120),
    faint=(196, 202, 209),
    on_accent=(255, 255, 255),
    grid=(231, 234, 238),
    steel=(170, 178, 187),
    accent=(45, 52, 62),
    good=(0, 120, 88),
    fair=(158, 98, 0),
    bad=(176, 18, 38),
    warning=(190, 60, 0),
    shadow=(33, 38, 45),
    lift=0.0,
    shades=((255, 255, 255), (198, 222, 240), (86, 160, 211), (0, 94, 160), (10, 34, 82)),
    ramp=((72, 26, 108), (62, 74, 137), (38, 130, 142), (53, 183, 121), (190, 200, 50)),
)
DARK = Tones(
    background=(24, 27, 32),
    lane_background=(31, 35, 41),
    foreground=(231, 234, 238),
    muted=(152, 161, 172),
    faint=(78, 85, 95),
    on_accent=(24, 27, 32),
    grid=(47, 52, 60),
    steel=(126, 135, 146),
    accent=(214, 219, 226),
    good=(70, 190, 150),
    fair=(230, 170, 60),
    bad=(255, 110, 110),
    warning=(255, 140, 80),
    shadow=(0, 0, 0),
    lift=0.16,
    shades=((24, 27, 32), (21, 62, 104), (31, 128, 193), (128, 196, 240), (236, 247, 255)),
    ramp=((120, 86, 190), (92, 110, 200), (60, 150, 170), (60, 190, 130), (205, 214, 80)),
)
THEMES: dict[str, Tones] = {"light": LIGHT, "dark": DARK}
tones = replace(LIGHT)  # Colours of the current theme. Films, pages and figures use the light theme.

OKABE_ITO: tuple[Colour, ...] = (
    (0, 114, 178),  # blue: the colour of the striking bead, as in Fig. 1
    (230, 159, 0),  # orange
    (0, 158, 115),  # bluish green
    (204, 97, 30),  # vermillion
    (204, 121, 167),  # reddish purple
    (86, 180, 233),  # sky blue
    (96, 96, 96),  # grey instead of the yellow of the palette, which is hard to see on white
)
# Colours of beads: the palette of Okabe and Ito, followed by five more colours that colour-blind people
# can distinguish.
BEAD_COLOURS: tuple[Colour, ...] = (
    *OKABE_ITO,
    (62, 66, 214),  # indigo
    (150, 20, 30),  # dark red
    (120, 40, 150),  # purple
    (160, 130, 255),  # lavender
    (136, 196, 92),  # lime
)
# Relative luminance of a background above which text is dark. At this luminance, dark and white text have about the
# same contrast.
BRIGHT = 0.30


def use_theme(name: str) -> None:
    """Use the colours of the theme `name` from now on. `name` is a key of THEMES. Existing drawings do not change."""
    for field in fields(Tones):
        setattr(tones, field.name, getattr(THEMES[name], field.name))


def mix(colour: Colour, other: Colour, share: float) -> Colour:
    """Return a mixture of two colours. `share` (0 to 1) is the fraction of `other` in the mixture."""
    # The three channels are computed without a loop for speed. This function is called for every edge of a rectangle.
    rest, (red, green, blue), (a, b, c) = 1.0 - share, colour, other
    return round(red * rest + a * share), round(green * rest + b * share), round(blue * rest + c * share)


def luminance(colour: Colour) -> float:
    """Return the relative luminance (0 to 1) of a colour, as the accessibility guidelines WCAG define it."""
    linear = ((c / 255.0 + 0.055) / 1.055 if c > 10 else c / 255.0 / 12.92 for c in colour)
    red, green, blue = (value**2.4 if value > 0.04 else value for value in linear)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def text_on(colour: Colour) -> Colour:
    """Return the colour of text on a background of `colour`. Text is dark on bright colours and white on dark ones."""
    return LIGHT.foreground if luminance(colour) > BRIGHT else LIGHT.background


def bead_colours(count: int) -> tuple[Colour, ...]:
    """Return the colours of `count` beads. A contact has the colour of the bead on its right, because it pushes this
    bead.
    """
    if count <= len(BEAD_COLOURS):
        return tuple(mix(colour, (255, 255, 255), tones.lift) for colour in BEAD_COLOURS[:count])
    return tuple(_ramp(i / (count - 1)) for i in range(count))


def _ramp(share: float) -> Colour:
    place = share * (len(tones.ramp) - 1)
    k = min(int(place), len(tones.ramp) - 2)
    return mix(tones.ramp[k], tones.ramp[k + 1], place - k)
