"""Exercise: two nodes in a row, of which the second completes what the first begins."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from labkit.exercises import (
    Exercise,
    Fail,
    Outcome,
    Probe,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
)
from labkit.lessons._stage import find_stage

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['OPENING', 'STRING', 'two_stages']

STRING = 'std_msgs/msg/String'
OPENING = 'My name is '
TESTS = ('Her name is ', 'They call me ')
# At 2 Hz a text is on its way within this time, on a busy machine too.
FIRST_TEXT_SEC = 1.2

_CHAIN = """
from rclpy.node import Node
from std_msgs.msg import String


class Opener(Node):
    def __init__(self):
        super().__init__('opener')
        self.publisher = self.create_publisher(String, 'incomplete', 10)
        self.timer = self.create_timer(0.5, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='My name is '))


class Completer(Node):
    def __init__(self):
        super().__init__('completer')
        self.publisher = self.create_publisher(String, 'complete', 10)
        self.subscription = self.create_subscription(String, 'incomplete', self.on_text, 10)

    def on_text(self, msg):
        self.publisher.publish(String(data=msg.data + 'Ada'))


completer = lab.spin(Completer())
opener = lab.spin(Opener())
"""
_START = 'completer = lab.spin(Completer())\nopener = lab.spin(Opener())'
_SUM = "msg.data + 'Ada'"


def _judge_two_stages(probe: Probe) -> str:
    one = expect.publisher(probe, '/incomplete')
    try:
        texts = expect.messages(probe, one, count=2, hz=2.0)
    except Fail:
        expect.hanging(probe)  # the second stage may keep the first one from its work
        raise
    expect.equal(texts, 'data', OPENING, todo=f'Publish {OPENING!r}, with a space at the end.')
    hears, says = find_stage(probe, '/incomplete', '/complete', {'data': TESTS[0]})
    expect.that(
        hears.node != one.node,
        expected='two nodes, one for each stage',
        seen=f'{one.node} publishes on /incomplete and subscribes to it',
        why='One node does the work of both stages, so neither can be replaced without the other.',
        todo='Write a class for each stage.',
    )
    name = _name(probe, hears, says)
    expect.replies(
        probe,
        hears,
        [{'data': text} for text in TESTS],
        says,
        lambda sent: sent['data'] + name,
        explain=_explain,
    )
    return f'{one.node} -> /incomplete -> {hears.node} -> /complete: {OPENING + name!r}'


def _name(probe: Probe, hears: Endpoint, says: Endpoint) -> str:
    """Return the first name that the second stage appends."""
    watch = probe.watch(says.topic, STRING)
    if not probe.wait(lambda: len(watch), FIRST_TEXT_SEC):
        expect.hanging(probe)
        raise Fail(
            'a text on /complete for each one on /incomplete',
            'nothing on /complete',
            why=f'The message reached {hears.node}, but its callback did not publish.',
            todo='Publish on /complete in the callback of the subscription to /incomplete.',
        )
    text = watch.values('data')[0]
    name: str = text.removeprefix(OPENING)
    why, todo = _what_is_wrong(text, name)
    if why:
        raise Fail(f'{OPENING!r} and your first name', f'data = {text!r}', why=why, todo=todo)
    return name


def _what_is_wrong(text: str, name: str) -> tuple[str, str]:
    put = 'String(data=msg.data + ...), with your name for the dots.'
    if not name.strip():
        return 'The text is passed on as it came: no name is added.', put
    if text.startswith(OPENING):
        if OPENING in name:
            return (
                'The texts of earlier messages are still in it: the string grows.',
                'Make a new string from msg.data each time.',
            )
        if name != name.strip():
            return 'There is a space too many beside the name.', put
        return '', ''
    if text.startswith(OPENING.rstrip()):
        return 'The space between the text and the name is missing.', put
    if OPENING.strip() in text:
        return 'The name stands before the text.', put
    return 'The text that came in is not part of what goes out.', put


def _explain(sent: Mapping[str, Any], came: list[Any]) -> tuple[str, str]:
    if came and not any(text.startswith(sent['data']) for text in came):
        return (
            'The string is always the same: it is not made of the message that came.',
            'Use msg.data in the callback.',
        )
    return '', ''


two_stages = Exercise(
    name='two_stages',
    task=f'Node one publishes {OPENING!r} on /incomplete, twice a second. Node two appends your '
    'first name and publishes the whole on /complete.',
    publishes={'/incomplete': STRING, '/complete': STRING},
    subscribes={'/incomplete': STRING},
    judge=_judge_two_stages,
    hints=[
        'Thermometer and Converter are such a chain. Which lines have to change?',
        'Stage one: a timer of 0.5 s and a publisher. Stage two: a subscription and a publisher, '
        'and no timer.',
        "In the callback of stage two: self.publisher.publish(String(data=msg.data + 'Ada')).",
    ],
    answer=Solution(
        _CHAIN,
        'Each stage has one task and knows two topics at most. Stage two makes its text from the '
        'message that came, so it goes on working when stage one says something else.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String

one, two = rclpy.create_node('first'), rclpy.create_node('second')
begin = one.create_publisher(String, '/incomplete', 1)
end = two.create_publisher(String, '/complete', 1)
one.create_timer(1 / 2, lambda: begin.publish(String(data='My name is ')))
two.create_subscription(
    String, '/incomplete', lambda text: end.publish(String(data=f'{text.data}Jean-Luc')), 1
)
lab.spin(one)
lab.spin(two)
""",
        ),
        Style(
            'stage one is a loop with a rate, in a thread',
            changed(
                _CHAIN,
                ('        self.timer = self.create_timer(0.5, self.on_timer)\n', ''),
                (
                    'opener = lab.spin(Opener())',
                    """
import threading

opener = lab.spin(Opener())


def work():
    rate = opener.create_rate(2)
    for _ in range(120):
        opener.on_timer()
        rate.sleep()


threading.Thread(target=work, daemon=True).start()
""",
                ),
            ),
        ),
        Style(
            'both in a process of its own',
            changed(
                _CHAIN,
                (
                    'from rclpy.node',
                    'import rclpy\nfrom rclpy.executors import SingleThreadedExecutor\n'
                    'from rclpy.node',
                ),
                (
                    _START,
                    """rclpy.init()
executor = SingleThreadedExecutor()
for stage in (Completer(), Opener()):
    executor.add_node(stage)
executor.spin()
""",
                ),
            ),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'space missing',
            changed(_CHAIN, ("'My name is '", "'My name is'")),
            'A space is missing at the end of the text.',
        ),
        Wrong('no name', changed(_CHAIN, (_SUM, 'msg.data')), 'no name is added'),
        Wrong(
            'string built once',
            changed(_CHAIN, (_SUM, "'My name is Ada'")),
            'it is not made of the message that came',
        ),
        Wrong(
            'string grows',
            changed(
                _CHAIN,
                (
                    "super().__init__('completer')\n",
                    "super().__init__('completer')\n        self.text = ''\n",
                ),
                (
                    f'self.publisher.publish(String(data={_SUM}))',
                    'self.text += msg.data\n'
                    "        self.publisher.publish(String(data=self.text + 'Ada'))",
                ),
            ),
            'The texts of earlier messages are still in it',
        ),
        Wrong(
            'name in front',
            changed(_CHAIN, (_SUM, "'Ada' + msg.data")),
            'The name stands before the text.',
        ),
        Wrong(
            'publishes where it listens',
            changed(_CHAIN, ("String, 'complete', 10", "String, 'incomplete', 10")),
            'The node hears what it says itself',
        ),
        Wrong(
            'blocks in the callback',
            changed(
                _CHAIN,
                ('def on_text(self, msg):\n', 'def on_text(self, msg):\n        sleep(3)\n'),
                ('from rclpy', 'from time import sleep\n\nfrom rclpy'),
            ),
            'While a callback runs, no other one can',
        ),
        Wrong(
            'publisher made in the callback',
            changed(
                _CHAIN,
                ("        self.publisher = self.create_publisher(String, 'complete', 10)\n", ''),
                (
                    f'self.publisher.publish(String(data={_SUM}',
                    f"self.create_publisher(String, 'complete', 10).publish(String(data={_SUM}",
                ),
            ),
            'makes a publisher again and again',
        ),
        Wrong(
            'one node for both',
            """
from rclpy.node import Node
from std_msgs.msg import String


class Both(Node):
    def __init__(self):
        super().__init__('both')
        self.begin = self.create_publisher(String, 'incomplete', 10)
        self.end = self.create_publisher(String, 'complete', 10)
        self.create_subscription(String, 'incomplete', self.on_text, 10)
        self.create_timer(0.5, lambda: self.begin.publish(String(data='My name is ')))

    def on_text(self, msg):
        self.end.publish(String(data=msg.data + 'Ada'))


lab.spin(Both())
""",
            'One node does the work of both stages',
        ),
        Wrong(
            'second stage missing',
            changed(_CHAIN, ('completer = lab.spin(Completer())\n', '')),
            'create_subscription() for this topic has not been called',
        ),
        Wrong(
            'callback called',
            changed(_CHAIN, ('self.on_timer)', 'self.on_timer())')),
            'Pass the name alone',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'off by ten',
            changed(_CHAIN, ('create_timer(0.5,', 'create_timer(0.05,')),
            'times too fast',
        ),
    ],
)
