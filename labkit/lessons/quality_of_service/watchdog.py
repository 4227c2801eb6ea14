"""Exercise: notice that something does not come any more."""

from __future__ import annotations

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.lessons._script import in_process, started_by_subprocess
from labkit.lessons.quality_of_service.heart import ALARM, CLAUSES, EMPTY, HEART, STRING, judge

__all__ = ['watchdog']

_WATCHDOG = """
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Empty, String


class Watchdog(Node):
    def __init__(self):
        super().__init__('watchdog')
        self.publisher = self.create_publisher(String, 'alarm', 10)
        self.subscription = self.create_subscription(
            Empty,
            'heartbeat',
            self.on_beat,
            QoSProfile(depth=10, deadline=Duration(seconds=0.5)),
            event_callbacks=SubscriptionEventCallbacks(deadline=self.on_missed),
        )

    def on_beat(self, msg):
        pass

    def on_missed(self, event):
        self.publisher.publish(String(data='no heartbeat'))


watchdog = lab.spin(Watchdog())
"""
_TIMER = """
from rclpy.node import Node
from std_msgs.msg import Empty, String


class Watchdog(Node):
    def __init__(self):
        super().__init__('watchdog')
        self.publisher = self.create_publisher(String, 'alarm', 10)
        self.subscription = self.create_subscription(Empty, 'heartbeat', self.on_beat, 10)
        self.timer = self.create_timer(0.5, self.on_timer)

    def on_beat(self, msg):
        self.timer.reset()

    def on_timer(self):
        self.publisher.publish(String(data='no heartbeat'))


watchdog = lab.spin(Watchdog())
"""
_EVENTS = '            event_callbacks=SubscriptionEventCallbacks(deadline=self.on_missed),\n'
_HANDLER = 'from rclpy.event_handler import SubscriptionEventCallbacks\n'
_PUBLISH = "        self.publisher.publish(String(data='no heartbeat'))\n"

