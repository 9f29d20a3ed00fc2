"""Lessons. A lesson asks a question about a scene, and the user predicts the answer. The motion then shows the right
answer.
"""

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
from softcradle.sandbox.window.scene.outcome_card import OutcomeCard
from softcradle.scenes import Scene, load

FILE = Path(__file__).parent / "lessons.toml"


@dataclass(frozen=True)
class Lesson:
    """A question about a scene, with several answers to choose from.

    Attributes:
        scene: name of the scene.
        question, choices: text of the question and the possible answers.
        measure: name in MEASURES of the function that finds the right answer.
        why: one sentence for each answer that explains it.
    """

    scene: str
    question: str
    choices: tuple[str, ...]
    measure: str
    why: tuple[str, ...]

    def answer(self, outcomes: Sequence[Outcome]) -> int | None:
        """Return the index of the right choice for the given outcome of each lane, or None if no choice is right."""
        return MEASURES[self.measure](outcomes)


@lru_cache(maxsize=1)
def lessons() -> tuple[Lesson, ...]:
    """Return all lessons in order."""
    tables = tomllib.loads(FILE.read_text(encoding="utf-8"))["lesson"]
    return tuple(Lesson(**{**table, **{key: tuple(table[key]) for key in ("choices", "why")}}) for table in tables)


def _leaving(outcomes: Sequence[Outcome]) -> int:
    """Return an index for the group of targets that leaves fastest: 0 for a single bead, 1 for more than half, 2 for
    fewer.
    """
    outcome = outcomes[0]
    targets = len(outcome.start) - 1
    fastest = max(outcome.groups, key=lambda group: group.velocity)
    count = fastest.last - max(fastest.first, 1) + 1
    return 0 if count == 1 else 1 if 2 * count > targets else 2


def _striker(outcomes: Sequence[Outcome]) -> int:
    """Return an index for the motion of the first bead: 0 if it is nearly at rest, 1 if it bounces back, 2 if it goes
    on.
    """
    outcome = outcomes[0]
    group = outcome.group_of(0)
    if group is None or not group.moves:
        return 0
    return 1 if group.velocity * outcome.start[0] < 0.0 else 2


