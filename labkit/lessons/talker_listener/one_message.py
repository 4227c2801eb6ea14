"""Exercise: publish one message, when somebody listens."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, Probe, Solution, Style, Wrong, changed, expect

__all__ = ['say_once']

STRING = 'std_msgs/msg/String'

_DOOR = """
from rclpy.node import Node
from std_msgs.msg import String


class Door(Node):
    def __init__(self):
        super().__init__('door')
        self.publisher = self.create_publisher(String, 'door', 10)
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        if self.publisher.get_subscription_count() > 0:
            self.publisher.publish(String(data='The door is open'))
            self.timer.cancel()


door = lab.spin(Door())
"""
_LOOK = 'if self.publisher.get_subscription_count() > 0:'
_TEXT = 'The door is open'


def _judge_say_once(probe: Probe) -> str:
    source = expect.publisher(probe, '/door')
    # Who does not look whether somebody is there has spoken by then.
    probe.wait(lambda: False, 0.5)
    watch = probe.watch('/door', STRING)
    expected = 'one message on /door, as soon as the check subscribes'
    again = 'Run the cell of your node again before each check: it speaks once only.'
    if not probe.wait(lambda: len(watch), 2.5):
        raise Fail(
            expected,
            f'{source.node} has a publisher, but no message came within 2.5 s',
            why='If it was published before somebody listened, it is lost: nobody keeps it for '
            'those who come later. Or publish() was not reached at all.',
            todo=f'Publish only when get_subscription_count() is not 0. {again}',
        )
    if watch.samples[0].number > 1:
        raise Fail(
            expected,
            f'the first message that came was number {watch.samples[0].number} of its publisher',
            why='The earlier ones were published while nobody listened.',
            todo=f'Look at get_subscription_count() before you publish. {again}',
        )
    if probe.wait(lambda: len(watch) > 1, 1.2):
        raise Fail(
            expected,
            f'{len(watch)} messages: {expect.show(watch.values("data"))}',
            why='Nothing stops the node after its first message.',
            todo='self.timer.cancel() ends the timer.',
        )
    expect.equal(watch, 'data', _TEXT, todo=again)
    return f'{source.node} waited, and said {_TEXT!r} once.'


say_once = Exercise(
    name='say_once',
    task=f'Write a node that says "{_TEXT}" on /door once, when somebody subscribes.',
    publishes={'/door': STRING},
    judge=_judge_say_once,
    hints=[
        'The node must look again and again whether somebody is there. What calls a callback '
        'again and again?',
        'In the callback of a timer: if self.publisher.get_subscription_count() > 0, publish.',
        'After publishing, self.timer.cancel() ends the timer. So nothing is said twice.',
    ],
    answer=Solution(
        _DOOR,
        'The timer looks ten times a second, and the processor rests in between. A loop without '
        'a pause would keep it busy, and no other callback could run.',
    ),
    styles=[
        Style(
            'told by ROS when somebody comes',
            """
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from std_msgs.msg import String


class Door(Node):
    def __init__(self):
        super().__init__('front_door')
        self.said = False
        self.publisher = self.create_publisher(
            String,
            '/door',
            1,
            event_callbacks=PublisherEventCallbacks(matched=self.on_matched),
        )

    def on_matched(self, info):
        if info.current_count > 0 and not self.said:
            self.publisher.publish(String(data='The door is open'))
            self.said = True


lab.spin(Door())
""",
        ),
        Style(
            'own process, a loop',
            """
import time

import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('door')
publisher = node.create_publisher(String, 'door', 10)
while publisher.get_subscription_count() == 0:
    time.sleep(0.05)
publisher.publish(String(data='The door is open'))
rclpy.spin(node)
""",
            process=True,
        ),
    ],
    wrong=[
        Wrong('does not wait', changed(_DOOR, (_LOOK, 'if True:')), 'it is lost'),
        Wrong(
            'says it again and again',
            changed(_DOOR, ('            self.timer.cancel()\n', '')),
            'Nothing stops the node after its first message.',
        ),
        Wrong(
            'does not look',
            changed(_DOOR, (_LOOK, 'if True:'), ('            self.timer.cancel()\n', '')),
            'published while nobody listened',
        ),
        Wrong(
            'looks once',
            changed(
                _DOOR, ('self.timer = self.create_timer(0.1, self.on_timer)', 'self.on_timer()')
            ),
            'Or publish() was not reached at all.',
        ),
        Wrong('other text', changed(_DOOR, (_TEXT, 'The door is Open')), 'Capital and small'),
        Wrong('other topic', changed(_DOOR, ("'door', 10", "'doors', 10")), 'names must be equal'),
    ],
    once=True,
)
