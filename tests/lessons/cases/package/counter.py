"""Answers to `counter`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'not exported',
        'runs in this notebook, and there is no package',
        (
            "lab.export(Counter, package='counter_lab', folder='ros2_ws/src', overwrite=True)\n"
            '!cd ros2_ws && colcon build --packages-select counter_lab\n',
            'lab.spin(Counter())\n',
        ),
    ),
    wrong(
        'not built',
        'colcon build has not been run since',
        ('!cd ros2_ws && colcon build --packages-select counter_lab\n', ''),
    ),
    wrong(
        'beside src',
        'Packages lie in the folder src of a workspace.',
        ("'ros2_ws/src'", "'ros2_ws'"),
    ),
    wrong(
        'leans on the notebook',
        "it uses 'lab'",
        ('self.count += 1', 'self.count += lab.start() or 1'),
        outcome=ERROR,
    ),
    wrong(
        'another class name',
        'executables: count',
        ('class Counter(Node):\n', 'class Count(Node):\n'),
        (
            "lab.export(Counter, package='counter_lab', folder='ros2_ws/src', overwrite=True)\n",
            "lab.export(Count, package='counter_lab', folder='ros2_ws/src', overwrite=True)\n",
        ),
    ),
    wrong(
        'another node name',
        'The name of the node is what super().__init__() gets.',
        ("__init__('counter')", "__init__('count')"),
    ),
    wrong(
        'one publisher',
        'a publisher of /counter on /half',
        ('        self.half_publisher.publish(Float64(data=self.count / 2))\n', ''),
        ("        self.half_publisher = self.create_publisher(Float64, 'half', 10)\n", ''),
        ('Float64, Int16', 'Int16'),
    ),
    wrong(
        'two of one type',
        'messages of type std_msgs/msg/Int16',
        ("(Float64, 'half'", "(Int16, 'half'"),
        ('Float64(data=self.count / 2)', 'Int16(data=self.count // 2)'),
        ('Float64, Int16', 'Int16'),
    ),
    wrong(
        'half of the number before',
        'It is not half of the count',
        ('self.count / 2', 'max(0, self.count - 1) / 2'),
    ),
    wrong(
        'half of the next number',
        'It is not half of the count',
        ('self.count / 2', '(self.count + 1) / 2'),
    ),
    wrong(
        'modulo 100',
        'Seen: 0 after 99',
        ('        self.count += 1\n', '        self.count = (self.count + 1) % 100\n'),
    ),
    wrong(
        'ends after a hundred',
        'They stop coming.',
        (
            '    def on_timer(self):\n',
            '    def on_timer(self):\n        if self.count == 100:\n            return\n',
        ),
    ),
    wrong(
        'no half of a large number',
        'It is not half of the count',
        ('self.count / 2', 'min(self.count, 50) / 2'),
    ),
    right(
        'the whole workspace',
        (
            '!cd ros2_ws && colcon build --packages-select counter_lab\n',
            '!cd ros2_ws && colcon build\n',
        ),
    ),
    right(
        'a constant and a function of other lines',
        (
            '\n\nclass Counter',
            '\nPERIOD = 0.2\n\n\ndef half(x):\n    return x / 2\n\n\nclass Counter',
        ),
        ('create_timer(0.2', 'create_timer(PERIOD'),
        ('self.count / 2', 'half(self.count)'),
    ),
    right(
        'two timers',
        (
            '        self.count = 0\n',
            '        self.second = self.create_timer(0.2, self.on_second)\n'
            '        self.count = self.other = 0\n',
        ),
        ('        self.half_publisher.publish(Float64(data=self.count / 2))\n', ''),
        (
            '\n\nlab.export',
            '\n    def on_second(self):\n'
            '        self.half_publisher.publish(Float64(data=self.other / 2))\n'
            '        self.other += 1\n\n\nlab.export',
        ),
    ),
    right(
        'a base class',
        ('class Counter(Node)', 'class Named(Node)'),
        (
            "super().__init__('counter')\n",
            "super().__init__('counter')\n\n\nclass Counter(Named):\n"
            '    def __init__(self):\n        super().__init__()\n',
        ),
    ),
]
