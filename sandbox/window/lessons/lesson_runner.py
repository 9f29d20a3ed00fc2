"""The lesson that is under way: a prediction, the motion, and what was measured."""

from __future__ import annotations

from functools import partial

from softcradle.sandbox.languages import _, scene_words
from softcradle.sandbox.session.history_slices import slice_at
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.lessons.lesson_list import Lesson, lessons
from softcradle.sandbox.window.scene.scene_clock import SceneClock
from softcradle.sandbox.window.window_page import Host
from softcradle.scenes import load


class LessonRunner:
    """Asks the questions about the scene of a page.

    Attributes:
        predicted: the choice that was made; None while none is waiting for its answer.
    """

    def __init__(self, host: Host, session: Session, clock: SceneClock) -> None:
        self.host, self.session, self.clock = host, session, clock
        self.own = [lesson for lesson in lessons() if load(lesson.scene) == session.scene]
        self.predicted: int | None = None
        self._next = self._edits = 0

    def ask(self) -> None:
        """Ask the next question about this scene."""
        if not self.own:
            scenes = ", ".join(dict.fromkeys(scene_words(load(lesson.scene).title) for lesson in lessons()))
            self.host.messages.show(_("there are lessons about: {scenes}", scenes=scenes))
            return
        lesson = self.own[self._next % len(self.own)]
        choices = {_(text): partial(self._predict, k) for k, text in enumerate(lesson.choices)}
        self.host.choose(_("What do you predict?"), _(lesson.question), choices)

    @property
    def lesson(self) -> Lesson:
        """The present one."""
        return self.own[self._next % len(self.own)]

    @property
    def _edited(self) -> bool:
        """Whether the scene is another one than the catalogue's, or a bead was pulled while it ran."""
        return self.session.edited or any(step.number > self._edits for step in self.session.undo_stack.done)

    def _predict(self, choice: int) -> None:
        self.predicted = choice
        self._edits = max((step.number for step in self.session.undo_stack.done), default=0)
        self.session.pause()
        self.clock.restart()
        self.clock.play_pause()

    def update(self) -> None:
        """Show the answer at the end of the motion."""
        if self.predicted is None or not self.clock.end.reached:
            return
        predicted, self.predicted, lesson = self.predicted, None, self.lesson
        begin = [slice_at(self.session.history, k, self.session.history.first) for k in range(len(self.session.lanes))]
        ends = [lane.velocity for lane in self.session.lanes]
        answer = lesson.answer([(one.velocity[0], end) for one, end in zip(begin, ends, strict=True)])
        self._next += 1
        title = _("As you predicted") if answer == predicted else _("Not as you predicted")
        why = "" if self._edited else _(lesson.why[answer])  # reasons are of the scene as it is in the catalogue
        note = _("Measured: {answer}. {why}", answer=_(lesson.choices[answer]), why=why).strip()
        more = {_("Next question"): self.ask} if self._next < len(self.own) else {}
        self.host.choose(title, note, {_("Close"): lambda: None, **more})
