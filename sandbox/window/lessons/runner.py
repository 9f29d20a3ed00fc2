"""Lessons: a question about a scene, the user's prediction, the motion, and the answer measured in the motion."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path

from softcradle.sandbox.languages import _, scene_words
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.summary_text import outcome_text, session_outcome
from softcradle.sandbox.story.outcome import Outcome
from softcradle.sandbox.window.dialog import Choices
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.scene.clock import SceneClock
from softcradle.scenes import load

FILE = Path(__file__).parent / "lessons.toml"


@dataclass(frozen=True)
class Lesson:
    """A question about a scene.

    Attributes:
        scene: name of the scene.
        question, choices: text of the question and the possible answers.
        measure: name in MEASURES of the function that finds the right choice.
        why: one sentence for each choice that explains it.
    """

    scene: str
    question: str
    choices: tuple[str, ...]
    measure: str
    why: tuple[str, ...]

    def answer(self, outcomes: Sequence[Outcome]) -> int | None:
        """Return the number of the right choice for the outcome of each lane, or None if no choice is right."""
        return MEASURES[self.measure](outcomes)


@lru_cache(maxsize=1)
def lessons() -> tuple[Lesson, ...]:
    """Return all lessons in order."""
    tables = tomllib.loads(FILE.read_text(encoding="utf-8"))["lesson"]
    return tuple(Lesson(**{**table, **{key: tuple(table[key]) for key in ("choices", "why")}}) for table in tables)


def _leaving(outcomes: Sequence[Outcome]) -> int:
    """Return 0 if the fastest group of targets is a single bead, 1 if it is more than half of them, 2 if it is fewer."""
    outcome = outcomes[0]
    targets = len(outcome.start) - 1
    fastest = max(outcome.groups, key=lambda group: group.velocity)
    count = fastest.last - max(fastest.first, 1) + 1
    return 0 if count == 1 else 1 if 2 * count > targets else 2


def _striker(outcomes: Sequence[Outcome]) -> int:
    """Return 0 if the first bead stands still or nearly so, 1 if it bounces back, 2 if it goes on."""
    outcome = outcomes[0]
    group = outcome.group_of(0)
    if group is None or not group.moves:
        return 0
    return 1 if group.velocity * outcome.start[0] < 0.0 else 2


def _together(outcomes: Sequence[Outcome]) -> int | None:
    """Return 0 or 1, the lane in which all targets leave together, 2 for both lanes, or None."""
    whole = [outcome.group_of(1) for outcome in outcomes]
    leave = [
        group is not None and group.moves and group.last == len(outcome.start) - 1
        for group, outcome in zip(whole, outcomes, strict=True)
    ]
    return None if not any(leave) else 2 if all(leave) else leave.index(True)


MEASURES: dict[str, Callable[[Sequence[Outcome]], int | None]] = {
    "leaving": _leaving,
    "striker": _striker,
    "together": _together,
}


class LessonRunner:
    """Asks the questions about the scene of a page: multiple-choice lessons, or the scene's own question with a typed
    answer.

    Attributes:
        predicted: index of the choice or the typed prediction; None if no prediction waits for its answer.
        answered: True after a motion has ended; the explanation of the scene is then shown.
    """

    def __init__(self, host: Host, session: Session, clock: SceneClock) -> None:
        self.host, self.session, self.clock = host, session, clock
        self.begin()

    def begin(self) -> None:
        """Find the questions about the scene again, because its text may have changed."""
        self.own = [lesson for lesson in lessons() if load(lesson.scene) == self.session.scene]
        self.predicted: int | str | None = None
        self.answered = False
        self._next = self._edits = 0

    @property
    def question(self) -> str:
        """The question to ask before the scene is played; empty if there is none or the scene has already been played."""
        if self.answered or self.session.edited:
            return ""
        return _(self.own[0].question) if self.own else self.session.scene.question

    def ask(self) -> None:
        """Ask the next question about this scene."""
        title = _("What do you predict?")
        if self.own:
            choices = {_(text): partial(self._predict, k) for k, text in enumerate(self.lesson.choices)}
            self.host.choose(title, _(self.lesson.question), choices, neutral=True)
        elif self.session.scene.question:
            self.host.ask(title, self.session.scene.question, "", self._predict)
        else:
            scenes = ", ".join(dict.fromkeys(scene_words(load(lesson.scene).title) for lesson in lessons()))
            self.host.messages.hint(_("there are lessons about: {scenes}", scenes=scenes))

    @property
    def lesson(self) -> Lesson:
        """The current lesson."""
        return self.own[self._next % len(self.own)]

    @property
    def _edited(self) -> bool:
        """True if the scene differs from the catalogue or a bead was pulled while it ran."""
        return self.session.edited or any(step.number > self._edits for step in self.session.undo_stack.done)

    def _predict(self, choice: int | str) -> None:
        self.predicted = choice
        self._edits = max((step.number for step in self.session.undo_stack.done), default=0)
        self.clock.pause()
        self.clock.restart()
        self.clock.play_pause()

    def update(self) -> None:
        """Show the answer at the end of the motion."""
        if not self.clock.end.reached:
            return
        self.answered = True
        predicted, self.predicted = self.predicted, None
        if isinstance(predicted, str):
            self._tell(predicted)
        elif predicted is not None:
            self._answer(predicted)

    def _tell(self, words: str, more: Choices | None = None) -> None:
        """Show the prediction and the outcome of each bead."""
        said = words if words.endswith((".", "!", "?")) else f"{words}."
        text = _("You predicted: {words} What happened: {outcome}", words=said, outcome=outcome_text(self.session))
        self.host.choose(_("What happened"), text, {_("Close"): lambda: None, **(more or {})})

    def _answer(self, predicted: int) -> None:
        """Show the measured answer and its explanation. An edited scene shows only the outcome, because the texts do
        not apply to it.
        """
        lesson = self.lesson
        answer = lesson.answer([session_outcome(self.session, lane) for lane in range(len(self.session.lanes))])
        self._next += 1
        more: Choices = {_("Next question"): self.ask} if self._next < len(self.own) else {}
        if answer is None or self._edited:
            self._tell(_(lesson.choices[predicted]), more)
            return
        title = _("As you predicted") if answer == predicted else _("Not as you predicted")
        note = _("What happened: {answer}. {why}", answer=_(lesson.choices[answer]), why=_(lesson.why[answer]))
        self.host.choose(title, note, {_("Close"): lambda: None, **more})
