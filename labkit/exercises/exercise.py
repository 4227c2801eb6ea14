"""An exercise: task, check on the live graph, hints, and an explained solution."""

from __future__ import annotations

import contextlib
import re
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from labkit import settings
from labkit.errors import LabError
from labkit.exercises import common_mistakes
from labkit.exercises.attempts import refuse_nameless, refuse_traces
from labkit.exercises.clauses.base import Graph
from labkit.exercises.expect.endpoints import alone
from labkit.exercises.history import history
from labkit.exercises.judging import Clause, Stage, judge, naming
from labkit.exercises.learner_errors import explain_error, last_cell
from labkit.exercises.machine_faults import machine_fault
from labkit.exercises.messages_heard import Watch
from labkit.exercises.mistakes import Mistake
from labkit.exercises.pending import Pending, learner_task_runs
from labkit.exercises.probe import Probe
from labkit.exercises.record.progress_store import progress_store
from labkit.exercises.sent_once import Recorder
from labkit.exercises.time.other_time import other_times
from labkit.exercises.verdict import Fail, LearnerError, NotAttempted, Outcome, Verdict
from labkit.exercises.what_is_asked import NODE, PUBLISHER, SERVICE, SUBSCRIPTION, Role, Scope
from labkit.exercises.which_run import changed_since, failed_last, judged_nodes, told_of_older
from labkit.exercises.words import Words
from labkit.views.card import Card
from labkit.views.solution import SolutionCard

if TYPE_CHECKING:
    from labkit.exercises.lesson import Lesson
    from labkit.exercises.variants import Variants
    from labkit.views.verdict_form import VerdictForm

__all__ = ['Exercise', 'Solution', 'read_answer']

_IMPORT_LAB = re.compile(r'^import labkit as lab\n\n?', re.MULTILINE)

NOTHING_YET = (
    'Not attempted yet. Write your code in the cell above, run that cell, then run this one again.'
)

BUSY = 'A cell is running. Check again when it has ended.'

STARTING = (
    'Nothing to see yet, but a process has been started here a moment ago. '
    'Run this cell again when it is up.'
)


@dataclass(frozen=True)
class Solution:
    """A solution to show.

    Attributes:
        module: `__file__` of the exercise's module.
        name: Name of a file in the folder `solutions` beside it: a Python script, an IPython
            script (`.ipy`) if it has magics, or the lines of a terminal (`.sh`).
        reason: Explanation of the solution.
        changes: Replacements for a variant, as pairs of old and new text.
    """

    module: str
    name: str
    reason: str
    changes: Sequence[tuple[str, str]] = ()

    @property
    def code(self) -> str:
        """The code for the starter cell."""
        code = read_answer(Path(self.module).parent / 'solutions' / self.name)
        for old, new in self.changes:
            code = code.replace(old, new)
        return code

    @staticmethod
    def of(words: Words) -> Solution:
        """Return the solution with the name of a module, and the reason in its words."""
        folder, name = words.path.parent, words.path.stem
        found = sorted(each.name for each in (folder / 'solutions').glob(f'{name}.*'))
        return Solution(str(words.path), found[0] if found else f'{name}.py', words.reason)

    def changed(self, *changes: tuple[str, str]) -> Solution:
        """Return the solution with further replacements."""
        return replace(self, changes=(*self.changes, *changes))


_NO_SOLUTION = Solution('', '', '')


def read_answer(path: Path) -> str:
    """Return a file's code for a cell: without importing `lab`, which the setup cell does."""
    text = path.read_text(encoding='utf-8')
    if path.suffix == '.sh':
        return f'%%bash\n{text}'
    return _IMPORT_LAB.sub('', text, count=1).lstrip('\n')


