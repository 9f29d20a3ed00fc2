"""The status of a run, and warnings of what may be wrong with it: values with codes; no program has to read a sentence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum, StrEnum


class Status(IntEnum):
    """How a run ended; the numbers are those of the kernels (`softcradle.physics.numerics.records`)."""

    DONE = 0  # the end time was reached
    SEPARATED = 1  # no contact pushes and none can close again, or all beads rest
    OUT_OF_STEPS = 2  # the method gave up before the end: too many steps
    FAILED = 3  # the method gave up before the end: it could not go on
    # the end was reached, but the motion determines it less well than the tolerance: see velocity_error
    UNDETERMINED = 4
    # the end was reached, but the step budget of the adaptive method ended before: see velocity_error
    BUDGET_SPENT = 7

    @property
    def gave_up(self) -> bool:
        """Whether the run stopped before its end: its last velocities are then not final."""
        return self in (Status.OUT_OF_STEPS, Status.FAILED)


class WarningCode(StrEnum):
    """What may be wrong with a motion."""

    GAVE_UP = "gave-up"  # the run stopped before its end
    UNCONVERGED = "unconverged"  # steps were taken although their contact forces did not converge
    LOG_FULL = "log-full"  # contacts switched more often than the log has rows
    ENERGY = "energy"  # energy has not come back within what the tolerance promises
    SENSITIVE = "sensitive"  # finer runs disagree by more than the tolerance promises
    BUDGET = "budget"  # the step budget ended before the motion, or before a finer run confirmed its end
    ESTIMATE = "estimate"  # the estimated error of a live state is above the guarantee
    STEP_LIMIT = "step-limit"  # the step is beyond the limit of an explicit method on this chain
    CHATTER = "chatter"  # contacts switch as often as steps are taken
    COARSE_STEP = "coarse-step"  # the step is too long to resolve the shortest contact
    RETURNS = "returns"  # contacts close so often again that the errors of a fixed step may have grown large
    LATE_START = "late-start"  # the motion began before its first sample
    UNUSUAL = "unusual"  # a number can be computed with but is hardly meant
    UNKNOWN = "unknown"  # read from a file that knew no codes, or of a version that knows more


@dataclass(frozen=True, slots=True)
class CodedWarning:
    """One warning: its code, a sentence for people, and the numbers in it by name."""

    code: WarningCode
    sentence: str
    numbers: Mapping[str, float] = field(default_factory=dict, compare=False)

    def __str__(self) -> str:
        return self.sentence


Warnings = tuple[CodedWarning, ...]
