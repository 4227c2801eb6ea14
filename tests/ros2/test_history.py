"""What is kept of the commands that were run: why one was refused, and which topic it named."""

from __future__ import annotations

import pytest
from rclpy.node import Node
from std_msgs.msg import Int16
from std_srvs.srv import SetBool

import labkit
from labkit.ros2.shell import history, run_line
from labkit.rosgraph.refusals import Refusal

PUB = 'topic pub --once /odds std_msgs/msg/Int16'
TWIST = 'topic pub --once /odds geometry_msgs/msg/Twist'


@pytest.fixture(autouse=True)
def empty_history():
    history.clear()


@pytest.mark.parametrize(
    ('line', 'reason'),
    [
        (f'{PUB} "{{data: 1}}', Refusal.QUOTE_NOT_CLOSED),
        (f'{PUB} "{{data: 1}}" | cat', Refusal.TERMINAL_SIGN),
        ('topik pub /odds', Refusal.UNKNOWN_COMMAND),
        ('fly x', Refusal.UNKNOWN_COMMAND),
        ('topic pbu /odds', Refusal.UNKNOWN_VERB),
        (f'{PUB} --onec "{{data: 1}}"', Refusal.UNKNOWN_OPTION),
        ('topic --onec list', Refusal.UNKNOWN_OPTION),
        (f'{PUB} {{data: 1}}', Refusal.QUOTES_MISSING),
        (f'{PUB} data: 1', Refusal.QUOTES_MISSING),
        (f'{PUB} "{{data: 1}}" more', Refusal.TOO_MANY_WORDS),
        ('topic pub /odds', Refusal.BAD_ARGUMENT),
        (f'{PUB} --rate fast', Refusal.BAD_ARGUMENT),
        ('topic pub --once //odds std_msgs/msg/Int16 "{data: 1}"', Refusal.REPEATED_SLASH),
        ('topic pub --once /odds//a std_msgs/msg/Int16 "{data: 1}"', Refusal.REPEATED_SLASH),
        ('topic pub --once /1odds std_msgs/msg/Int16 "{data: 1}"', Refusal.BAD_NAME),
        ('topic echo --once //odds', Refusal.REPEATED_SLASH),
        ('service call /a//b std_srvs/srv/Empty', Refusal.REPEATED_SLASH),
        ('topic pub --once /odds std_msgs/msg/Int61 "{data: 1}"', Refusal.UNKNOWN_TYPE),
        ('topic pub --once /odds Int16 "{data: 1}"', Refusal.UNKNOWN_TYPE),
        ('interface show std_msgs/msg/Int61', Refusal.UNKNOWN_TYPE),
        (f'{PUB} "{{data: "', Refusal.NOT_YAML),
        (f'{PUB} "data:1"', Refusal.SPACE_AFTER_COLON),
        (f'{PUB} "{{data:1}}"', Refusal.SPACE_AFTER_COLON),
        (f'{PUB} "5"', Refusal.NO_FIELDS),
        (f'{PUB} ""', Refusal.NO_FIELDS),
        ('service call /switch std_srvs/srv/SetBool 5', Refusal.NO_FIELDS),
        ('service call /switch std_srvs/srv/SetBool data:1', Refusal.SPACE_AFTER_COLON),
        (f'{PUB} "{{dta: 1}}"', Refusal.NO_SUCH_FIELD),
        (f'{TWIST} "{{x: 1}}"', Refusal.NO_SUCH_FIELD),
        (f'{TWIST} "{{linear: {{w: 1}}}}"', Refusal.NO_SUCH_FIELD),
        (f'{TWIST} "{{linear: 0.5}}"', Refusal.FIELDS_WANTED),
        (f'{TWIST} "{{linear: [1, 2, 3]}}"', Refusal.FIELDS_WANTED),
        (f'{PUB} "{{data: [1, 3, 5]}}"', Refusal.LIST_FOR_NUMBER),
        (f'{TWIST} "{{linear: {{x: [0.5]}}}}"', Refusal.LIST_FOR_NUMBER),
        (f'{PUB} "{{data: 1.5}}"', Refusal.NOT_A_WHOLE_NUMBER),
        (f'{PUB} "{{data: one}}"', Refusal.NOT_A_WHOLE_NUMBER),
        (f'{PUB} "{{data: 40000}}"', Refusal.OUT_OF_RANGE),
        ('topic pub --once /odds std_msgs/msg/Float32 "{data: 1e39}"', Refusal.OUT_OF_RANGE),
        (f'{TWIST} "{{linear: {{x: fast}}}}"', Refusal.NOT_A_NUMBER),
        ('topic pub --once /odds std_msgs/msg/Bool "{data: 1}"', Refusal.NOT_TRUE_OR_FALSE),
        ('topic pub --once /odds std_msgs/msg/String "{data: [a]}"', Refusal.NOT_A_TEXT),
        (
            'topic pub --once /odds std_msgs/msg/Int16MultiArray "{data: 1}"',
            Refusal.LIST_WANTED,
        ),
        ('topic info /odds', Refusal.OTHER),
    ],
)
def test_a_refusal_has_its_reason(capsys, line, reason):
    assert run_line(line) in (1, 2)
    assert (history[-1].reason, bool(history[-1].complaint)) == (reason, True)
    assert history[-1].complaint == capsys.readouterr().err.rstrip('\n')


