"""Answers to `greet`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'space missing',
        'A space is a character like any other.',
        ("msg.data + 'Ada'", "msg.data.strip() + 'Ada'"),
    ),
    wrong(
        'answers where it listens',
        'The node hears what it says itself',
        ("'demo_complete'", "'demo_incomplete'"),
    ),
    wrong(
        'does not publish',
        'its callback did not publish',
        ("        reply = String(data=msg.data + 'Ada')\n", ''),
        ('        self.publisher.publish(reply)\n', ''),
    ),
    wrong(
        'blocks',
        'While a callback runs, no other one can',
        ('        reply =', '        sleep(3)\n        reply ='),
        ('from rclpy', 'from time import sleep\n\nfrom rclpy'),
    ),
    wrong(
        'does not log',
        'The callback does not log it',
        ("self.get_logger().info(f'I heard: {msg.data}')", 'print(msg.data)'),
    ),
    wrong(
        'callback without a message',
        'This callback does not take one argument',
        ('def on_text(self, msg)', 'def on_text(self)'),
        outcome=ERROR,
        refused='The name msg is not defined.',
    ),
    wrong(
        'no publisher',
        'What stands before .publish is None.',
        ("self.create_publisher(String, 'demo_complete', 10)", 'None'),
        outcome=ERROR,
    ),
    wrong(
        'raises in the callback',
        'String has nothing called text',
        ('msg.data +', 'msg.text +'),
        outcome=ERROR,
    ),
    right('functions'),
]
