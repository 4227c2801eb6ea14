"""Every exercise, in every state, through its own notebook in a real kernel."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import pytest
from cases import Answer, answers_of
from proof import Finding, can_run, lessons, prove, states_of

from labkit.exercises import Clause, Exercise, Lesson, Outcome

# Of each exercise the gate has the starter, the solution, and the first wrong answer.
SLOW = pytest.mark.slow('there are some two thousand answers')


def in_gate(exercise: Exercise) -> set[str]:
    return {'untouched', 'solution', wrong_answers(exercise)[0].name}


def wrong_answers(exercise: Exercise) -> list[Answer]:
    return [answer for answer in answers_of(exercise) if answer.outcome is not Outcome.PASS]


STATES = [
    pytest.param(
        lesson,
        state,
        id=f'{lesson.name}-{state.exercise}-{state.name}',
        marks=() if state.name in in_gate(exercise) else SLOW,
    )
    for lesson in lessons()
    for exercise in filter(can_run, lesson.exercises)
    for state in states_of(exercise)
]

# The first test of a lesson waits for its turn among the others, and for all of its states.
pytestmark = pytest.mark.timeout(2400)

Findings = dict[tuple[str, str], Finding]


@pytest.fixture(scope='session')
def findings_of(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Callable[[Lesson], Findings]]:
    """Give what came of a lesson. All that were asked for are begun at once, eight at a time."""
    wanted: dict[str, set[tuple[str, str]]] = {}
    found: dict[str, Future[Findings]] = {}
    for item in request.session.items:
        if 'findings_of' not in getattr(item, 'fixturenames', ()):
            continue  # of another file, which may call its parameters the same
        params = item.callspec.params if hasattr(item, 'callspec') else {}
        if isinstance(params.get('state'), Answer):
            state = params['state']
            wanted.setdefault(params['lesson'].name, set()).add((state.exercise, state.name))
        elif isinstance(params.get('clause'), Clause):
            exercise = params['exercise']
            states = {(exercise.name, answer.name) for answer in wrong_answers(exercise)}
            wanted.setdefault(params['lesson'].name, set()).update(states)
    # The kernels mostly wait for messages, so there may be more of them than cores.
    with ThreadPoolExecutor(max_workers=8) as pool:
        for lesson in sorted(lessons(), key=lambda lesson: -len(wanted.get(lesson.name, ()))):
            if lesson.name in wanted:
                folder = tmp_path_factory.mktemp(lesson.name)
                found[lesson.name] = pool.submit(prove, lesson, folder, wanted[lesson.name])
        yield lambda lesson: found[lesson.name].result()
        pool.shutdown(cancel_futures=True)


@pytest.mark.parametrize(('lesson', 'state'), STATES)
def test_verdict(
    lesson: Lesson,
    state: Answer,
    findings_of: Callable[[Lesson], Findings],
    record_property: Callable[[str, object], None],
) -> None:
    found = findings_of(lesson)[state.exercise, state.name]
    assert found.outcome is state.outcome, found.text
    assert ' '.join(state.says.split()) in found.text, found.text
    # What is right is no fault, however it is written.
    assert state.outcome is not Outcome.PASS or not found.told, found.told
    record_property('check_sec', found.seconds)


CLAUSES = [
    pytest.param(lesson, exercise, clause, id=f'{lesson.name}-{exercise.name}-{number}')
    for lesson in lessons()
    for exercise in filter(can_run, lesson.exercises)
    for number, clause in enumerate(exercise.clauses, start=1)
]


@SLOW
@pytest.mark.parametrize(('lesson', 'exercise', 'clause'), CLAUSES)
def test_each_clause_of_a_task_refuses_some_wrong_answer(
    lesson: Lesson,
    exercise: Exercise,
    clause: Clause[Any],
    findings_of: Callable[[Lesson], Findings],
) -> None:
    found = findings_of(lesson)
    texts = [found[exercise.name, answer.name].text for answer in wrong_answers(exercise)]
    # Lines of a verdict are broken where there is no space, too.
    asked = _without_spaces(f'Task: {clause.text}')
    assert any(asked in _without_spaces(text) for text in texts), clause.text


def _without_spaces(text: str) -> str:
    return ''.join(text.split())
