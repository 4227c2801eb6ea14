"""Answers to `greeter`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'not to who speaks to Ada',
        'were answered correctly, the others were not',
        ("'Hello' in msg.data", "'Hello' in msg.data and 'Ada' not in msg.data"),
    ),
    wrong(
        'not to a namesake',
        'were answered correctly, the others were not',
        ("if 'Hello' in msg.data:", "if 'Hello' in msg.data and not msg.data.startswith('Ada'):"),
    ),
    wrong(
        'says something before anybody is heard',
        'It publishes although nothing has come.',
        (
            'self.on_message, 10)\n',
            'self.on_message, 10)\n'
            "        publisher = self.create_publisher(String, 'lobby', 10)\n"
            "        publisher.publish(String(data='Ada is here'))\n"
            '        self.destroy_publisher(publisher)\n',
        ),
    ),
    wrong(
        'keeps one publisher',
        'A publisher that is kept is used again and again.',
        ("            publisher = self.create_publisher(String, 'lobby', 10)\n", ''),
        ('            self.destroy_publisher(publisher)\n', ''),
        (
            "self.create_subscription(String, 'lobby', self.on_message, 10)\n",
            "self.create_subscription(String, 'lobby', self.on_message, 10)\n"
            "        self.publisher = self.create_publisher(String, 'lobby', 10)\n",
        ),
        ('            publisher.publish', '            self.publisher.publish'),
        ('            publisher.wait', '            self.publisher.wait'),
    ),
    wrong('Hello itself, without an end', 'without an end', ("'Ada: Salut'", "'Ada: Hello'")),
    wrong(
        'in capital letters', 'Capital and small letters differ', ("'Ada: Salut'", "'Ada: SALUT'")
    ),
    wrong('publishes twice', 'A message is answered more than once.'),
    wrong(
        'the first time only',
        'messages were answered correctly, the others were not',
        (
            "self.create_subscription(String, 'lobby', self.on_message, 10)\n",
            "self.create_subscription(String, 'lobby', self.on_message, 10)\n"
            '        self.calls = 0\n',
        ),
        (
            "        if 'Hello' in msg.data:\n",
            "        self.calls += 'Hello' in msg.data\n"
            "        if 'Hello' in msg.data and self.calls == 1:\n",
        ),
    ),
    wrong(
        'destroys it first',
        'destruction was requested',
        ('            self.destroy_publisher(publisher)\n', ''),
        (
            "            publisher = self.create_publisher(String, 'lobby', 10)\n",
            "            publisher = self.create_publisher(String, 'lobby', 10)\n"
            '            self.destroy_publisher(publisher)\n',
        ),
        outcome=ERROR,
    ),
    wrong('capital letter', 'Nothing came.'),
    wrong(
        'at its end only',
        'messages were answered correctly, the others were not',
        ("'Hello' in msg.data", "msg.data.endswith(': Hello')"),
    ),
    right('functions'),
    right(
        'a timer waits for subscribers',
        (
            "            publisher = self.create_publisher(String, 'lobby', 10)\n"
            "            publisher.publish(String(data='Ada: Salut'))\n"
            '            publisher.wait_for_all_acked(Duration(seconds=1))\n'
            '            self.destroy_publisher(publisher)\n',
            "            publisher = self.create_publisher(String, 'lobby', 10)\n"
            '            timer = self.create_timer(0.05, lambda: '
            'self.reply(publisher, timer))\n\n    def reply(self, publisher, timer):\n'
            '        if publisher.get_subscription_count() < '
            "self.count_subscribers('lobby'):\n            return\n"
            "        publisher.publish(String(data='Ada: Salut'))\n"
            '        publisher.wait_for_all_acked(Duration(seconds=1))\n'
            '        self.destroy_timer(timer)\n'
            '        self.destroy_publisher(publisher)\n',
        ),
    ),
    right(
        'try and finally',
        (
            "            publisher.publish(String(data='Ada: Salut'))\n"
            '            publisher.wait_for_all_acked(Duration(seconds=1))\n'
            '            self.destroy_publisher(publisher)\n',
            '            try:\n'
            "                publisher.publish(String(data='Ada: Salut'))\n"
            '                publisher.wait_for_all_acked(Duration(seconds=1))\n'
            '            finally:\n                self.destroy_publisher(publisher)\n',
        ),
    ),
    right(
        'destroyed by a timer, a moment later',
        ('            publisher.wait_for_all_acked(Duration(seconds=1))\n', ''),
        ('from rclpy.duration import Duration\n', ''),
        (
            '            self.destroy_publisher(publisher)\n',
            '            timer = self.create_timer(0.5, lambda: '
            'self.tidy(publisher, timer))\n\n    def tidy(self, publisher, timer):\n'
            '        self.destroy_timer(timer)\n'
            '        self.destroy_publisher(publisher)\n',
        ),
    ),
    right('a word of its own', ("'Hello' in msg.data", "'Hello' in msg.data.split()")),
    right(
        'a pattern',
        ('from rclpy.duration', 'import re\n\nfrom rclpy.duration'),
        ("'Hello' in msg.data", "re.search(r'\\bHello\\b', msg.data)"),
    ),
]
