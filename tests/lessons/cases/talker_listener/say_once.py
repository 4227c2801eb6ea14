"""Answers to `say_once`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'waits some seconds, and does not look',
        'it is lost',
        ('if self.publisher.get_subscription_count() > 0:', 'if True:'),
        ('0.1', '3.0'),
    ),
    wrong('publishes twice', 'one message on /door, and no other'),
    wrong(
        'a thread says it again',
        'Does a thread or a loop publish?',
        (
            "            self.publisher.publish(String(data='The door is open'))\n"
            '            self.timer.cancel()\n',
            '            self.timer.cancel()\n'
            '            threading.Thread(target=self.say, daemon=True).start()\n\n'
            '    def say(self):\n        for _ in range(2):\n'
            "            self.publisher.publish(String(data='The door is open'))\n"
            '            time.sleep(3)\n',
        ),
        ('from rclpy', 'import threading\nimport time\n\nfrom rclpy'),
    ),
    wrong(
        'says it again after a while',
        'Nothing stops the node after its first message.',
        (
            "        super().__init__('door')\n",
            "        super().__init__('door')\n        self.calls = 0\n",
        ),
        (
            "            self.publisher.publish(String(data='The door is open'))\n"
            '            self.timer.cancel()\n',
            '            self.calls += 1\n            if self.calls % 100 == 1:\n'
            "                self.publisher.publish(String(data='The door is open'))\n",
        ),
    ),
    wrong(
        'says more, later',
        "'The door is open', 'The door is shut'",
        (
            '            self.timer.cancel()\n',
            '            self.timer.cancel()\n'
            '            self.create_timer(9.0, self.close)\n\n    def close(self):\n'
            "        self.publisher.publish(String(data='The door is shut'))\n",
        ),
    ),
    wrong(
        'says something before',
        'published while nobody listened',
        (
            '        self.timer = self.create_timer(0.1, self.on_timer)\n',
            '        self.timer = self.create_timer(0.1, self.on_timer)\n'
            "        self.publisher.publish(String(data='Hello'))\n",
        ),
    ),
    wrong(
        'waits for a second listener',
        'Or publish() was not reached at all.',
        ('count() > 0', 'count() > 1'),
    ),
    wrong('looks once a minute', 'Or publish() was not reached at all.', ('0.1', '60.0')),
    wrong(
        'looks once',
        'Or publish() was not reached at all.',
        (
            '        self.timer = self.create_timer(0.1, self.on_timer)\n',
            '        self.on_timer()\n',
        ),
    ),
    wrong(
        'looks for a while only',
        'Or publish() was not reached at all.',
        (
            "        super().__init__('door')\n",
            "        super().__init__('door')\n        self.calls = 0\n",
        ),
        (
            'if self.publisher.get_subscription_count() > 0:',
            'self.calls += 1\n        if self.calls > 100:\n'
            '            self.timer.cancel()\n'
            '        elif self.publisher.get_subscription_count() > 0:',
        ),
    ),
    wrong('other text', 'Capital and small', ('The door is open', 'The door is Open')),
    wrong('empty text', "data = ''", ("data='The door is open'", '')),
    wrong('another topic', 'names must be equal'),
    wrong(
        'other type',
        'A topic carries one type of message.',
        ('import String', 'import Int16'),
        ('(String, ', '(Int16, '),
        ("String(data='The door is open')", 'Int16(data=1)'),
    ),
    wrong(
        'waits in the callback',
        'While a callback runs, no other one can',
        (
            '        if self.publisher.get_subscription_count() > 0:\n'
            "            self.publisher.publish(String(data='The door is open'))\n"
            '            self.timer.cancel()\n',
            '        while self.publisher.get_subscription_count() == 0:\n'
            '            time.sleep(0.05)\n        self.timer.cancel()\n'
            "        self.publisher.publish(String(data='The door is open'))\n",
        ),
        ('from rclpy', 'import time\n\nfrom rclpy'),
    ),
    wrong(
        'a program that waits in a loop',
        'Its program does something else, such as a loop that waits.',
        run='process',
    ),
    wrong('not spun', '/door is there, but it is not spun'),
    wrong(
        'a listener of its own',
        'nobody subscribes to /door before the check does',
        (
            '        self.timer = self.create_timer(0.1, self.on_timer)\n',
            '        self.timer = self.create_timer(0.1, self.on_timer)\n'
            "        self.create_subscription(String, 'door', print, 10)\n",
        ),
    ),
    wrong(
        'not set up',
        'super().__init__(...) has not been called',
        ("        super().__init__('door')\n", ''),
        outcome=ERROR,
    ),
    right('told by ROS when somebody comes'),
    right(
        'remembers that it has spoken, under the name of another node',
        (
            "        super().__init__('door')\n",
            "        super().__init__('editor')\n        self.said = False\n",
        ),
        (
            'if self.publisher.get_subscription_count() > 0:',
            'if self.publisher.get_subscription_count() > 0 and not self.said:',
        ),
        ('            self.timer.cancel()\n', '            self.said = True\n'),
    ),
    right(
        'looks every 3 seconds, and keeps it for those who come late',
        ('0.1', '3.0'),
        ("String, 'door', 10", "String, 'door', latched"),
        (
            '\n\nclass',
            '\n'
            'latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n'
            '\n\nclass',
        ),
        (
            'from rclpy.node import Node\n',
            'from rclpy.node import Node\nfrom rclpy.qos import DurabilityPolicy, QoSProfile\n',
        ),
    ),
    wrong(
        'once for each subscriber',
        'Nothing stops the node after its first message.',
        (
            "        super().__init__('door')\n",
            "        super().__init__('door')\n        self.known = 0\n",
        ),
        (
            '        if self.publisher.get_subscription_count() > 0:\n',
            '        count, known = self.publisher.get_subscription_count(), self.known\n'
            '        self.known = count\n'
            '        if count > known:\n',
        ),
        ('            self.timer.cancel()\n', ''),
    ),
    right('waits in a thread'),
    right(
        'an executor with several threads',
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
]