@pytest.mark.parametrize(
    'verb', ['pub --once /odds std_msgs/msg/String', 'echo --once /odds std_msgs/msg/String']
)
def test_another_type_on_the_topic_is_a_reason(capsys, verb):
    labkit.spin(Node('listener')).create_subscription(Int16, '/odds', print, 10)
    assert run_line(f'topic {verb}') == 1
    assert history[-1].reason is Refusal.OTHER_TYPE, capsys.readouterr().err


@pytest.mark.parametrize('line', ['topic list', 'topic echo -h', 'interface show std_msgs/Empty'])
def test_what_was_not_refused_has_no_reason(capsys, line):
    code = run_line(line)
    assert (history[-1].reason is None) == (code == 0)
    # Help is shown once, although the words are looked at twice.
    assert capsys.readouterr().out.count('usage:') <= 1


@pytest.mark.parametrize(
    ('line', 'topic'),
    [
        ('topic info /odds', '/odds'),
        ('topic info odds', '/odds'),
        ('topic --include-hidden-topics info /odds', '/odds'),
        (f'{PUB} "{{data: one}}"', '/odds'),
        (f'{PUB} {{data: 1}}', '/odds'),
        (f'{PUB} "{{data: 1}}', '/odds'),
        ('topic pub --rate fast /odds std_msgs/msg/Int16 "{data: 1}"', '/odds'),
        ('topic pub --rate=fast /odds std_msgs/msg/Int16 "{data: 1}"', '/odds'),
        ('topic pub --rat 0 /odds std_msgs/msg/Int16 "{data: 1}"', '/odds'),
        ('topic pub -1 -r 0 /odds std_msgs/msg/Int16 "{data: 1}"', '/odds'),
        ('topic pub /odds', '/odds'),
        ('topic pub //odds std_msgs/msg/Int16', '//odds'),
        ('topic pub', ''),
        ('topic', ''),
        ('topik pub /odds', ''),
        ('node info /odds', ''),
        ('', ''),
    ],
)
def test_the_topic_that_was_named_is_known(capsys, line, topic):
    run_line(line)
    assert history[-1].topic == topic


def test_another_type_of_a_service_is_a_reason(capsys):
    labkit.spin(Node('lamp')).create_service(SetBool, '/switch', print)
    assert run_line('service call /switch std_srvs/srv/Empty') == 1
    assert history[-1].reason is Refusal.OTHER_TYPE
