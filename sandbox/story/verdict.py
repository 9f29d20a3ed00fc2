"""Levels of trust in the accuracy of a motion, and the relative errors that separate the levels."""

GOOD, FAIR, BAD = "good", "fair", "bad"
# Levels of trust, from the best to the worst.
LEVELS = (GOOD, FAIR, BAD)
# Largest relative error of energy or momentum of a good motion. This error is half a pixel of a plot or of a bar.
FAIR_ERROR = 1e-3
# Largest relative error of energy or momentum of a fair motion. A larger error can be seen in the motion.
BAD_ERROR = 1e-2


def level_of(error: float, fair: float = FAIR_ERROR, bad: float = BAD_ERROR) -> str:
    """Return the level of a motion from its relative error. A motion is good up to the error `fair`, fair up to `bad`,
    and bad above `bad`.
    """
    return GOOD if error <= fair else FAIR if error <= bad else BAD
