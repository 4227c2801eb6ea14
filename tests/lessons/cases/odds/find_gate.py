"""Answers to `find_gate`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        # A text in another type would raise, and whether it has by then is a matter of luck.
        'wrong type',
        'A topic carries one type of message.',
        ('import String', 'import Int16'),
        ('create_publisher(String,', 'create_publisher(Int16,'),
        ('String(data=info.node_name)', 'Int16(data=1)'),
    ),
    wrong(
        'a number for a name',
        'A topic carries one type of message.',
        ('String', 'Int16'),
        ('info.node_name', '4'),
    ),
    wrong(
        'compares with a short name',
        'publish() is not called there',
        ("!= 'std_msgs/msg/Int16'", "== 'Int32'"),
    ),
    wrong('another topic', 'The names differ in an underscore'),
    wrong('every 5 s', 'times too slow', ('create_timer(0.2,', 'create_timer(5,')),
    wrong(
        'ends after ten',
        'They stop coming.',
        ("super().__init__('inspector')\n", "super().__init__('inspector')\n        self.n = 0\n"),
        (
            '    def on_timer(self):\n',
            '    def on_timer(self):\n        self.n += 1\n        if self.n > 10:\n'
            '            return\n',
        ),
    ),
    wrong(
        'a name in a sentence',
        'The name of a gate is in it, but not as the graph has it',
        ('data=info.node_name', "data=f'It is {info.node_name}'"),
    ),
    wrong(
        'the right gate first, then all of them',
        'Several gates are named.',
        ("super().__init__('inspector')\n", "super().__init__('inspector')\n        self.n = 0\n"),
        ('    def on_timer(self):\n', '    def on_timer(self):\n        self.n += 1\n'),
        (
            "info.topic_type != 'std_msgs/msg/Int16':",
            "self.n > 50 or info.topic_type != 'std_msgs/msg/Int16':",
        ),
    ),
    wrong(
        'also the referee',
        "There is no gate called 'referee'.",
        (
            "get_publishers_info_by_topic('/visitors'):",
            "get_publishers_info_by_topic('/goals'):\n"
            '            self.publisher.publish(String(data=info.node_name))\n'
            "        for info in self.get_publishers_info_by_topic('/visitors'):",
        ),
    ),
    wrong(
        'published once',
        'The node has no timer',
        ('self.timer = self.create_timer(0.2, self.on_timer)', 'self.on_timer()'),
    ),
    wrong(
        'a number of the graph for its name',
        'takes values of type str',
        ('data=info.node_name', 'data=info.endpoint_type'),
        outcome=ERROR,
    ),
    right('functions, and the name typed in'),
    right('looked up once, in a thread that sleeps'),
    right(
        'kept for those who come late, once a second',
        (
            "create_publisher(String, 'wrong_gate', 10)",
            'create_publisher(\n'
            "            String, 'wrong_gate', QoSProfile(depth=1, "
            'durability=DurabilityPolicy.TRANSIENT_LOCAL)\n        )',
        ),
        (
            'from rclpy.node import Node\n',
            'from rclpy.node import Node\nfrom rclpy.qos import DurabilityPolicy, QoSProfile\n',
        ),
        ('create_timer(0.2,', 'create_timer(1,'),
    ),
    right('publishes twice'),
]
