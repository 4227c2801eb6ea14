"""Exercise: a publisher on /chatter, every 2 seconds."""

from __future__ import annotations

from labkit.exercises import (
    Exercise,
    Outcome,
    Probe,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
)
from labkit.lessons._script import in_process, two_copies

__all__ = ['every_two_seconds']

STRING = 'std_msgs/msg/String'

_SLOW = """
from rclpy.node import Node
from std_msgs.msg import String


class SlowTalker(Node):
    def __init__(self):
        super().__init__('slow_talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(2.0, self.on_timer)

    def on_timer(self):
        msg = String()
        msg.data = 'Hello from the slow talker'
        self.publisher.publish(msg)


slow_talker = lab.spin(SlowTalker())
"""


def _judge_every_two_seconds(probe: Probe) -> str:
    # A publisher that is made in the callback is there only after the first tick.
    if set(probe.node_names()) - {endpoint.node for endpoint in probe.all_publishers()}:
        probe.wait(lambda: probe.publishers('/chatter'), 2.2)
    source = expect.publisher(probe, '/chatter')
    watch = expect.messages(probe, source, count=2, hz=0.5, tolerance=0.2)
    expect.each(
        watch,
        'data',
        bool,
        expected='a text in every message',
        why='The message was published as it was made: its field data is an empty text.',
        todo='Set the field before you publish: msg.data = ...',
    )
    return f'{source.node} said {expect.show(watch.values("data"))}, with 2 s in between.'


every_two_seconds = Exercise(
    name='every_two_seconds',
    task='Write a node that publishes a `String` on /chatter every 2 seconds.',
    publishes={'/chatter': STRING},
    judge=_judge_every_two_seconds,
    hints=[
        'The class Talker is nearly what you need. Which number in it is the period?',
        'In __init__: the name of the node, create_publisher(...) and create_timer(2.0, ...). '
        'In the callback: make a message, set msg.data, publish it.',
        'self.timer = self.create_timer(2.0, self.on_timer), without brackets after on_timer; '
        'then lab.spin(SlowTalker()).',
    ],
    answer=Solution(
        _SLOW,
        'The publisher is made once, in __init__, and kept in self. The timer calls on_timer '
        'every 2.0 s, and each call makes a new message.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String

node = rclpy.create_node('metronome')
publisher = node.create_publisher(String, '/chatter', 1)


def tick():
    publisher.publish(String(data='tick'))


timer = node.create_timer(2, tick)
lab.spin(node)
""",
        ),
        Style('own process', in_process(_SLOW), process=True),
    ],
    wrong=[
        Wrong(
            'capital letter',
            changed(_SLOW, ("'chatter'", "'Chatter'")),
            'Capital and small letters differ in names',
        ),
        Wrong(
            'misspelt',
            changed(_SLOW, ("'chatter'", "'chater'")),
            'names must be equal to the last letter',
        ),
        Wrong(
            'in the namespace of the node',
            changed(_SLOW, ("'chatter'", "'~/chatter'")),
            'it lies in another namespace',
        ),
        Wrong(
            'wrong type',
            changed(_SLOW, ('String', 'Int16'), ("'Hello from the slow talker'", '7')),
            'A topic carries one type of message.',
        ),
        Wrong(
            'forgot to publish',
            changed(_SLOW, ('        self.publisher.publish(msg)\n', '')),
            'publish() is not called there',
        ),
        Wrong(
            'publishes once',
            changed(
                _SLOW, ('self.timer = self.create_timer(2.0, self.on_timer)', 'self.on_timer()')
            ),
            'publish() ran once at most',
        ),
        Wrong(
            'callback called',
            changed(_SLOW, ('self.on_timer)', 'self.on_timer())')),
            'Pass the name alone, without brackets',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'not spun',
            changed(_SLOW, ('lab.spin(SlowTalker())', 'SlowTalker()')),
            'nothing runs its callbacks',
        ),
        Wrong('off by ten', changed(_SLOW, ('2.0', '0.2')), 'times too fast'),
        Wrong(
            'rate for period',
            changed(_SLOW, ('2.0', '0.5')),
            'A rate in Hz and a period in seconds were mixed up',
        ),
        Wrong(
            'publisher made in the callback',
            changed(
                _SLOW,
                ("        self.publisher = self.create_publisher(String, 'chatter', 10)\n", ''),
                ('self.publisher.pub', "self.create_publisher(String, 'chatter', 10).pub"),
            ),
            'makes a publisher again and again',
        ),
        Wrong(
            'message never filled',
            changed(_SLOW, ("        msg.data = 'Hello from the slow talker'\n", '')),
            'its field data is an empty text',
        ),
        Wrong(
            'publishes a text',
            changed(_SLOW, ('publish(msg)', 'publish(msg.data)')),
            'publish() takes a message of the type',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'two copies running',
            two_copies(_SLOW),
            'Two copies of the node run at once',
            process=True,
        ),
    ],
)
