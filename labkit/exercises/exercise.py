"""An exercise: task, check on the live graph, hints in steps, a solution with its reason."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from labkit.errors import LabError
from labkit.exercises.attempts import progress_store
from labkit.exercises.clauses.base import Clause
from labkit.exercises.expect.endpoints import alone
from labkit.exercises.learner_errors import explain_error, last_cell
from labkit.exercises.pending import Pending, learner_task_runs
from labkit.exercises.probe import Probe
from labkit.exercises.recorder import Recorder
from labkit.exercises.scope import Scope
from labkit.exercises.standing import after
from labkit.exercises.traces import refuse_nameless, refuse_traces
from labkit.exercises.verdict import Fail, LearnerError, NotAttempted, Outcome, Verdict
from labkit.exercises.watch import Watch
from labkit.views.card import Card
from labkit.views.solution import SolutionCard

if TYPE_CHECKING:
    from labkit.exercises.lesson import Lesson
    from labkit.exercises.variants import Variants

__all__ = ['Exercise', 'Solution', 'Style', 'Wrong', 'changed']

NOTHING_YET = (
    'Not attempted yet. Write your code in the cell above, run that cell, then run this one again.'
)

STARTING = (
    'Nothing to see yet, but a process has been started here a moment ago. '
    'Run this cell again when it is up.'
)


@dataclass(frozen=True)
class Solution:
    """One right answer, to be shown.

    Attributes:
        code: What the learner would write in the starter cell.
        reason: Why it is done so.
    """

    code: str
    reason: str


@dataclass(frozen=True)
class Style:
    """The same solution in another style, for the tests.

    Attributes:
        name: Such as `'functions'` or `'own process'`.
        code: The code.
        process: Whether it is a script for a process of its own.
    """

    name: str
    code: str
    process: bool = False


@dataclass(frozen=True)
class Wrong:
    """A typical wrong answer, for the tests.

    Attributes:
        name: Such as `'starts at 0'`.
        code: The code.
        says: A sentence, or a part of one, that the verdict must contain.
        outcome: The outcome that it must get: FAIL, or ERROR if the code raises.
        process: Whether it is a script for a process of its own.
        refused: What a linter finds in it, where that is the mistake; `''` if it finds nothing.
    """

    name: str
    code: str
    says: str
    outcome: Outcome = Outcome.FAIL
    process: bool = False
    refused: str = ''


def changed(code: str, *changes: tuple[str, str]) -> str:
    """Return code with some parts of it replaced, as a wrong answer or another style has them.

    Args:
        code: The code.
        changes: Pairs of what is there, exactly, and what stands there instead.

    Raises:
        ValueError: One of them is not there.
    """
    for old, new in changes:
        if old not in code:
            raise ValueError(f'{old!r} is not in the code:\n{code}')
        code = code.replace(old, new)
    return code


@dataclass(eq=False, kw_only=True)
class Exercise:
    """An exercise of a lesson. `check()`, `hint()` and `solution()` are for the learner.

    Attributes:
        name: Its name as a Python name: `lesson.count_up`.
        task: The task in a sentence or two.
        clauses: What the task asks for, clause by clause; the check looks at each of them.
        judge: Looks at what no clause has words for, with a probe and the matchers of `expect`.
            It raises what is wrong, and returns a sentence on what was seen, or None.
        publishes: Topics on which the learner's nodes publish, by full name, with their types.
        subscribes: Topics to which they subscribe, with their types.
        serves: Services that they offer, with their types.
        nodes: Full names of nodes that the task asks for.
        shared: Topics on which others may publish too. On all others in `publishes` a second
            publisher is a fault, whenever it comes.
        reliable: Topics on which those who listen ask for reliable delivery, as the robot does:
            they hear nothing of a publisher with best effort.
        hints: From a nudge to nearly the answer.
        answer: The solution that is shown.
        styles: The solution in other styles, for the tests.
        wrong: Typical wrong answers, for the tests.
        given: Full names of nodes that the lesson itself leaves running for this exercise, with
            the ids of the cells that make them, with spaces in between; `'*'` for any cell,
            `''` for none, as for a node of another process.
        records: Those topics in `publishes` that are recorded from the setup cell on: for what
            happens once, and before the check. The judge finds them in `probe.recorded`.
        once: Whether the check uses up what it checks, as a node that is removed. The same
            nodes then get the same verdict again.
        starter_id: Id of the notebook cell to edit; `'count-up-starter'` if empty.
        check_id: Id of the cell with the check; `'count-up-check'` if empty.
    """

    name: str
    task: str
    hints: Sequence[str]
    answer: Solution
    clauses: Sequence[Clause] = ()
    judge: Callable[[Probe], str | None] | None = None
    publishes: Mapping[str, str] = field(default_factory=dict)
    subscribes: Mapping[str, str] = field(default_factory=dict)
    serves: Mapping[str, str] = field(default_factory=dict)
    nodes: Sequence[str] = ()
    shared: Sequence[str] = ()
    reliable: Sequence[str] = ()
    styles: Sequence[Style] = ()
    wrong: Sequence[Wrong] = ()
    given: Mapping[str, str] = field(default_factory=dict)
    records: Sequence[str] = ()
    once: bool = False
    starter_id: str = ''
    check_id: str = ''

    def __post_init__(self) -> None:
        self.lesson = ''
        self.belongs_to: Lesson | None = None
        # What it may be for others, and whose it is; '' if it is what the notebook tells.
        self.variants: Variants | None = None
        self.seed = ''
        self.scope = Scope(
            publishes=self.publishes,
            subscribes=self.subscribes,
            serves=self.serves,
            nodes=tuple(self.nodes),
            shared=frozenset(self.shared),
            reliable=frozenset(self.reliable),
            given=self.given,
        )
        self.scope = replace(self.scope, known=frozenset(self.scope.topics))
        self.starter_id = self.starter_id or f'{self.name.replace("_", "-")}-starter'
        self.check_id = self.check_id or f'{self.name.replace("_", "-")}-check'
        recorded = {topic: self.publishes[topic] for topic in self.records}
        self._recorder = Recorder(recorded) if recorded else None
        self._hints_shown = 0
        self._before: tuple[frozenset[bytes], Verdict] | None = None

    @property
    def task_id(self) -> str:
        """Id of the cell with the task."""
        return f'{self.starter_id.removesuffix("-starter")}-task'

    def begin(self) -> None:
        """Get ready: called in the setup cell of the notebook."""
        if self._recorder is not None:
            from labkit.background.spinning import start

            start()
            self._recorder.keep()
            last_cell.after_each(self._recorder.keep)

    def forget(self) -> None:
        """Forget earlier attempts."""
        self._before = None
        if self._recorder is not None:
            self._recorder.forget()

    def keep(self, verdict: Verdict) -> None:
        """Say the same again, as long as nothing new is there."""
        with Probe(self.name, self.scope) as probe:
            self._before = (probe.fingerprint(), verdict)

    def check(self) -> Verdict | Pending:
        """Look at what your nodes do, and say whether it is what the task asks for.

        Returns:
            The verdict. Where an asyncio task of the notebook is at work, one that is about to
            come: see `Pending`.
        """
        last_cell.asked()
        return Pending(self.name, self._check) if learner_task_runs() else self._check()

    def _check(self) -> Verdict:
        verdict = self.examine()
        if self.variants is not None and self.seed:
            verdict = self.variants.recognise(self, verdict)
        note = progress_store.note_check(
            self.lesson,
            self.name,
            verdict.outcome.value,
            clause=verdict.clause,
            why=verdict.why,
        )
        if verdict.passed and self.belongs_to is not None:
            verdict = replace(verdict, standing=after(self, progress_store.store.read()[0]))
        return verdict if not note else verdict.with_note(note)

    def hint(self, number: int | None = None) -> Card:
        """Show the next hint, or the one with this number.

        Args:
            number: From 1; the next one that was not shown yet if None.
        """
        last_cell.asked()
        count = len(self.hints)
        if number is not None and not (isinstance(number, int) and 1 <= number <= count):
            raise LabError(f'There are hints 1 to {count}, but the number is {number!r}.')
        if number is None and self._hints_shown >= count:
            text = f'These were all {count} hints. lesson.{self.name}.solution() shows one way.'
            return Card('info', 'HINT', self.name, text=text)
        shown = self._hints_shown + 1 if number is None else number
        self._hints_shown = max(self._hints_shown, shown)
        progress_store.note_hint(self.lesson, self.name, shown)
        return Card('info', f'HINT {shown} of {count}', self.name, text=self.hints[shown - 1])

    def solution(self) -> Card:
        """Show one solution, and why it is done so."""
        last_cell.asked()
        progress_store.note_solution(self.lesson, self.name)
        text = f'{self.answer.reason}\nYours may look different: what counts is what it does.'
        code = self.answer.code.strip()
        return SolutionCard('info', 'SOLUTION', self.name, text=text, code=code)

    def __dir__(self) -> list[str]:
        # What the tab key offers: the rest is for those who write lessons.
        return ['check', 'hint', 'solution']

    def _card(self) -> Card:
        text = f'`lesson.{self.name}.check()`, `.hint()`, `.solution()`'
        asked = ''.join(f'- {clause.text}\n' for clause in self.clauses)
        return Card('info', 'EXERCISE', self.name, text=f'{self.task}\n{asked}{text}')

    def __repr__(self) -> str:
        return repr(self._card())

    def _repr_html_(self) -> str:
        return self._card()._repr_html_()

    # -- the check ------------------------------------------------------------------------------

    def examine(self) -> Verdict:
        """Look at what the learner's nodes do; nothing is noted."""
        recorded = self._recorder.watches() if self._recorder is not None else {}
        try:
            with Probe(self.name, self.scope, recorded=recorded) as probe:
                return self._with_note(self._verdict(probe, recorded), probe)
        except LabError as error:  # ROS can't be started here, for one
            return Verdict(
                Outcome.ERROR,
                self.name,
                'Nothing could be checked.',
                seen=str(error.message),
                todo=error.todo,
            )
        except Exception as error:  # a check never raises, whatever is wrong with it
            return self._own_fault(error)

    def _with_note(self, verdict: Verdict, probe: Probe) -> Verdict:
        if not probe.held_lines:
            return verdict
        lines = f'{probe.held_lines} line{"s" * (probe.held_lines != 1)}'
        return verdict.with_note(
            f'The check let {probe.lived_sec:.0f} s of the time of your nodes pass. They wrote '
            f'{lines} meanwhile, not shown here.'
        )

    def _verdict(self, probe: Probe, recorded: Mapping[str, Watch]) -> Verdict:
        new = any(map(len, recorded.values()))
        if self._before is not None and not new:
            # If the same nodes run, it is the same attempt.
            nodes, earlier = self._before
            if nodes == probe.fingerprint():
                # Without nodes there may be other evidence, as of a refused command.
                if nodes or earlier.passed:
                    return earlier
                verdict = self._judge(probe)
                return earlier if verdict.outcome is Outcome.NOT_ATTEMPTED else verdict
        verdict = self._judge(probe)
        new = any(map(len, recorded.values()))
        if (self.once or new) and verdict.outcome is not Outcome.NOT_ATTEMPTED:
            self.forget()
            self._before = (probe.fingerprint(), verdict)
        return verdict

    def _judge(self, probe: Probe) -> Verdict:
        try:
            try:
                text = self._apply(probe)
                _look_again(probe)
            except (Fail, NotAttempted) as outcome:
                if isinstance(outcome, Fail) and outcome.came_first:
                    raise
                # Consequences look like another mistake, so their cause is the better answer.
                _look_again(probe)
                probe.callbacks.raise_old_error(probe.scope)
                error = last_cell.learner_error()
                if error is not None:
                    raise error from None
                refuse_nameless(probe, self._asked())
                unexplained = isinstance(outcome, NotAttempted) and not str(outcome)
                if unexplained and not probe.something_is_starting():
                    refuse_traces(probe, self._asked())
                raise
        except LearnerError as error:
            return self._learner_error(error)
        except NotAttempted as nothing:
            text = str(nothing) or (STARTING if probe.something_is_starting() else NOTHING_YET)
            # Of a variant the notebook does not tell the task.
            clause = self._asked() if self.seed else ''
            return Verdict(Outcome.NOT_ATTEMPTED, self.name, text, clause=clause)
        except Fail as fail:
            return Verdict(
                Outcome.FAIL,
                self.name,
                expected=fail.expected,
                seen=fail.seen,
                why=fail.why,
                todo=fail.todo,
                clause=fail.clause,
            )
        text = text or 'It does what the task asks for.'
        asked = tuple(clause.text for clause in self.clauses)
        return Verdict(Outcome.PASS, self.name, text, asked=asked)

    def _asked(self) -> str:
        return '; '.join(clause.text for clause in self.clauses) or self.task

    def _apply(self, probe: Probe) -> str | None:
        if self.judge is not None:
            return self.judge(probe)
        from labkit.exercises.clauses import judge

        return judge(probe, self.clauses)

    def _learner_error(self, error: LearnerError) -> Verdict:
        why, todo = explain_error(error.error)
        return Verdict(
            Outcome.ERROR,
            self.name,
            f'{error.where} raised {type(error.error).__name__}.',
            why=why,
            todo=todo or 'Read the last line first: it says what is wrong; the line above, where.',
            trace=error.trace,
        )

    def _own_fault(self, error: Exception) -> Verdict:
        import traceback

        return Verdict(
            Outcome.ERROR,
            self.name,
            'The check itself has failed. That is a fault of the course, not yours.',
            todo='Run the check again. If it stays, please report it with the lines below.',
            trace=''.join(traceback.format_exception(error)[-4:]),
        )


def _look_again(probe: Probe) -> None:
    """Raise Fail if a second publisher has come meanwhile."""
    for topic in sorted(probe.scope.sole):
        alone(probe, topic)
