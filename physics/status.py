"""Status of a run, and warnings about possible problems. Both are codes with values, so programs need not parse
sentences.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum, StrEnum


class Status(IntEnum):
    """How a run ended. The numbers are also used in the kernels (`softcradle.physics.numerics.records`)."""

    DONE = 0  # the end time was reached
    SEPARATED = 1  # no contact pushes and none can close again, or all beads rest
    OUT_OF_STEPS = 2  # the method gave up before the end: too many steps
    FAILED = 3  # the method gave up before the end: it could not continue
    # the run reached its end, but the motion determines the end less accurately than the tolerance: see velocity_error
    UNDETERMINED = 4
    # the run reached its end, but not within the step budget of the adaptive method: see velocity_error
    BUDGET_SPENT = 7

    @property
    def gave_up(self) -> bool:
        """True if the run stopped before its end. The last velocities of such a run are not final."""
        return self in (Status.OUT_OF_STEPS, Status.FAILED)


class WarningCode(StrEnum):
    """Codes of possible problems of a motion."""

    GAVE_UP = "gave-up"  # the run stopped before its end
    UNCONVERGED = "unconverged"  # the method continued after steps in which the contact forces did not converge
    LOG_FULL = "log-full"  # contacts switched more often than the log has rows
    ENERGY = "energy"  # the error of the energy is larger than the tolerance guarantees
    SENSITIVE = "sensitive"  # finer runs disagree by more than the tolerance guarantees
    BUDGET = "budget"  # the step budget ended before the motion, or before a finer run confirmed its end
    ESTIMATE = "estimate"  # the estimated error of a live state is above the guarantee
    STEP_LIMIT = "step-limit"  # the step is beyond the stability limit of an explicit method on this chain
    CHATTER = "chatter"  # contacts switch as often as steps are taken
    COARSE_STEP = "coarse-step"  # the step is too long to resolve the shortest contact
    RETURNS = "returns"  # contacts close so often that the errors of a fixed step may have become large
    LATE_START = "late-start"  # the motion began before its first sample
    UNUSUAL = "unusual"  # a number is valid but probably not intended
    UNKNOWN = "unknown"  # the warning was read from a file without codes, or has a code of a later version


@dataclass(frozen=True, slots=True)
class CodedWarning:
    """Warning with its code, a sentence for people, and a dictionary of the numbers in the sentence."""

    code: WarningCode
    sentence: str
    numbers: Mapping[str, float] = field(default_factory=dict, compare=False)

    def __str__(self) -> str:
        return self.sentence


Warnings = tuple[CodedWarning, ...]
