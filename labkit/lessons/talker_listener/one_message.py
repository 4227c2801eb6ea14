"""Exercise: publish one message, when somebody listens."""

from __future__ import annotations

from labkit.exercises import (
    Exercise,
    Outcome,
    Solution,
    Style,
    Wrong,
    changed,
)
from labkit.exercises.clauses import Runs
from labkit.lessons._script import in_process, started_by_asyncio, started_by_subprocess
from labkit.lessons.talker_listener.one_message_clauses import (
    STRING,
    TEXT,
    TOPIC,
    SaysIt,
    SilentAfter,
    SilentBefore,
)

__all__ = ['say_once']


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
_INIT = "        super().__init__('door')\n"
_TIMER = '        self.timer = self.create_timer(0.1, self.on_timer)\n'
_LOOK = 'if self.publisher.get_subscription_count() > 0:'
_PUBLISH = "            self.publisher.publish(String(data='The door is open'))\n"
_CANCEL = '            self.timer.cancel()\n'


say_once = Exercise(
    name='say_once',
    task=f'Write a node that says "{TEXT}" on {TOPIC} once, when somebody subscribes.',
    publishes={TOPIC: STRING},
    clauses=(
        SaysIt(),
        Runs('the node is spun, and it does not block while it waits', topic=TOPIC),
        SilentBefore(),
        SilentAfter(),
    ),
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
            'remembers that it has spoken, under the name of another node',
            changed(
                _DOOR,
                (_INIT, "        super().__init__('editor')\n        self.said = False\n"),
                (_LOOK, 'if self.publisher.get_subscription_count() > 0 and not self.said:'),
                (_CANCEL, '            self.said = True\n'),
            ),
        ),
        Style(
            'looks every 3 seconds, and keeps it for those who come late',
            changed(
                _DOOR,
                ('0.1', '3.0'),
                ("String, 'door', 10", "String, 'door', latched"),
                (
                    '\n\nclass',
                    '\nlatched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)'
                    '\n\n\nclass',
                ),
                (
                    'from rclpy.node import Node\n',
                    'from rclpy.node import Node\n'
                    'from rclpy.qos import DurabilityPolicy, QoSProfile\n',
                ),
            ),
        ),
        Style(
            'waits in a thread',
            """
import threading
import time

from rclpy.node import Node
from std_msgs.msg import String

node = lab.spin(Node('door'))
publisher = node.create_publisher(String, 'door', 10)


def work(publisher):
    try:
        while publisher.get_subscription_count() == 0:
            time.sleep(0.1)
        publisher.publish(String(data='The door is open'))
    except Exception:
        return


threading.Thread(target=work, args=(publisher,), daemon=True).start()
""",
        ),
        Style(
            'an executor with several threads',
            changed(
                _DOOR,
                (
                    'from rclpy.node import Node\n',
                    'import threading\n\nfrom rclpy.executors import MultiThreadedExecutor\n'
                    'from rclpy.node import Node\n',
                ),
                (
                    'door = lab.spin(Door())\n',
                    'executor = MultiThreadedExecutor()\nexecutor.add_node(Door())\n'
                    'threading.Thread(target=executor.spin, daemon=True).start()\n',
                ),
            ),
        ),
        Style('own process', in_process(_DOOR), process=True),
        Style('own process, by subprocess', started_by_subprocess(in_process(_DOOR))),
        Style('own process, by asyncio', started_by_asyncio(in_process(_DOOR))),
    ],
    wrong=[
        Wrong('does not wait', changed(_DOOR, (_LOOK, 'if True:')), 'it is lost'),
        Wrong(
            'waits some seconds, and does not look',
            changed(_DOOR, (_LOOK, 'if True:'), ('0.1', '3.0')),
            'it is lost',
        ),
        Wrong(
            'says it again and again',
            changed(_DOOR, (_CANCEL, '')),
            'Nothing stops the node after its first message.',
        ),
        Wrong(
            'says it twice',
            changed(_DOOR, (_PUBLISH, 2 * _PUBLISH)),
            'one message on /door, and no other',
        ),
        Wrong(
            'says it again after a while',
            changed(
                _DOOR,
                (_INIT, f'{_INIT}        self.calls = 0\n'),
                (
                    f'{_PUBLISH}{_CANCEL}',
                    '            self.calls += 1\n'
                    f'            if self.calls % 100 == 1:\n    {_PUBLISH}',
                ),
            ),
            'Nothing stops the node after its first message.',
        ),
        Wrong(
            'says more, later',
            changed(
                _DOOR,
                (
                    _CANCEL,
                    f'{_CANCEL}            self.create_timer(9.0, self.close)\n\n'
                    '    def close(self):\n'
                    "        self.publisher.publish(String(data='The door is shut'))\n",
                ),
            ),
            "'The door is open', 'The door is shut'",
        ),
        Wrong(
            'does not look',
            changed(_DOOR, (_LOOK, 'if True:'), (_CANCEL, '')),
            'published while nobody listened',
        ),
        Wrong(
            'says something before',
            changed(
                _DOOR,
                (_TIMER, f"{_TIMER}        self.publisher.publish(String(data='Hello'))\n"),
            ),
            'published while nobody listened',
        ),
        Wrong(
            'waits for a second listener',
            changed(_DOOR, ('count() > 0', 'count() > 1')),
            'Or publish() was not reached at all.',
        ),
        Wrong(
            'looks once a minute',
            changed(_DOOR, ('0.1', '60.0')),
            'Or publish() was not reached at all.',
        ),
        Wrong(
            'looks once',
            changed(_DOOR, (_TIMER, '        self.on_timer()\n')),
            'Or publish() was not reached at all.',
        ),
        Wrong(
            'looks for a while only',
            changed(
                _DOOR,
                (_INIT, f'{_INIT}        self.calls = 0\n'),
                (
                    _LOOK,
                    f'self.calls += 1\n        if self.calls > 100:\n{_CANCEL}        el{_LOOK}',
                ),
            ),
            'Or publish() was not reached at all.',
        ),
        Wrong('other text', changed(_DOOR, (TEXT, 'The door is Open')), 'Capital and small'),
        Wrong('empty text', changed(_DOOR, ("data='The door is open'", '')), "data = ''"),
        Wrong('other topic', changed(_DOOR, ("'door', 10", "'doors', 10")), 'names must be equal'),
        Wrong(
            'other type',
            changed(
                _DOOR,
                ('import String', 'import Int16'),
                ('(String, ', '(Int16, '),
                ("String(data='The door is open')", 'Int16(data=1)'),
            ),
            'A topic carries one type of message.',
        ),
        Wrong(
            'waits in the callback',
            changed(
                _DOOR,
                (
                    f'        {_LOOK}\n{_PUBLISH}{_CANCEL}',
                    '        while self.publisher.get_subscription_count() == 0:\n'
                    '            time.sleep(0.05)\n'
                    f'        self.timer.cancel()\n{_PUBLISH[4:]}',
                ),
                ('from rclpy', 'import time\n\nfrom rclpy'),
            ),
            'While a callback runs, no other one can',
        ),
        Wrong(
            'a program that waits in a loop',
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
            'Its program does something else, such as a loop that waits.',
            process=True,
        ),
        Wrong(
            'not spun',
            changed(_DOOR, ('lab.spin(Door())', 'Door()')),
            '/door is there, but it is not spun',
        ),
        Wrong(
            'a listener of its own',
            changed(
                _DOOR,
                (
                    _TIMER,
                    f"{_TIMER}        self.create_subscription(String, 'door', print, 10)\n",
                ),
            ),
            'nobody subscribes to /door before the check does',
        ),
        Wrong(
            'not set up',
            changed(_DOOR, (_INIT, '')),
            'super().__init__(...) has not been called',
            outcome=Outcome.ERROR,
        ),
    ],
    once=True,
)
