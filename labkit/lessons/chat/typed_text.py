"""Exercise: ask for a line with `input()`, and publish it with the name of who says it."""

from __future__ import annotations

import builtins
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from labkit import stop_button
from labkit.exercises import Exercise, Fail, Mistake, Solution, anything, expect
from labkit.exercises.clauses import Evidence, GraphClause, Words
from labkit.exercises.draws import draw_texts
from labkit.exercises.expect.values import text_trouble
from labkit.exercises.mistakes import recognise
from labkit.exercises.verdict import LearnerError
from labkit.exercises.what_is_asked import PUBLISHER, Role

__all__ = ['exercise']

TOPIC, STRING, WHO = '/hall', 'std_msgs/msg/String', 'Ada'
# How long a line may take to arrive, s of real time, as the task says; then the nodes live for a
# while, since a timer may say more, s of their own time.
ARRIVES_SEC, AFTER_SEC = 3.0, 5.0
NOTHING = Words('for a line that is empty, or all spaces, publish nothing')

_ASK = "In ask(): text = input('Your message: '), and then publish."
NO_FUNCTION = Mistake('typed-text/no-function', 'There is no function called ask.', 'def ask():')
NOT_ASKED = Mistake(
    'typed-text/not-asked',
    'The function ask() came to its end without a question.',
    _ASK,
    change=[("input('Your message: ')", "'Hello'")],
)
ASKS_AGAIN = Mistake(
    'typed-text/asks-again',
    'The function asks again before it ends: does it ask in a loop?',
    'Ask once in ask(). Who wants to say more calls it again.',
    change=[
        (
            "    text = input('Your message: ').strip()\n    if text:\n        teller.say(text)",
            "    while text := input('Your message: ').strip():\n        teller.say(text)",
        )
    ],
)
ELSEWHERE = Mistake(
    'typed-text/elsewhere',
    'The check types into this notebook, and sees what its nodes publish.',
    'End the program, and start the node here with lab.spin().',
)
SILENT = Mistake(
    'typed-text/silent',
    f'The line was typed, and nothing was published for it within {ARRIVES_SEC:g} s.',
    _ASK,
    change=[('        teller.say(text)', '        print(text)')],
)
TWICE = Mistake(
    'typed-text/twice', 'A line is published more than once.', 'Publish each line once.'
)
EMPTY_TOO = Mistake(
    'typed-text/empty-too',
    'Nothing should be published for the line {line!r}.',
    'Look whether anything is left of it after strip().',
    change=[('    if text:\n', '    if text is not None:\n')],
)
MISTAKES = (
    Mistake(
        'typed-text/without-a-name',
        'It does not say who says it.',
        'Put the name, a colon and a space before the text.',
        model=lambda line: line.strip() or None,
        change=[("f'Ada: {text}'", 'text')],
    ),
    Mistake(
        'typed-text/with-the-blanks',
        'There are spaces at an end of what was typed.',
        "Use input('...').strip().",
        model=lambda line: f'{WHO}: {line}',
        change=[(').strip()', ')'), ('if text:', 'if text.strip():')],
    ),
    Mistake(
        'typed-text/another-text',
        'What is said is not what was typed.',
        'Use what input() returns.',
        model=anything,
        change=[('teller.say(text)', "teller.say('Hello')")],
    ),
)


class _AskedAgain(BaseException):
    """The learner's function asks for more than the one line."""


class _Typed(GraphClause):
    """A function asks for a line, and its node says it."""

    text = (
        'a function `ask()` of this notebook asks for a line with `input()`, once each time it '
        'is called'
    )
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

    text = (
        f'the line is published on `{TOPIC}` (`{STRING}`), without spaces at its ends, as '
        f'`{WHO}: <text>`, once, within {ARRIVES_SEC:g} s'
    )

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
    name='typed_text',
    task=f'A function ask() asks for a line with input(), and a node publishes it on {TOPIC}.',
    clauses=(_Typed(), _Says(), NOTHING),
    hints=[
        'The node needs a publisher, and no timer. Who calls publish()?',
        'strip() returns a text without the spaces at its two ends. What is left of spaces alone?',
        "In ask(): text = input('Your message: ').strip(), then if text: and publish "
        "String(data=f'Ada: {text}') with the publisher of the node.",
    ],
    answer=Solution(
        __file__,
        'typed_text.py',
        'A node may publish at any time, not in a callback alone: here, when somebody has typed. '
        'A text that is empty counts as False, so `if text` leaves out what holds nothing.',
    ),
)