watchdog = Exercise(
    name='watchdog',
    task='Listen to /heartbeat, and publish a text on /alarm when it is silent.',
    subscribes={HEART: EMPTY},
    publishes={ALARM: STRING},
    clauses=CLAUSES,
    judge=judge,
    hints=[
        'A deadline says how much time may pass between two messages. Who tells the node that '
        'more has passed?',
        'create_subscription() takes event_callbacks. The callback of the deadline gets an event, '
        'and may publish.',
        'QoSProfile(depth=10, deadline=Duration(seconds=0.5)), and '
        'event_callbacks=SubscriptionEventCallbacks(deadline=self.on_missed).',
    ],
    answer=Solution(
        _WATCHDOG,
        'The middleware watches the time, and calls on_missed once for each half second without '
        'a message. So the node needs neither a timer nor a clock.',
    ),
    styles=[
        Style('a timer that each beat sets back', _TIMER),
        Style(
            'a clock that a timer looks at',
            changed(
                _TIMER,
                ('        self.timer.reset()\n', '        self.last = self.get_clock().now()\n'),
                (
                    '        self.timer = self.create_timer(0.5, self.on_timer)\n',
                    '        self.last = self.get_clock().now()\n'
                    '        self.timer = self.create_timer(0.1, self.on_timer)\n',
                ),
                (
                    _PUBLISH,
                    '        silence = self.get_clock().now() - self.last\n'
                    '        if silence.nanoseconds > 0.5e9:\n    ' + _PUBLISH,
                ),
            ),
        ),
        Style(
            'functions',
            """
import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile
from std_msgs.msg import Empty, String

node = rclpy.create_node('doctor')
publisher = node.create_publisher(String, '/alarm', 1)
node.create_subscription(
    Empty,
    '/heartbeat',
    lambda msg: None,
    QoSProfile(depth=1, deadline=Duration(seconds=0.5)),
    event_callbacks=SubscriptionEventCallbacks(
        deadline=lambda event: publisher.publish(String(data=f'missed {event.total_count}'))
    ),
)
lab.spin(node)
""",
        ),
        Style(
            'best effort, and a longer deadline',
            changed(
                _WATCHDOG,
                ('import QoSProfile\n', 'import QoSProfile, ReliabilityPolicy\n'),
                (
                    '            QoSProfile(depth=10, deadline=Duration(seconds=0.5)),\n',
                    '            QoSProfile(\n                depth=1,\n'
                    '                reliability=ReliabilityPolicy.BEST_EFFORT,\n'
                    '                deadline=Duration(seconds=0.8),\n            ),\n',
                ),
            ),
        ),
        Style('own process, started here', started_by_subprocess(in_process(_WATCHDOG))),
        Style('own process', in_process(_WATCHDOG), process=True),
    ],
    wrong=[
        Wrong(
            'no event callback',
            changed(_WATCHDOG, (_EVENTS, ''), (_HANDLER, '')),
            'Nobody is told that heartbeats are missing',
        ),
        Wrong(
            'no deadline',
            changed(
                _WATCHDOG,
                ('QoSProfile(depth=10, deadline=Duration(seconds=0.5))', '10'),
                ('from rclpy.duration import Duration\n', ''),
                ('from rclpy.qos import QoSProfile\n', ''),
            ),
            'nothing within 4 s',
        ),
        Wrong(
            'an alarm at each heartbeat',
            changed(_WATCHDOG, ('        pass\n', _PUBLISH)),
            'nothing on /alarm while a heartbeat comes',
        ),
        Wrong(
            'a timer that nobody sets back',
            changed(_TIMER, ('        self.timer.reset()\n', '        pass\n')),
            'The alarm does not depend on whether heartbeats come',
        ),
        Wrong(
            'a deadline that is too short',
            changed(_WATCHDOG, ('seconds=0.5', 'seconds=0.25')),
            'The time is too short',
        ),
        Wrong(
            'a deadline that is shorter than what is offered',
            changed(_WATCHDOG, ('seconds=0.5', 'seconds=0.05')),
            'Ask for less in the profile of the subscription.',
        ),
        Wrong(
            'five seconds',
            changed(_WATCHDOG, ('seconds=0.5', 'seconds=5')),
            'a message on /alarm within 2 s after the last heartbeat',
        ),
        Wrong(
            'asks for transient local',
            changed(
                _WATCHDOG,
                ('import QoSProfile\n', 'import DurabilityPolicy, QoSProfile\n'),
                (
                    '            QoSProfile(depth=10, deadline=Duration(seconds=0.5)),\n',
                    '            QoSProfile(\n                depth=10,\n'
                    '                deadline=Duration(seconds=0.5),\n'
                    '                durability=DurabilityPolicy.TRANSIENT_LOCAL,\n'
                    '            ),\n',
                ),
            ),
            'volatile publisher and transient local subscription',
        ),
        Wrong(
            'logs in place of publishing',
            changed(_WATCHDOG, (_PUBLISH, "        self.get_logger().error('no heartbeat')\n")),
            'what is told does not publish',
        ),
        Wrong(
            'one alarm only',
            changed(
                _WATCHDOG,
                (
                    "        super().__init__('watchdog')\n",
                    "        super().__init__('watchdog')\n        self.told = False\n",
                ),
                (
                    _PUBLISH,
                    '        if not self.told:\n            self.told = True\n    ' + _PUBLISH,
                ),
            ),
            'Something is used up by the first alarm',
        ),
        Wrong(
            'other topic',
            changed(_WATCHDOG, ("'heartbeat',", "'heart_beat',")),
            'names differ in an underscore',
        ),
        Wrong(
            'no publisher',
            changed(
                _WATCHDOG,
                ("        self.publisher = self.create_publisher(String, 'alarm', 10)\n", ''),
                (_PUBLISH, "        self.get_logger().error('no heartbeat')\n"),
                ('import Empty, String', 'import Empty'),
            ),
            'create_publisher() for this topic has not been called',
        ),
        Wrong(
            'callback without an argument',
            changed(_WATCHDOG, ('def on_missed(self, event):', 'def on_missed(self):')),
            'argument',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'not spun',
            changed(_WATCHDOG, ('lab.spin(Watchdog())', 'Watchdog()')),
            'lab.spin(node)',
        ),
        Wrong(
            'no event callback, in a process of its own',
            changed(in_process(_WATCHDOG), (_EVENTS, ''), (_HANDLER, '')),
            'Nobody is told that heartbeats are missing',
            process=True,
        ),
    ],
)
