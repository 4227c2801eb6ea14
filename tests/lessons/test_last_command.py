"""What a refused command is told: from the reason and the topic, whatever the complaint says."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from labkit.exercises import Fail
from labkit.lessons.command_line.last_command import (
    commanded_rate,
    explain_last_command,
    forget_commands,
)
from labkit.ros2.shell import Ran, history, run_line
from labkit.rosgraph.refusals import Refusal

PUB = ('topic', 'pub')


@pytest.fixture(autouse=True)
def forgotten() -> Iterator[None]:
    forget_commands()
    yield
    forget_commands()


def fail() -> Fail:
    with pytest.raises(Fail) as caught:
        explain_last_command('/odds', 'the numbers 1, 3 and 5')
    return caught.value


@pytest.mark.parametrize(
    ('reason', 'why'),
    [
        (Refusal.SPACE_AFTER_COLON, 'a colon is followed by a space'),
        (Refusal.QUOTES_MISSING, 'hold its words together'),
        (Refusal.LIST_FOR_NUMBER, 'a message of its own'),
        (Refusal.OTHER_TYPE, 'A topic carries one type of message.'),
    ],
)
def test_misconception_is_told_by_the_reason(reason: Refusal, why: str) -> None:
    history.append(Ran(PUB, 'What is wrong.\nWhat to do.', reason, '/odds'))
    assert why in fail().why
    assert (fail().seen, fail().todo) == (
        'a command that was refused: What is wrong.',
        'What to do.',
    )


def test_complaint_without_an_explanation_is_passed_on() -> None:
    history.append(Ran(PUB, 'What is wrong.', Refusal.OTHER, '/odds'))
    assert (fail().seen, fail().why) == ('a command that was refused: What is wrong.', '')


@pytest.mark.parametrize(
    ('topic', 'why'),
    [('/Odds', 'Capital and small letters'), ('/odd', 'equal to the last letter')],
)
@pytest.mark.parametrize('reason', [None, Refusal.OTHER])
def test_command_that_went_elsewhere_is_told_so(
    topic: str, why: str, reason: Refusal | None
) -> None:
    history.append(Ran(PUB, '', reason, topic))
    assert why in fail().why
    assert fail().seen == f'a command that publishes on {topic}'


def test_last_command_counts_and_others_do_not() -> None:
    history.append(Ran(PUB, 'First.', Refusal.OTHER, '/odds'))
    history.append(Ran(PUB, 'Second.', Refusal.OTHER, '/odds'))
    history.append(Ran(PUB, 'Of a cell before.', Refusal.OTHER, '/limit'))
    history.append(Ran(('topic', 'echo'), 'Another verb.', Refusal.OTHER, '/odds'))
    assert fail().seen.endswith('Second.')


def test_command_that_was_right_is_no_fault() -> None:
    history.append(Ran(PUB, '', None, '/odds'))
    explain_last_command('/odds', '')


def test_what_a_learner_types_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    run_line('topic pub --once /odds std_msgs/msg/Int16 {data: 1}')
    assert 'Quotation marks around the YAML' in fail().why
    forget_commands()
    run_line('topic pub --once //odds std_msgs/msg/Int16 "{data: 1}"')
    assert 'One slash at the beginning' in fail().why


@pytest.mark.parametrize(
    ('option', 'rate_hz'),
    [('', 1.0), ('-r 5', 5.0), ('-r2.5', 2.5), ('--rate 4', 4.0), ('--rate=0.5', 0.5)],
)
def test_rate_is_that_of_the_last_command_that_was_accepted(option: str, rate_hz: float) -> None:
    history.append(Ran((*PUB, '/odds', '-r', '9'), '', None, '/odds'))
    history.append(Ran((*PUB, *option.split(), '/odds'), '', None, '/odds'))
    history.append(Ran((*PUB, '/odds', '-r', '7'), 'What is wrong.', Refusal.OTHER, '/odds'))
    history.append(Ran((*PUB, '/other', '-r', '8'), '', None, '/other'))
    assert commanded_rate('/odds') == rate_hz
    assert commanded_rate('/limit') is None