@dataclass(eq=False, kw_only=True)
class Exercise:
    """An exercise of a lesson. `check()`, `hint()` and `solution()` are for the learner.

    Attributes:
        words: What it says. Name, task, hints and answer are theirs if they are not given.
        name: Its name as a Python name: `lesson.count_up`; that of the module.
        task: The task in a sentence or two.
        clauses: The requirements of the task, which the check judges one by one.
        stage: The source of the evidence, by default the graph.
        publishes: Topics on which the learner's nodes publish, by full name, with their types.
        subscribes: Topics to which they subscribe, with their types.
        serves: Services that they offer, with their types.
        nodes: Full names of nodes that the task asks for.
        shared: Topics on which others may publish too. On all others in `publishes` a second
            publisher fails the check at any time.
        reliable: Topics whose subscribers request reliable delivery, as the robot does: they
            receive nothing from a best effort publisher.
        hints: Hints from a nudge to nearly the answer.
        answer: The solution to show.
        given: Full names of nodes that the lesson itself leaves running for this exercise, with
            the ids of the cells that make them, separated by spaces; `'*'` for any cell, `''` for
            none, as for a node of another process.
        records: Topics in `publishes` to record from the setup cell on, for messages that are sent
            once, before the check. The judge finds them in `probe.recorded`.
        once: Whether a check uses up its evidence, as a node that is removed. The same nodes then
            get the same verdict again.
        starter_id: Id of the notebook cell to edit; `'count-up-starter'` if empty.
        check_id: Id of the cell with the check; `'count-up-check'` if empty.
    """

    words: Words | None = None
    name: str = ''
    task: str = ''
    hints: Sequence[str] = ()
    answer: Solution = _NO_SOLUTION
    clauses: Sequence[Clause[Any]] = ()
    stage: Stage[Any] = field(default_factory=Graph)
    publishes: Mapping[str, str] = field(default_factory=dict)
    subscribes: Mapping[str, str] = field(default_factory=dict)
    serves: Mapping[str, str] = field(default_factory=dict)
    nodes: Sequence[str] = ()
    shared: Sequence[str] = ()
    reliable: Sequence[str] = ()
    given: Mapping[str, str] = field(default_factory=dict)
    records: Sequence[str] = ()
    once: bool = False
    starter_id: str = ''
    check_id: str = ''

    def __post_init__(self) -> None:
        if self.words is not None:
            self.name = self.name or self.words.path.stem
            self.task = self.task or self.words.task
            self.hints = self.hints or self.words.hints
            if self.answer is _NO_SOLUTION:
                self.answer = Solution.of(self.words)
        self.lesson = ''
        self.belongs_to: Lesson | None = None
        # The other variants, and the learner's seed; '' for the notebook's exercise.
        self.variants: Variants | None = None
        self.seed = ''
        roles: dict[Role, str] = {}
        for clause in self.clauses:
            roles.update(clause.roles)

        def asked(kind: str, more: Mapping[str, str]) -> dict[str, str]:
            return {name: roles[what, name] for what, name in roles if what == kind} | {**more}

        self.publishes = asked(PUBLISHER, self.publishes)
        self.subscribes = asked(SUBSCRIPTION, self.subscribes)
        self.serves = asked(SERVICE, self.serves)
        self.nodes = tuple(asked(NODE, dict.fromkeys(self.nodes, '')))
        self.scope = Scope(
            publishes=self.publishes,
            subscribes=self.subscribes,
            serves=self.serves,
            nodes=self.nodes,
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
        """Start recording, for the setup cell."""
        history.follow(topic for clause in self.clauses for topic in clause.listens)
        if self._recorder is not None:
            from labkit.background.runtime import start

            start()
            self._recorder.keep()
            last_cell.after_each(self._recorder.keep)

    def forget(self) -> None:
        """Forget earlier attempts."""
        self._before = None
        if self._recorder is not None:
            self._recorder.forget()

    def keep(self, verdict: Verdict) -> None:
        """Repeat a verdict until there is something new."""
        with Probe(self.name, self.scope) as probe:
            self._before = (probe.fingerprint(), verdict)

    def check(self) -> Verdict | Pending:
        """Check whether your nodes do what the task asks for.

        Returns:
            The verdict, or a `Pending` one while an asyncio task of the notebook is running.
        """
        last_cell.asked(self.name)
        if learner_task_runs():
            return Pending(self.name, self._check, self._form)
        Pending.wait_for_all()
        return self._check()

    def refusal(self) -> str:
        """Return why a button can't have it checked now, `''` if it can."""
        return BUSY if last_cell.is_running else ''

    def check_again(self, form: VerdictForm) -> str:
        """Check for a form between two cells; return why that can't be, `''` if it can."""
        if self.refusal():
            return BUSY
        last_cell.checked(self.name)
        if learner_task_runs():
            Pending(self.name, self._check).show_in(form)
        else:
            Pending.wait_for_all()
            form.update(self._check())
        return ''

    def _form(self) -> VerdictForm | None:
        if settings.audience().live:
            with contextlib.suppress(ImportError):  # no anywidget: show the card alone
                from labkit.views.verdict_form import VerdictForm

                return VerdictForm(self)
        return None

    def _check(self) -> Verdict:
        from labkit.silent.watch import watch

        with watch.resting():
            verdict = self.examine()
        if self.variants is not None and self.seed:
            verdict = self.variants.recognise(self, verdict)
        note = progress_store.note_check(
            self.lesson,
            self.name,
            verdict.outcome.value,
            clause=verdict.clause,
            why=verdict.why,
            mistake=verdict.mistake.id if verdict.mistake is not None else '',
        )
        if verdict.passed and self.belongs_to is not None:
            verdict = replace(verdict, standing=self.belongs_to.standing(self))
        verdict = replace(verdict, form=self._form)
        return verdict if not note else verdict.with_note(note)

    def hint(self, number: int | None = None) -> Card:
        """Show the next hint, or the one with this number.

        Args:
            number: From 1; the next hint if None.
        """
        last_cell.asked()
        count = len(self.hints)
        if number is not None and not (isinstance(number, int) and 1 <= number <= count):
            raise LabError(f'There are hints 1 to {count}, but the number is {number!r}.')
        if number is None and self._hints_shown >= count:
            text = f'These were all {count} hints. lesson.{self.name}.solution() shows one way.'
            return Card('info', 'HINT', self.name, text=text)
        return self.told_hint(self._hints_shown + 1 if number is None else number)

    def told_hint(self, number: int) -> Card:
        """Return a hint by its number, from 1, and note that."""
        self._hints_shown = max(self._hints_shown, number)
        progress_store.note_hint(self.lesson, self.name, number)
        word = f'HINT {number} of {len(self.hints)}'
        return Card('info', word, self.name, text=self.hints[number - 1])

    @property
    def may_solve(self) -> bool:
        """Whether all hints have been seen, so that a button offers the solution."""
        return self._hints_shown >= len(self.hints)

    def solution(self) -> Card:
        """Show a solution with an explanation."""
        last_cell.asked()
        return self.told_solution()

    def told_solution(self) -> Card:
        """Return the solution, and note that."""
        progress_store.note_solution(self.lesson, self.name)
        text = f'{self.answer.reason}\nYours may look different: what counts is what it does.'
        code = self.answer.code.strip()
        return SolutionCard('info', 'SOLUTION', self.name, text=text, code=code)

    def __dir__(self) -> list[str]:
        # For tab completion: the rest is for authors of lessons.
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
        """Check without recording progress."""
        recorded = self._recorder.watches() if self._recorder is not None else {}
        began = time.monotonic()
        try:
            with Probe(self.name, self.scope, recorded=recorded) as probe:
                verdict = self._of_its_run(self._verdict(probe, recorded), probe)
                return self._with_note(verdict, probe, time.monotonic() - began)
        except LabError as error:  # e.g. ROS can't be started here
            return Verdict(
                Outcome.ERROR,
                self.name,
                'Nothing could be checked.',
                seen=str(error.message),
                todo=error.todo,
            )
        except Exception as error:  # a check never raises
            fault = machine_fault(error)
            return self._internal_error(error) if fault is None else self._machine_error(fault)

    def _of_its_run(self, verdict: Verdict, probe: Probe) -> Verdict:
        """Return what is to be said first where a cell has failed since, or was changed."""
        judged = judged_nodes(probe)
        failed = failed_last(self.starter_id, judged, passed=verdict.passed)
        if failed is not None:
            note = told_of_older(judged, failed, verdict)
            error = last_cell.learner_error(failed)
            assert error is not None
            return self._learner_error(error).with_note(note)
        changed = changed_since(judged)
        if changed is None:
            return verdict
        node, mistake = changed
        if verdict.passed:
            name = mistake.values['name']
            return verdict.with_note(f'Judged was {node}. The class {name} was changed since.')
        return replace(
            verdict,
            outcome=Outcome.FAIL,
            text='',
            expected=verdict.expected or self._asked(),
            seen=verdict.seen or verdict.text,
            why=mistake.reason,
            todo=mistake.step,
            trace='',
            mistake=mistake,
        )

    def _with_note(self, verdict: Verdict, probe: Probe, seconds: float) -> Verdict:
        notes = []
        if probe.held_lines:
            lines = f'{probe.held_lines} line{"s" * (probe.held_lines != 1)}'
            notes.append(
                f'The check let {probe.lived_sec:.0f} s of the time of your nodes pass. They '
                f'wrote {lines} meanwhile, not shown here.'
            )
        if probe.moved_clocks:
            notes.append(
                f'The ROS clock of {", ".join(sorted(probe.moved_clocks))}, in a process of its '
                f'own, was up to {probe.lived_sec:.0f} s ahead meanwhile, and is back now. What '
                'that program does by another clock, or by time.sleep(), was seen for as long as '
                f'the check took: {seconds:.0f} s.'
            )
        others = other_times(vars(sys.modules['__main__']))
        if others and probe.lived_sec:
            notes.append(
                f'A check cannot move the time of datetime, select or a loop of asyncio. What '
                f'{", ".join(others)} does by it was seen for as long as the check took: '
                f'{seconds:.0f} s.'
            )
        return verdict.with_note(' '.join(notes)) if notes else verdict

    def _verdict(self, probe: Probe, recorded: Mapping[str, Watch]) -> Verdict:
        new = any(map(len, recorded.values()))
        if self._before is not None and not new:
            nodes, earlier = self._before
            if nodes == probe.fingerprint():  # the same attempt
                # Without nodes there may be other evidence, such as a refused command.
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
                text = judge(probe, self.stage, self.clauses)
                _look_again(probe)
            except (Fail, NotAttempted) as outcome:
                if isinstance(outcome, Fail) and outcome.came_first:
                    raise
                if not (isinstance(outcome, Fail) and outcome.made_so):
                    # The cause explains more than its consequences.
                    _look_again(probe)
                    probe.callbacks.raise_old_error(probe.scope)
                refuse_nameless(probe, self._asked())
                unexplained = isinstance(outcome, NotAttempted) and not str(outcome)
                if unexplained and not probe.something_is_starting():
                    for each in self.clauses:
                        with naming(each):
                            each.explain_nothing(probe)
                    refuse_traces(probe, self, self._asked())
                raise
        except LearnerError as error:
            return self._learner_error(error)
        except NotAttempted as nothing:
            text = str(nothing) or (STARTING if probe.something_is_starting() else NOTHING_YET)
            # The notebook does not have the task of a variant.
            clause = self._asked() if self.seed else ''
            return Verdict(Outcome.NOT_ATTEMPTED, self.name, text, clause=clause)
        except Fail as fail:
            stray = _stray(probe)
            return Verdict(
                Outcome.FAIL,
                self.name,
                expected=fail.expected,
                seen=fail.seen,
                why=stray.reason if stray is not None else fail.why,
                todo=stray.step if stray is not None else fail.todo,
                clause=fail.clause,
                mistake=stray or fail.mistake,
                time_line=probe.life.time_line(fail.at) if probe.life is not None else None,
            )
        text = text or 'It does what the task asks for.'
        asked = tuple(clause.text for clause in self.clauses)
        time_line = probe.life.time_line(None) if probe.life is not None else None
        return Verdict(Outcome.PASS, self.name, text, asked=asked, time_line=time_line)

    def _asked(self) -> str:
        return '; '.join(clause.text for clause in self.clauses) or self.task

    def _learner_error(self, error: LearnerError) -> Verdict:
        mistake, kind = explain_error(error.error), type(error.error).__name__
        return Verdict(
            Outcome.ERROR,
            self.name,
            f'{error.where} raised {kind}.',
            why=mistake.reason if mistake is not None else '',
            todo=(mistake.step if mistake is not None else '')
            or f'Read the line with {kind} first: it says what is wrong; the line above, where.',
            mistake=mistake,
            trace=error.trace,
        )

    def _machine_error(self, fault: Mistake) -> Verdict:
        text = 'Nothing could be checked. That is no fault of yours.'
        return Verdict(
            Outcome.ERROR, self.name, text, why=fault.reason, todo=fault.step, mistake=fault
        )

    def _internal_error(self, error: Exception) -> Verdict:
        import traceback

        return Verdict(
            Outcome.ERROR,
            self.name,
            'The check itself has failed. That is a fault of the course, not yours.',
            todo='Run the check again. If it stays, please report it with the lines below.',
            trace=''.join(traceback.format_exception(error)[-4:]),
        )


def _stray(probe: Probe) -> Mistake | None:
    """Return what is wrong if a node publishes elsewhere, with the publisher of another one."""
    judged = probe.attempt() if probe.life is not None and probe.life.strays else ()
    for stray in probe.life.strays if probe.life is not None else ():
        if stray.node in judged and stray.topic not in probe.scope.publishes:
            return common_mistakes.WENT_ELSEWHERE.of(**vars(stray))
    return None


def _look_again(probe: Probe) -> None:
    """Raise Fail if a second publisher has appeared meanwhile."""
    for topic in sorted(probe.scope.sole):
        alone(probe, topic)
