"""Exercise: ask for a line with `input()`, and publish it with the name of who says it."""

from __future__ import annotations

import builtins
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from labkit import stop_button
from labkit.exercises import Exercise, Fail, Mistake, anything, expect, words_of
from labkit.exercises.clauses import Evidence, GraphClause, Words
from labkit.exercises.draws import draw_texts
from labkit.exercises.expect.values import text_trouble
from labkit.exercises.mistakes import recognise
from labkit.exercises.verdict import LearnerError
from labkit.exercises.what_is_asked import PUBLISHER, Role

__all__ = ['exercise']

WORDS = words_of(__file__)

TOPIC, STRING, WHO = '/hall', 'std_msgs/msg/String', 'Ada'
# How long a line may take to arrive, s of real time, as the task says; then the nodes live for a
# while, since a timer may say more, s of their own time.
ARRIVES_SEC, AFTER_SEC = 3.0, 5.0
NOTHING = Words(WORDS.clause('nothing'))

NO_FUNCTION = WORDS.mistake('typed-text/no-function')
NOT_ASKED = WORDS.mistake('typed-text/not-asked')
ASKS_AGAIN = WORDS.mistake('typed-text/asks-again')
ELSEWHERE = WORDS.mistake('typed-text/elsewhere')
SILENT = WORDS.mistake('typed-text/silent')
TWICE = WORDS.mistake('typed-text/twice')
EMPTY_TOO = WORDS.mistake('typed-text/empty-too')
MISTAKES = (
    WORDS.mistake('typed-text/without-a-name', lambda line: line.strip() or None),
    WORDS.mistake('typed-text/with-the-blanks', lambda line: f'{WHO}: {line}'),
    WORDS.mistake('typed-text/another-text', anything),
)


class _AskedAgain(BaseException):
    """The learner's function asks for more than the one line."""


class _Typed(GraphClause):
    """A function asks for a line, and its node says it."""

    text = WORDS.clause('typed')
    own_life = True

    def judge(self, evidence: Evidence) -> str:
        """Type lines, one for each call, as long as they are answered."""
        if not callable(_function()):
            raise Fail('a function ask() of this notebook', 'none', NO_FUNCTION)
        probe, due = evidence.probe, 0
        watch = evidence.heard[TOPIC] = probe.watch(TOPIC, STRING)
        evidence.asked[TOPIC] = []
        first, *others = draw_texts()
        for line in (first, '', *others):
            _call(line)
            evidence.asked[TOPIC].append({'data': line})
            due += _say(line) is not None
            probe.wait(lambda: len(watch) >= due, ARRIVES_SEC)  # noqa: B023
            if len(watch) < due:
                evidence.asked[TOPIC][-1]['late'] = True
                break
        # A timer may say more, later.
        evidence.life = evidence.live({TOPIC: STRING}, AFTER_SEC, [self])
        evidence.refuse_trouble(())
        watch.pump()
        return f'{len(evidence.asked[TOPIC])} lines were typed.'


class _Says(GraphClause):
    """What was typed is published."""

    text = WORDS.clause('says')

    @property
    def roles(self) -> dict[Role, str]:
        """A node publishes."""
        return {(PUBLISHER, TOPIC): STRING}

    def find(self, evidence: Evidence) -> None:
        """Look for the publisher."""
        source = evidence.publisher(TOPIC)
        if not evidence.probe.in_this_process(source):
            raise Fail(
                f'a node of this notebook that publishes on {TOPIC}',
                f'{source.node} {evidence.probe.place(source)}',
                ELSEWHERE,
            )

    def judge(self, evidence: Evidence) -> str:
        """Compare what came with what was typed, one after the other."""
        came = evidence.heard[TOPIC].values('data')
        before = ''
        empty: str | None = None
        for fields in evidence.asked[TOPIC]:
            line = fields['data']
            right = _say(line)
            if right is None:
                empty = line
                continue
            if came[:1] == [right] and 'late' in fields:
                raise self._wrong(line, right, (), before, empty)
            if came[:1] != [right]:
                raise self._wrong(line, right, came, before, empty)
            del came[0]
            before, empty = right, None
        if came:
            raise self._wrong('', '', came, before, empty)
        first = evidence.asked[TOPIC][0]['data']
        return f'{first!r} became {_say(first)!r}.'

    def _wrong(
        self, line: str, right: str, came: Sequence[str], before: str, empty: str | None
    ) -> Fail:
        """Return what is wrong with what came first, where something else was due, or nothing."""
        seen = f'data = {expect.show(came[:3])}' if came else f'nothing on {TOPIC}'
        wanted = f'data = {expect.show([right])} on {TOPIC} for the line {line!r}'
        if not right:
            wanted = f'one message on {TOPIC} for each line, and no other'
        mistake: Mistake | None = SILENT
        if came and came[0] == before:
            mistake = TWICE
        elif came and empty is not None and came[0].strip() in ('', f'{WHO}:'):
            mistake = EMPTY_TOO.of(line=empty)
        elif came:
            found = recognise(MISTAKES, lambda each: each.answer(line) == came[0])
            assert found is not None  # the last one of them fits anything
            trouble = text_trouble(came[0], right)
            mistake = found if trouble is None or found is not MISTAKES[-1] else trouble
        fail = Fail(wanted, seen, mistake)
        if mistake is not None and mistake.id == EMPTY_TOO.id:
            fail.clause = NOTHING.text
        return fail


def _say(line: str) -> str | None:
    return f'{WHO}: {line.strip()}' if line.strip() else None


def _function() -> Callable[[], Any] | None:
    return vars(sys.modules['__main__']).get('ask')


def _call(line: str) -> None:
    """Call the function, and type a line for it."""
    from labkit.background.tracebacks import short_traceback

    with _typing(line) as asked, stop_button.heard_at_once():
        try:
            function = _function()
            assert function is not None
            function()
        except _AskedAgain:
            raise Fail('one input() in each call of ask()', 'another one', ASKS_AGAIN) from None
        except Exception as error:
            raise LearnerError('ask()', error, short_traceback(error)) from None
    if not asked:
        raise Fail('one input() in each call of ask()', 'none', NOT_ASKED)


@contextmanager
def _typing(line: str) -> Iterator[list[object]]:
    """Let `input()` return a line, once. Gives what it was asked."""
    asked: list[object] = []
    real = builtins.input

    def answer(prompt: object = '', /) -> str:
        asked.append(prompt)
        if len(asked) > 1:
            raise _AskedAgain
        return line

    builtins.input = answer
    try:
        yield asked
    finally:
        builtins.input = real


exercise = Exercise(
    words=WORDS,
    clauses=(_Typed(), _Says(), NOTHING),
)
