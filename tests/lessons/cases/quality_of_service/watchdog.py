"""Answers to `watchdog`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'no event callback',
        'No alarm came in time',
        ('            event_callbacks=SubscriptionEventCallbacks(deadline=self.on_missed),\n', ''),
        ('from rclpy.event_handler import SubscriptionEventCallbacks\n', ''),
    ),
    wrong(
        'no deadline',
        'nothing within 2 s',
        ('QoSProfile(depth=10, deadline=Duration(seconds=0.5))', '10'),
        ('from rclpy.duration import Duration\n', ''),
        ('from rclpy.qos import QoSProfile\n', ''),
    ),
    wrong(
        'a timer that nobody sets back',
        'There was an alarm while heartbeats came',
        ('        self.timer.reset()\n', '        pass\n'),
        of='a timer that each beat sets back',
    ),
    wrong(
        'a deadline that is shorter than what is offered',
        'Ask for less in the profile of the subscription.',
        ('seconds=0.5', 'seconds=0.05'),
    ),
    wrong(
        'five seconds',
        'a message on /alarm within 2 s after the last heartbeat',
        ('seconds=0.5', 'seconds=5'),
    ),
    wrong(
        'asks for transient local',
        'volatile publisher and transient local subscription',
        ('import QoSProfile\n', 'import DurabilityPolicy, QoSProfile\n'),
        (
            '            QoSProfile(depth=10, deadline=Duration(seconds=0.5)),\n',
            '            QoSProfile(\n                depth=10,\n'
            '                deadline=Duration(seconds=0.5),\n'
            '                durability=DurabilityPolicy.TRANSIENT_LOCAL,\n'
            '            ),\n',
        ),
    ),
    wrong(
        'logs in place of publishing',
        'what is told does not publish',
        (
            "        self.publisher.publish(String(data='no heartbeat'))\n",
            "        self.get_logger().error('no heartbeat')\n",
        ),
    ),
    wrong(
        'one alarm only',
        'There was an alarm before, and none this time',
        (
            "        super().__init__('watchdog')\n",
            "        super().__init__('watchdog')\n        self.told = False\n",
        ),
        (
            "        self.publisher.publish(String(data='no heartbeat'))\n",
            '        if not self.told:\n            self.told = True\n'
            "            self.publisher.publish(String(data='no heartbeat'))\n",
        ),
    ),
    wrong(
        'three alarms and no more',
        'There was an alarm before, and none this time',
        (
            "        super().__init__('watchdog')\n",
            "        super().__init__('watchdog')\n        self.alarms = 0\n",
        ),
        (
            "        self.publisher.publish(String(data='no heartbeat'))\n",
            '        self.alarms += 1\n        if self.alarms <= 3:\n'
            "            self.publisher.publish(String(data='no heartbeat'))\n",
        ),
    ),
    wrong(
        'at three silences and no more',
        'There was an alarm before, and none this time',
        (
            "        super().__init__('watchdog')\n",
            "        super().__init__('watchdog')\n        self.silences, self.told = 0, False\n",
        ),
        ('        pass\n', '        self.told = False\n'),
        (
            "        self.publisher.publish(String(data='no heartbeat'))\n",
            '        self.silences += not self.told\n        self.told = True\n'
            '        if self.silences <= 3:\n'
            "            self.publisher.publish(String(data='no heartbeat'))\n",
        ),
    ),
    wrong(
        'three seconds',
        'a message on /alarm within 2 s after the last heartbeat',
        ('seconds=0.5', 'seconds=3'),
    ),
    wrong(
        'tells that all is well again',
        'It also tells that the heart beats again',
        (
            "        super().__init__('watchdog')\n",
            "        super().__init__('watchdog')\n        self.silent = False\n",
        ),
        (
            '        pass\n',
            '        if self.silent:\n            self.silent = False\n'
            "            self.publisher.publish(String(data='all is well'))\n",
        ),
        (
            "        self.publisher.publish(String(data='no heartbeat'))\n",
            '        self.silent = True\n'
            "        self.publisher.publish(String(data='no heartbeat'))\n",
        ),
    ),
    wrong(
        'a false alarm at each twelfth beat',
        'There was an alarm while heartbeats came',
        (
            "        super().__init__('watchdog')\n",
            "        super().__init__('watchdog')\n        self.beats = 0\n",
        ),
        (
            '        pass\n',
            '        self.beats += 1\n        if self.beats % 12 == 0:\n'
            "            self.publisher.publish(String(data='no heartbeat'))\n",
        ),
    ),
    wrong(
        'an alarm without a text',
        'its field data is an empty text',
        ("String(data='no heartbeat')", 'String()'),
    ),
    wrong('other topic', 'names differ in an underscore', ("'heartbeat',", "'heart_beat',")),
    wrong(
        'no publisher',
        'create_publisher() for this topic has not been called',
        ("        self.publisher = self.create_publisher(String, 'alarm', 10)\n", ''),
        (
            "        self.publisher.publish(String(data='no heartbeat'))\n",
            "        self.get_logger().error('no heartbeat')\n",
        ),
        ('import Empty, String', 'import Empty'),
    ),
    wrong(
        'callback without an argument',
        'argument',
        ('def on_missed(self, event):', 'def on_missed(self):'),
        outcome=ERROR,
    ),
    wrong(
        'no event callback, in a process of its own',
        'No alarm came in time',
        ('            event_callbacks=SubscriptionEventCallbacks(deadline=self.on_missed),\n', ''),
        ('from rclpy.event_handler import SubscriptionEventCallbacks\n', ''),
        run='process',
    ),
    right('a timer that each beat sets back'),
    right(
        'a clock that a timer looks at',
        ('        self.timer.reset()\n', '        self.last = self.get_clock().now()\n'),
        (
            '        self.timer = self.create_timer(0.5, self.on_timer)\n',
            '        self.last = self.get_clock().now()\n'
            '        self.timer = self.create_timer(0.1, self.on_timer)\n',
        ),
        (
            "        self.publisher.publish(String(data='no heartbeat'))\n",
            '        silence = self.get_clock().now() - self.last\n'
            '        if silence.nanoseconds > 0.5e9:\n'
            "            self.publisher.publish(String(data='no heartbeat'))\n",
        ),
        of='a timer that each beat sets back',
    ),
    right('functions'),
    right(
        'best effort, and a longer deadline',
        ('import QoSProfile\n', 'import QoSProfile, ReliabilityPolicy\n'),
        (
            '            QoSProfile(depth=10, deadline=Duration(seconds=0.5)),\n',
            '            QoSProfile(\n                depth=1,\n'
            '                reliability=ReliabilityPolicy.BEST_EFFORT,\n'
            '                deadline=Duration(seconds=0.8),\n            ),\n',
        ),
    ),
    right('publishes twice'),
]