def _together(outcomes: Sequence[Outcome]) -> int | None:
    """Return the index of the lane in which all targets leave together, 2 for both lanes, or None for neither."""
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
    """Asks the questions about the scene of a page before it is played. After the run it shows if the predictions were
    right.

    A scene has multiple-choice lessons, or its own question with a typed answer. The panels show the questions next to
    the beads. If a panel has too little space, a dialog shows the question instead.

    Arguments:
        card: receives the text with the result.
        alone: the scene with a single lane from which a comparison was made, or None. Its lessons are about the first
            lane.
        beside: returns True if the visible panel shows the choices.

    Attributes:
        predictions: indices of the choices so far, one for each lesson that was answered.
        typed: the typed prediction, or None.
        answered: True after a motion has ended; the explanation of the scene is then shown.
        explanations: one sentence for each lesson that was predicted, which explains its answer.
    """

    def __init__(
        self,
        host: Host,
        session: Session,
        clock: SceneClock,
        card: OutcomeCard,
        alone: Scene | None,
        beside: Callable[[], bool],
    ) -> None:
        self.host, self.session, self.clock, self.card, self.alone, self.beside = (
            host,
            session,
            clock,
            card,
            alone,
            beside,
        )
        self.begin()

    def begin(self) -> None:
        """Find the questions about the scene again, because an edit of its text may have changed them."""
        scene = self.alone or self.session.scene
        self.own = [lesson for lesson in lessons() if load(lesson.scene) == scene]
        self.answered = self._asked = False
        self.explanations: list[str] = []
        self._forget()

    def _forget(self) -> None:
        self.predictions: list[int] = []
        self.typed: str | None = None
        self._edits = max((step.number for step in self.session.undo_stack.done), default=0)

    @property
    def lesson(self) -> Lesson | None:
        """The next lesson to answer, or None."""
        return self.own[len(self.predictions)] if len(self.predictions) < len(self.own) else None

    @property
    def _waits(self) -> bool:
        """True if the scene has not been played yet. Questions about an edited scene are shown only on request."""
        return not self.answered and (self._asked or not self.session.edited) and self.typed is None

    @property
    def question(self) -> str:
        """The question to answer before the scene is played. It is empty if there is no question, or after a run."""
        if not self._waits:
            return ""
        if not self.own:
            return scene_words(self.session.scene.question)
        if self.lesson is None:
            return ""
        text = _(self.lesson.question)
        return _("Upper row: {question}", question=text) if self.alone is not None else text

    @property
    def choices(self) -> Choices:
        """The buttons with the possible answers, below the question."""
        if not self.question:
            return {}
        if self.lesson is None:
            return {_("Type a prediction"): self._ask_typed}
        return {_(text): partial(self._predict, k) for k, text in enumerate(self.lesson.choices)}

    @property
    def title(self) -> str:
        """The title above the question, with its number if there are several."""
        title = _("What do you predict?")
        return f"{title} {len(self.predictions) + 1}/{len(self.own)}" if len(self.own) > 1 else title

    def ask(self) -> None:
        """Return to the start and ask all questions about this scene again."""
        if not self.own and not self.session.scene.question:
            scenes = ", ".join(dict.fromkeys(scene_words(load(lesson.scene).title) for lesson in lessons()))
            self.host.messages.hint(_("there are lessons about: {scenes}", scenes=scenes))
            return
        self._forget()
        self.answered, self._asked = False, True
        self.clock.pause()
        self.clock.restart()
        self.host.follow()
        if not self.own:
            self._ask_typed()
        elif not self.beside():
            self._ask_in_dialog()

    def _ask_in_dialog(self) -> None:
        self.host.choose(self.title, self.question, self.choices, neutral=True)

    def _ask_typed(self) -> None:
        self.host.ask(_("What do you predict?"), scene_words(self.session.scene.question), "", self._take_typed)

    def _take_typed(self, text: str) -> None:
        self._forget()
        self.typed = text
        self._play()

    def _predict(self, choice: int) -> None:
        """Store the choice for the present lesson. After the last lesson, play the scene."""
        if not self.predictions:
            self._forget()
        self.predictions = [*self.predictions, choice]
        self.host.follow()
        if self.lesson is None:
            self._play()
        elif not self.beside():
            self._ask_in_dialog()

    def _play(self) -> None:
        self.clock.pause()
        self.clock.restart()
        self.clock.play_pause()

    @property
    def _edited(self) -> bool:
        """True if the scene differs from the scene of the catalogue, or if a bead was pulled while it ran."""
        return self.session.edited or any(step.number > self._edits for step in self.session.undo_stack.done)

    def update(self) -> None:
        """Show the result of the predictions at the end of the motion."""
        if not self.clock.end.reached:
            return
        self.answered = True
        verdict = self._verdict()
        if not verdict:
            return
        self._forget()
        if self.session.playing:  # The motion continues, so a card would be hidden at once.
            text = f"{verdict}\n{outcome_text(self.session)}"
            self.host.choose(_("What happened"), text, {_("Close"): lambda: None})
        else:
            self.card.show_outcome(verdict)

    def _verdict(self) -> str:
        """Return a sentence for each prediction, or an empty text without a prediction. Store the explanations of the
        answers.

        For an edited scene, the sentences only repeat the predictions, because the explanations do not apply to it.
        """
        if self.typed is not None:
            words = self.typed if self.typed.endswith((".", "!", "?")) else f"{self.typed}."
            return _("You predicted: {words}", words=words)
        if not self.predictions:
            return ""
        outcomes = [session_outcome(self.session, lane) for lane in range(len(self.session.lanes))]
        said, self.explanations = [], []
        for lesson, choice in zip(self.own, self.predictions, strict=False):
            answer, predicted = lesson.answer(outcomes), _(lesson.choices[choice])
            if answer is None or self._edited:
                said.append(_("You predicted: {words}", words=f"{predicted}."))
                continue
            self.explanations.append(_(lesson.why[answer]))
            happened = _(lesson.choices[answer])
            if answer == choice:
                said.append(_("As you predicted: {answer}.", answer=happened))
            else:
                said.append(_("You predicted: {words}", words=f"{predicted}."))
                said.append(_("What happened: {answer}.", answer=happened))
        return " ".join(said)
