"""Programs that are wrong in the usual ways, as functions: what they say to the drawn tests.

A program gets the tests with the times at which they are sent, and returns what it says. `table`
has those that an exercise has to find out.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, cast

from labkit.exercises.clauses import Answers, Logs
from labkit.exercises.draws import KNOWN
from labkit.exercises.found_lessons import all_lessons

Timed = list[tuple[float, Any]]
Rule = Callable[[Any], Any]
Program = Callable[[Timed, Callable[[], Rule]], Timed]

# Answers of these take time of their own, or belong to a service.
OTHERWISE = ('asker', 'porter')

CLAUSES: dict[str, Answers | Logs] = {
    exercise.name: clause
    for lesson in all_lessons()
    for exercise in lesson.exercises
    for clause in exercise.clauses
    if isinstance(clause, (Answers, Logs)) and exercise.name not in OTHERWISE
}
# The learner makes its type; here stands one for it that is there.
CLAUSES['leg'] = replace(
    cast(Answers, CLAUSES['leg']), msg_type='geometry_msgs/msg/Vector3', field='x'
)


def rule_of(clause: Answers | Logs) -> Rule:
    """Return what a right program says for a value; one with a memory begins anew."""
    if isinstance(clause, Logs):
        return clause.line or str
    if not inspect.isgeneratorfunction(clause.answer):
        return clause.answer
    node = clause.answer(None)
    next(node)
    return node.send


def each(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
    rule = fresh()
    return [(at, rule(value)) for at, value in heard]


def by_a_timer(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
    return [(at + 0.1 - at % 0.1, said) for at, said in each(heard, fresh)]


def those(keep: Callable[[int, Timed], bool]) -> Program:
    """Return a program that leaves messages out: `keep` gets which one it is, and all of them."""
    return lambda heard, fresh: each([p for i, p in enumerate(heard) if keep(i, heard)], fresh)


def leaves_out(number: int) -> Program:
    """Return a program that leaves out every `number`-th answer."""

    def program(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
        said = [pair for pair in each(heard, fresh) if pair[1] is not None]
        return [pair for i, pair in enumerate(said, start=1) if i % number]

    return program


def changed(change: Callable[[Any], Any]) -> Program:
    """Return a program that does not take a message as it is."""
    return lambda heard, fresh: each([(at, change(value)) for at, value in heard], fresh)


def limited(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
    kept: Timed = []
    for at, value in heard:
        if not kept or at - kept[-1][0] >= 0.3:
            kept.append((at, value))
    return each(kept, fresh)


def newest(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
    """Answer the newest only, every 0.4 s."""
    ticks = [0.4 * i + 0.123 for i in range(200)]
    kept = [
        (end, [value for at, value in heard if begin < at <= end][-1])
        for begin, end in pairwise(ticks)
        if any(begin < at <= end for at, _ in heard)
    ]
    return each(kept, fresh)


def forgetful(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
    """Begin anew after ten messages."""
    return [pair for i in range(0, len(heard), 10) for pair in each(heard[i : i + 10], fresh)]


def twice(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
    return [pair for pair in each(heard, fresh) for _ in range(2)]


WRONG: dict[str, Program] = {
    'not the same again': those(lambda i, heard: not i or heard[i][1] != heard[i - 1][1]),
    'not what came before': those(lambda i, heard: heard[i][1] not in [v for _, v in heard[:i]]),
    'not the same within 10 ms': those(
        lambda i, heard: (
            not i or heard[i][1] != heard[i - 1][1] or heard[i][0] > heard[i - 1][0] + 0.01
        )
    ),
    'the rate is limited': limited,
    'the newest every 0.4 s': newest,
    'the first one only': those(lambda i, heard: i < 1),
    'the first ten only': those(lambda i, heard: i < 10),
    'the first twenty only': those(lambda i, heard: i < 20),
    'the first thirty only': those(lambda i, heard: i < 30),
    'not the first': those(lambda i, heard: i > 0),
    'every other': leaves_out(2),
    'all but every fifth': leaves_out(5),
    'nothing for nothing': those(lambda i, heard: bool(heard[i][1])),
    'twice': twice,
}
TEXTS: dict[str, Program] = {
    'one blank between two words': changed(lambda text: ' '.join(text.split())),
    'no blanks at the ends': changed(str.strip),
    'small letters': changed(str.lower),
    'the first 20 letters': changed(lambda text: text[:20]),
    'letters of English': changed(lambda text: text.encode('ascii', 'ignore').decode()),
    'the first 1000 letters': changed(lambda text: text[:1000]),
    'one blank for a tab': changed(lambda text: text.replace('\t', ' ')),
    'nothing for a namesake': those(lambda i, heard: not heard[i][1].startswith(KNOWN[0])),
    'nothing for what a lesson says': those(lambda i, heard: 'World' not in heard[i][1]),
    'the last part': changed(lambda text: text.rpartition(': ')[2]),
}
NUMBERS: dict[str, Program] = {
    'not the least': those(lambda i, heard: heard[i][1] != min(v for _, v in heard)),
    'not the largest': those(lambda i, heard: heard[i][1] != max(v for _, v in heard)),
    'no sign': changed(lambda n: -n if -9999 < n < 0 else n),
    'small numbers': changed(lambda n: max(-9999, min(9999, n))),
    'off by one at the lower edge': changed(lambda n: n + 1 if n < -32760 or n == 0 else n),
}
FLOATS: dict[str, Program] = {
    'never more than 0.3': changed(lambda n: max(-0.3, min(0.3, n))),
    'two decimals': changed(lambda n: round(n, 2)),
}
# What makes no difference in a task: it is none of the wrong ones there.
SAME = {
    'evens': {'nothing for nothing'},
    'two_stages': {'it forgets after ten'},
    'mouth': {'small letters'},
    'greeter': {
        'nothing for nothing',
        'one blank between two words',
        'no blanks at the ends',
        'letters of English',
        'the first 1000 letters',
        'one blank for a tab',
    },
    'polite': {
        'nothing for nothing',
        'no blanks at the ends',
        'the first 1000 letters',
        'one blank for a tab',
        'not the same again',
        'not what came before',
        'not the same within 10 ms',
    },
    'distance': {'nothing for nothing'},
}
MEMORY: dict[str, Program] = {'it forgets after ten': forgetful}


def table(name: str, clause: Answers | Logs) -> dict[str, Program]:
    first = drawn(clause)[0]
    found = dict(WRONG)
    if isinstance(first, str):
        found.update(TEXTS)
    if isinstance(first, float):
        found.update(FLOATS)
    if isinstance(first, int):
        found.update(NUMBERS)
    if isinstance(clause, Answers) and inspect.isgeneratorfunction(clause.answer):
        found.update(MEMORY)
    return {what: program for what, program in found.items() if what not in SAME.get(name, ())}


def drawn(clause: Answers | Logs) -> Sequence[Any]:
    return clause.draw() if isinstance(clause, Logs) else clause._drawn()
