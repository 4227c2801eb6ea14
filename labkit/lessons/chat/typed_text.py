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
from labkit.exercises.figures import figure, many
from labkit.exercises.mistakes import recognise
from labkit.exercises.verdict import LearnerError
from labkit.exercises.what_is_asked import PUBLISHER, Role

__all__ = ['exercise']

WORDS = words_of(__file__)

TOPIC, STRING, WHO = '/hall', 'std_msgs/msg/String', 'Ada'
# How long a line may take to arrive, s of real time, as the task says; then the nodes live for a
# while, since a timer may say more, s of their own time.
ARRIVES_SEC, AFTER_SEC = 3.0, 5.0
# So many lines are typed however long each of them takes; the others as long as there is time.
FEWEST = 5
NOTHING = Words(WORDS.clause('nothing'))

NO_FUNCTION = WORDS.mistake('typed-text/no-function')
NOT_ASKED = WORDS.mistake('typed-text/not-asked')
ASKS_AGAIN = WORDS.mistake('typed-text/asks-again')
ELSEWHERE = WORDS.mistake('typed-text/elsewhere')
SILENT = WORDS.mistake('typed-text/silent')
TWICE = WORDS.mistake('typed-text/twice')
EMPTY_TOO = WORDS.mistake('typed-text/empty-too')
OTHER_NAME = WORDS.mistake('typed-text/another-name')
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

    def find(self, evidence: Evidence) -> None:
        """Type a line if there is no node yet: the first question may make it."""
        if not callable(_function()) or evidence.probe.publishers(TOPIC):
            return
        self._begin(evidence)
        try:
            self._type(evidence, draw_texts()[0])
        except (Fail, LearnerError):
            if evidence.probe.publishers(TOPIC):
                raise
            # What is missing then is the node.
            evidence.asked[TOPIC].clear()

    def judge(self, evidence: Evidence) -> str:
        """Type lines, one for each call, as long as they are answered."""
        if not callable(_function()):
            raise Fail('a function ask() of this notebook', 'none', NO_FUNCTION)
        if TOPIC not in evidence.heard:
            self._begin(evidence)
        lines = _lines()
        typed = 0
        for typed, line in enumerate(lines, start=1):
            if evidence.probe.time_left < ARRIVES_SEC and typed > FEWEST:
                typed -= 1
                break
            if not self._type(evidence, line):
                break
        # A timer may say more, later.
        evidence.life = evidence.live({TOPIC: STRING}, AFTER_SEC, [self])
        evidence.refuse_trouble(())
        evidence.heard[TOPIC].pump()
        if typed == len(lines):
            return f'{many(typed, "line")} typed.'
        return f'{typed} of {many(len(lines), "line")} were typed: there was no time for more.'

    def _begin(self, evidence: Evidence) -> None:
        evidence.heard[TOPIC] = evidence.probe.watch(TOPIC, STRING)
        evidence.asked[TOPIC] = []

    def _type(self, evidence: Evidence, line: str) -> bool:
        """Type a line, and tell whether it is answered in time."""
        asked, watch = evidence.asked[TOPIC], evidence.heard[TOPIC]
        _call(line)
        asked.append({'data': line})
        due = sum(_say(fields['data']) is not None for fields in asked)
        evidence.probe.allow(ARRIVES_SEC)
        evidence.probe.wait(lambda: len(watch) >= due, ARRIVES_SEC)
        if len(watch) < due:
            asked[-1]['late'] = True
        return len(watch) >= due


class _Says(GraphClause):
    """What was typed is published."""

    text = WORDS.of(arrives=figure(ARRIVES_SEC)).clause('says')

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
        wanted = f'data = {expect.show([right])} on {TOPIC} for the line {expect.show([line])}'
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
            name, colon, text = came[0].partition(': ')
            if colon and text == line.strip() and name != WHO:
                mistake = OTHER_NAME.of(name=name)
        fail = Fail(wanted, seen, mistake)
        if mistake is not None and mistake.id == EMPTY_TOO.id:
            fail.clause = NOTHING.text
        return fail


def _lines() -> list[str]:
    """Return what is typed: what bites stands first, if there is no time for all."""
    first, *others = draw_texts()
    padded = next(line for line in others if line.strip() not in ('', line))
    others.remove(padded)
    return [first, '', padded, *others]


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
